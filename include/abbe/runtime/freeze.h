#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Values of a measured state for which errors are frozen, in its unit.
struct StateRange {
  double from = 0, to = 0;  ///< both 0: not stated
};

/// Range of a temperature for which none is stated: this far below and above its reference, K. Other states
/// must have one.
inline constexpr double kDefaultBelow = -5, kDefaultAbove = 10;

struct FreezeOptions {
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();     ///< mm; default tool, functional point from the gauge point
  double tool_length_min = 0, tool_length_max = 300;  ///< mm, against the tool direction: checked, flagged beyond
  /// World coordinates are zero where all joints and the tool are zero, so that without rotation they equal the joints;
  /// false: world coordinates are those of the workpiece frame.
  bool world_zero_at_joints = true;
  double largest_turn = 0.01;  ///< rad, as CorrectionOptions
  double largest_shift = 10;   ///< mm
  std::size_t poses = 4000;    ///< tried for the statement, per tool length
  /// Of all parameters of the errors, in their order (square of mm, rad); empty: the file states no uncertainty.
  Eigen::MatrixXd covariance;
  /// Of the machine, where those that are frozen leave some out: what remains is judged by them.
  std::optional<ErrorSet> all_errors;
  std::vector<StateRange> state_ranges;  ///< [states of the machine] of measured ones; or empty: none is stated
  std::string source;                    ///< machine and errors as text, whose checksum the file keeps
  std::string version;                   ///< of the program
};

/// A frozen compensation, and its test against the full model at poses all over travel and map.
struct FrozenCompensation {
  std::string problem;  ///< why it cannot be frozen; empty if it can
  std::vector<unsigned char> bytes;
  int format = 0;  ///< of the bytes: 2, or 3 with states
  struct Channel {
    std::size_t state = 0;  ///< measured state of the machine
    StateRange range;
    double largest = 0;  ///< mm by which the tool point moves if it goes from its reference to the far end of the range
  };
  std::vector<Channel> channels;  ///< that a controller has to give, in the order of the file
  std::uint64_t checksum = 0, source_checksum = 0;
  double largest_correction = 0;       ///< mm, of the tool point: actual against nominal at the same commands
  double largest_correction_turn = 0;  ///< rad, of the tool direction
  std::vector<double> where;           ///< nominal commands of largest_correction; mm, rad
  double tool_length_there = 0;        ///< mm
  std::vector<double> largest_joint;   ///< [axes] largest correction of each joint, mm or rad
  std::vector<std::vector<double>> largest_joint_at;  ///< [axes] nominal commands there
  double accuracy = 0;       ///< mm, actual tool at the compensated joints against where it should be, by all errors
  double accuracy_turn = 0;  ///< rad
  double difference = 0;     ///< mm, the same by the errors that are frozen: what freezing itself changes
  double largest_uncertainty = 0, mean_uncertainty = 0;  ///< mm, of the point's correction; 0: not stated
  bool too_many_states = false;    ///< for the uncertainty of the errors, which the file then does not have
  double uncertainty_lattice = 0;  ///< mm, largest difference of the file's uncertainty from the full model's
  int worst_iterations = 0;        ///< of all calls, both directions
  std::size_t poses = 0, limited = 0, unreached = 0;  ///< tried; turn bounded; point not reached
  std::size_t points_compared = 0;      ///< poses that accuracy and difference are the largest of; 0: nothing is known
  std::size_t directions_compared = 0;  ///< the same for accuracy_turn
  std::size_t point_axes = 0;           ///< axes that take the error of the point; three are needed for all of it
};

/// Functional points from the gauge point with which a frozen compensation is tried, mm: that of the default tool, of
/// the shortest and of the longest one.
std::vector<Eigen::Vector3d> tools_tried(const Machine& machine, const FreezeOptions& options);

FrozenCompensation freeze(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options);

}  // namespace abbe
