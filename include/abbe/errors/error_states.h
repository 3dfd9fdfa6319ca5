#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Whether any error has a state.
bool has_states(const ErrorSet& errors);

/// Name of the first error that has a state, "EXX*ambient"; empty: none has.
std::string first_error_with_state(const Machine& machine, const ErrorSet& errors);

/// States that errors use, the factors of products among them: 1 or 0, [states of the machine].
std::vector<std::uint8_t> used_states(const Machine& machine, const ErrorSet& errors);

/// Index of the first measured or lag state that errors use and that some pose does not give; kNoState: all are given.
std::size_t missing_state(const Machine& machine, const ErrorSet& errors, const PoseList& poses);

/// @throws std::invalid_argument naming the state that missing_state() finds
void require_states(const Machine& machine, const ErrorSet& errors, const PoseList& poses);

/// Values at which the factors of measured and lag states are 0; NaN for the other states. [states of the machine]
std::vector<double> reference_states(const Machine& machine);

/// Puts the references of measured and lag states where poses do not give them: poses that are made and not measured.
void stand_at_references(const Machine& machine, PoseList& poses);

/// "ambient 20 degC, payload 0 kg": references of the measured and lag states that errors use; empty if they use none.
std::string reference_words(const Machine& machine, const ErrorSet& errors);

/// Errors of a machine whose measured and lag states have these values. Terms that depend on nothing else become terms
/// without a state; others keep the states that are computed at a pose.
///
/// @param values         [states] in the unit of each state; only those of measured and lag states are read
/// @param by_parameters  if not null: d(parameters of the result)/d(parameters of the errors); products with a
///                       covariance from both sides give that of the result
/// @throws std::invalid_argument naming the state, if one that the errors use is not a finite number
ErrorSet at_state(const Machine& machine, const ErrorSet& errors, std::span<const double> values,
                  Eigen::MatrixXd* by_parameters = nullptr);

/// Takes what PositionArrays::state needs from poses: columns of measured and lag states, sides of approach.
class GivenStates {
 public:
  GivenStates() = default;
  GivenStates(const Machine& machine, const ErrorSet& errors);

  /// False where the errors use no state that has to be given.
  bool any() const { return !columns_.empty(); }

  /// Values at the poses first + at[k].
  /// @param memory    becomes [columns][stride]
  /// @param pointers  becomes what PositionArrays::state needs; empty if there is nothing to give
  void gather(const PoseList& poses, std::size_t first, std::span<const std::uint16_t> at, std::size_t stride,
              std::vector<double>& memory, std::vector<const double*>& pointers) const;
  /// Values at chosen poses, in their order; stride is their number.
  void gather(const PoseList& poses, std::span<const std::size_t> chosen, std::vector<double>& memory,
              std::vector<const double*>& pointers) const;

  /// Values at one pose as state_factor() takes them: NaN where not given. [states], or empty if there is nothing.
  std::vector<double> at(const PoseList& poses, std::size_t pose) const;

 private:
  struct Column {
    std::size_t state;
    bool is_approach;
    std::size_t axis;  ///< of an approach
  };
  static double value(const PoseList& poses, const Column& column, std::size_t pose);
  template <class PoseAt>
  void gather_from(const PoseList& poses, std::size_t count, const PoseAt& pose_at, std::size_t stride,
                   std::vector<double>& memory, std::vector<const double*>& pointers) const;
  std::vector<Column> columns_;
  std::size_t states_ = 0;
};

/// Positions of one pose with its states, for PositionArrays.
class OnePose {
 public:
  /// @param given  as GivenStates::at() returns it
  OnePose(const std::vector<double>& positions, const std::vector<double>& given);
  OnePose(const OnePose&) = delete;
  OnePose& operator=(const OnePose&) = delete;
  PositionArrays arrays() const { return {axis_, 1, state_}; }

 private:
  std::vector<const double*> axis_, state_;
};

}  // namespace abbe
