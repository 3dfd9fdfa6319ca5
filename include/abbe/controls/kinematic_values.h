#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "abbe/controls/control_table.h"
#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/machine/inverse_kinematics.h"
#include "abbe/machine/machine.h"
#include "abbe/verify/table_loss.h"
#include "abbe/verify/volumetric_figures.h"

namespace abbe {

/// What kinematic values are made of and what is asked of them; lengths in mm, angles in rad.
///
/// Messages name a field by the option of `abbe compensate kinematics` that sets it.
struct KinematicValuesRequest {
  std::string format;  ///< --for: a name of kinematic_formats()
  Machine machine;
  ErrorSet errors;
  /// [p, p] of errors.parameters(), mm and rad; 0 x 0: what the errors state of their standard uncertainties.
  Eigen::MatrixXd covariance;
  std::optional<int> tool_carrier;  ///< --tool-carrier, siemens: $TC_CARR of this number instead of machine data

  std::optional<std::size_t> positions;  ///< --positions: per axis of the grid of `poses`; else 9, or 5 above 3 axes
  /// --at: where axes stand for states that follow from commands; others in the middle of their travel, endless ones at
  /// 0
  std::vector<HeldAxis> at{};
  std::optional<double> limit_mm;   ///< --limit-um: a larger change of a length is refused; above zero
  std::optional<double> limit_rad;  ///< --limit-urad: the same for a direction component or an angle
  double least_reduction = 0.01;    ///< --least-reduction-percent: share of the error below which values are refused
};

/// In what a value is stated.
enum class ValueKind {
  length,     ///< mm
  direction,  ///< component of a unit vector
  angle,      ///< rad
};

/// One number that the control takes.
struct KinematicValue {
  std::string name;  ///< "xyzac-trt-kins.x-rot-point", "$MC_TRAFO5_BASE_TOOL_1[0]", "C,machine,x_mm"
  ValueKind kind = ValueKind::length;
  double nominal = 0;                          ///< of the machine file
  double actual = 0;                           ///< with the location errors, as it is written, rounded
  std::optional<double> standard_uncertainty;  ///< of `actual`; none is known without uncertainties of the errors
};

/// A format of kinematic values, as it is described to users.
struct KinematicFormatWords {
  std::string name;        ///< "siemens"
  std::string what;        ///< one line
  std::string convention;  ///< frame, signs and units
  std::string unverified;  ///< what no public source says; empty: nothing
  std::string cannot;      ///< why what is not carried is not
};
/// All formats, in the order in which they are listed.
std::vector<KinematicFormatWords> kinematic_formats();

/// Values as a control would use them: the text read back, and what the simulated control leaves of the error.
///
/// The simulated control computes the commands of the linear axes by the nominal kinematics of the machine with these
/// values in it, so that the functional point is where it believes it to be; rotary axes stand where they are
/// commanded. The machine with all its errors executes these commands. Sentences have no full stop.
struct KinematicValues {
  KinematicFormatWords format;
  ControlFile file;  ///< text is empty where says_no()
  std::vector<KinematicValue> values;
  std::vector<std::string> settings;  ///< what has to be set at the control besides
  std::vector<std::string> refused;   ///< why the values must not be used
  bool says_no() const { return !refused.empty(); }

  /// [axes] commands at which errors whose states follow from commands are taken; empty: there are none. What they do
  /// elsewhere is left, and is in `after`.
  std::vector<double> state_pose{};
  PoseDeviations after_at_state_pose{};  ///< as `after`, if the errors were everywhere what they are at state_pose
  VolumetricFigures volumetric;          ///< predicted from the errors over the grid of all commands
  PoseList poses;                        ///< where the figures below are stated; those of `abbe compensate table`
  std::vector<std::size_t> grid;         ///< positions per axis, chain order
  SampleStatistics left_by_values;       ///< volumetric error that these values leave, the datum fitted
  /// Displacement as the control sees it, no datum fitted: nominal values, these values, the best the axes can do.
  PoseDeviations before, after, ideal;
  std::size_t ideal_not_reached = 0;  ///< poses whose point the ideal correction does not reach
  std::vector<CarriedError> errors;   ///< what becomes of every error alone
};

/// Positions and directions of the rotary axes as a control with a transformation of five axes takes them.
///
/// Opens no file and prints nothing. Where values must not be used, that is in the result and not an error.
/// Source of the model: docs/kinematic-values.md.
/// @throws InputError for an unknown format, for a machine whose chain the control does not have, for a field of other
///   formats and for values out of range; the field is named by its option
/// @throws std::invalid_argument for a covariance of the wrong size
KinematicValues make_kinematic_values(const KinematicValuesRequest& request);

}  // namespace abbe
