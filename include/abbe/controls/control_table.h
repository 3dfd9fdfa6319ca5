#pragma once

// A table for LinuxCNC as text, from the known errors of a mill:
//
//   #include <abbe/controls/control_table.h>
//   #include <abbe/formats/machine/errors_file.h>
//   #include <abbe/formats/machine/machine_file.h>
//
//   #include <cstdio>
//
//   int main() {
//     abbe::ControlTableRequest request;
//     request.format = "linuxcnc";
//     request.machine = abbe::read_machine("examples/machines/three-axis-mill.machine.toml");
//     request.errors = abbe::read_errors("examples/compensate/mill.errors.toml", request.machine).errors;
//     request.axes = {"Y"};
//     request.most_nodes = 5;
//     request.tolerance_mm = 2e-3;
//     request.limit_mm = 0.1;
//     const abbe::ControlTables made = abbe::make_control_tables(request);
//     for (const std::string& why : made.refused) std::printf("refused: %s\n", why.c_str());
//     for (const abbe::ControlFile& file : made.files) std::printf("%s:\n%s", file.name.c_str(), file.text.c_str());
//     return made.says_no() ? 1 : 0;
//   }
//
// It prints:
//
//   Y.comp:
//   0.0000000 0.0184585 0.0184585
//   110.0000000 0.0080193 0.0080193
//   220.0000000 -0.0019999 -0.0019999
//   330.0000000 -0.0078502 -0.0078502
//   440.0000000 -0.0057812 -0.0057812
//
// controls holds correction tables and kinematic values:
//   control_table.h                     what is asked for, and tables with what they do and do not carry
//   table_format.h                      the formats, and what each takes
//   table_text.h, table_map.h           results for people; maps of what a table leaves
//   lost_motion.h                       where reversal values go
//   kinematic_values.h                  positions and directions of rotary axes as controls take them
//   kinematic_values_text.h             the same for people and for programs
// How tables are made and judged: docs/controller-tables.md.

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "abbe/compensate/workpiece_expansion.h"
#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/readings/errors_over_time.h"
#include "abbe/machine/inverse_plan.h"
#include "abbe/machine/machine.h"
#include "abbe/verify/table_loss.h"
#include "abbe/verify/volumetric_figures.h"

namespace abbe {

struct TableFormat;

/// What the control calls an axis of the machine.
struct ControlAxisName {
  std::string axis;  ///< of the machine file: "X"
  std::string name;  ///< at the control: "X1", "AX2", "3"
};

/// Inputs and requirements of tables; lengths in mm, angles in rad.
///
/// Messages name a field by the option of `abbe compensate table` that sets it, given below. A field that the format
/// does not use must keep its default.
struct ControlTableRequest {
  std::string format;  ///< --for: TableFormat::name
  Machine machine;
  ErrorSet errors;
  std::string errors_file;  ///< name for messages; may be empty
  /// [p, p] of errors.parameters(), mm and rad; 0 x 0: what the errors state of their standard uncertainties.
  Eigen::MatrixXd covariance;

  /// --workpiece-...: one that is to be right at 20 degC and has the temperature stated here. The tool is the machine
  /// file's.
  std::optional<WorkpieceExpansion> workpiece{};

  /// --at: where an axis stands while another one moves; axes that are not named stand in the middle of their known
  /// travel.
  std::vector<HeldAxis> reference;
  std::vector<std::string> axes;       ///< --axis: only tables over their positions; empty: over all axes
  std::vector<ControlAxisName> names;  ///< --name: axes that the control calls otherwise than TableFormat::default_name
  std::optional<double> tolerance_mm;  ///< --interpolation-um: of straight lines between nodes; else the format's
  std::optional<double> tolerance_rad;    ///< --interpolation-urad: else 0.1 urad
  std::optional<std::size_t> most_nodes;  ///< --max-points: room for nodes per table, of a grid in all

  std::optional<int> type;                   ///< --type, linuxcnc: COMP_FILE_TYPE, 0 or 1; else 1
  std::optional<std::size_t> encoder;        ///< --encoder, siemens-eec: measuring system, 0 or 1; else 0
  std::optional<std::size_t> first_table;    ///< --first-table, siemens-cec: 0 to 999; else 0
  bool negate = false;                       ///< --negate: the other sign, where the control's is not known for sure
  bool negate_own = false;                   ///< --negate-own, heidenhain-kinematics-comp: the same for own columns
  std::optional<double> detection_unit_mm;   ///< --detection-unit-um, FANUC: as many degrees for rotary axes; else 1 um
  std::vector<HeldAxis> reference_position;  ///< --reference-position, FANUC: else zero, or the next end of the travel

  std::optional<std::size_t> positions;  ///< --positions: per axis of the grid of `poses`; else 9, or 5 above 3 axes
  std::optional<double> limit_mm;        ///< --limit-um: a larger correction is refused; above zero
  std::optional<double> limit_rad;       ///< --limit-urad
  std::vector<ErrorsAtTime> over;        ///< --state-over: errors of the machine at the states of a record; empty: none
  std::string over_file;                 ///< its name
  double least_reduction = 0.01;  ///< --least-reduction-percent: share of the error below which tables are refused
  double leave_out_below = 0;     ///< --leave-out-below-uncertainty: standard uncertainties, at most 1000; 0: none
};

/// Errors that tables made at one state leave at the states of a record.
struct LossOverStates {
  std::string record;           ///< name of its file
  std::vector<double> time_s;   ///< [n] of the record
  std::vector<double> rms;      ///< [n] volumetric error that the tables leave, the datum fitted at each time, mm
  std::vector<double> maximum;  ///< [n] the same
  StateValues worst_state;      ///< where the maximum is largest
  std::size_t outside = 0;      ///< times at which a state lies outside what the readings of the errors cover

  std::size_t worst() const;          ///< index of the largest maximum
  double rms_of_all() const;          ///< over all times and poses, mm
  std::string outside_words() const;  ///< a sentence about `outside`; empty: none
};

/// A file for the control, not yet written.
struct ControlFile {
  std::string name;  ///< without a folder: "X.comp"
  std::string text;
};

/// Figures of one table, or of another part of the files that can be left out; lengths in mm, angles in rad.
struct TableFigures {
  std::string name;  ///< "X", "Y for X", "EXX"
  std::size_t nodes = 0;
  double step = 0;             ///< between nodes
  bool step_is_angle = false;  ///< `step` and `largest_at`
  bool is_angle = false;       ///< the values
  double largest = 0;          ///< correction
  double largest_at = 0;       ///< command at which it is
  double interpolation_error = 0;
  bool within = true;                          ///< the tolerance of interpolation is kept
  std::optional<double> standard_uncertainty;  ///< largest of a correction; not known: none is stated of the errors
};

/// A note about what the control does.
struct ControlNote {
  std::string name;   ///< what it is about: "reversal_X"
  std::string words;  ///< without a full stop
};

/// Tables as a control would use them: the text read back, and what the simulated control leaves of the error.
///
/// Lengths in mm, angles in rad. Sentences begin with a small letter and have no full stop.
struct ControlTables {
  const TableFormat* format = nullptr;  ///< null: not made
  std::vector<ControlFile> files;       ///< empty where says_no(), and where there is nothing to correct
  std::vector<TableFigures> tables;
  std::vector<std::string> settings;       ///< what has to be set at the control
  std::vector<std::string> left_out;       ///< "X: at most 1.2 times its standard uncertainty"
  std::vector<std::string> left_out_kept;  ///< small by themselves, but not together
  std::vector<ControlNote> reversals;      ///< where reversal values are, or what of the control takes them
  std::vector<std::string> refused;        ///< why the tables must not be used
  /// Why there are no tables although nothing is refused: too few nodes to keep the interpolation tolerance.
  std::string too_few_nodes;
  /// Whether there are no tables that may be used.
  bool says_no() const { return format == nullptr || !refused.empty() || !too_few_nodes.empty(); }

  std::optional<WorkpieceExpansion> workpiece{};  ///< for which the tables are made, besides the errors
  double tolerance_mm = 0, tolerance_rad = 0;     ///< of straight lines between nodes, as they were asked for
  /// Predicted from the errors over the grid of all commands (docs/conventions.md).
  VolumetricFigures volumetric;

  PoseList poses;                   ///< between the nodes, where the figures below are stated
  std::vector<std::size_t> grid;    ///< positions per axis, chain order
  SampleStatistics left_by_tables;  ///< volumetric error that these tables leave, the datum fitted
  /// Displacement as the control sees it, no datum fitted, the worse direction of approach: without tables, with them,
  /// and with the best that the axes can do.
  PoseDeviations before, after, ideal;
  std::size_t ideal_not_reached = 0;          ///< poses whose point the ideal correction does not reach
  std::optional<LossOverStates> over_states;  ///< where the request has such states
  std::vector<CarriedError> errors;           ///< what becomes of every error alone
  /// Standard uncertainty of the displacement that is corrected.
  std::optional<SampleStatistics> uncertainty;
  double largest_mm = 0, largest_rad = 0;     ///< sum of corrections of one axis
  std::string largest_mm_at, largest_rad_at;  ///< "X 1.5 mm, C 30 deg for axis X"
};

/// Tables for a control, and what they do and do not carry. Opens no file and prints nothing.
///
/// The text is read back by the reader of the format, and a control that uses it is simulated over
/// ControlTables::poses. Where tables must not be used, that is in the result (`refused`, `too_few_nodes`) and not an
/// error.
/// @throws InputError for an unknown format, for what the format cannot take (another kind of machine, an option of
///   other formats) and for values out of range; the field is named by its option: "--for", "--axis Q"
/// @throws std::invalid_argument for a covariance of the wrong size
ControlTables make_control_tables(const ControlTableRequest& request);

}  // namespace abbe
