#pragma once

// States of machines and the values that errors with states need.
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "abbe/errors/poses.h"
#include "bindings/arrays.h"
#include "bindings/machine_errors.h"

namespace abbe::python {

/// States of poses as they come from Python: a dict of columns, {"ambient_degC": number or [n]}.
using StatesArgument = std::optional<nb::typed<nb::dict, nb::str, ArrayLike>>;

/// Values of measured and lag states, and sides of approach, at every pose of a call.
class GivenColumns {
 public:
  /// @throws InputError for names that are no such state, other lengths, values that are not finite, and measured or
  ///         lag states that the errors use and nobody gives
  GivenColumns(const StatesArgument& states, const Machine& machine, const ErrorSet& errors, std::size_t poses);

  /// As PositionArrays::state takes them, from pose `first` on. Empty if nothing is given.
  std::span<const double* const> from(std::size_t first, std::vector<const double*>& memory) const;

  /// Puts measured and lag states, and sides of approach, into a list of as many poses.
  void put_into(PoseList& poses) const;

 private:
  const Machine& machine_;
  std::vector<std::vector<double>> values_;  ///< [states][poses]; empty where not given
};

/// For jobs that take no values of states. @throws InputError if the errors depend on measured or lag states
void require_no_given_states(const MachineErrors& errors);

/// Adds what says which states a machine has.
void add_states(nb::class_<Machine>& machine);

}  // namespace abbe::python
