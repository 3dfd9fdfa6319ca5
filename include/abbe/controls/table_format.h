#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "abbe/compensate/program/command_correction.h"
#include "abbe/controls/control_table.h"
#include "abbe/errors/error_set.h"
#include "abbe/formats/controls/table_axis_names.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// What a control looks corrections up in.
enum class TableKind {
  own_axis,     ///< a table per axis, of its own position for itself
  axis_pairs,   ///< tables of one axis's position, for itself and for others
  lattice,      ///< corrections over a grid of positions of several axes
  error_model,  ///< the errors themselves; the control computes the corrections
  skew,         ///< angles between axes
};

/// Fields of a ControlTableRequest that not every format has a use for.
enum class TableSetting {
  type,
  first_table,
  encoder,
  negate,
  negate_own,
  detection_unit,
  reference_position,
  reference,
  names,
  axes,
  tolerance_mm,
  tolerance_rad,
  most_nodes,
};
/// In the order above.
const std::vector<TableSetting>& table_settings();
/// The option of `abbe compensate table` that gives it: "--negate".
const char* setting_option(TableSetting setting);

/// What a writer is asked for: a ControlTableRequest with everything filled in; mm and rad.
struct WriterRequest {
  std::vector<double> reference;  ///< [axes] where the other axes stand while one moves
  std::vector<bool> axes;         ///< [axes] wanted
  double tolerance_mm = 1e-4;
  double tolerance_rad = 1e-7;
  std::size_t most_nodes = 0;              ///< 0: what the control has room for
  std::size_t nodes = 0;                   ///< if not 0: exactly so many per table, to compare quickly
  std::vector<TableAxisName> names;        ///< as the control calls the axes
  std::set<std::string> left_out;          ///< TableFigures::name of tables that are not written
  int type = 1;                            ///< linuxcnc: COMP_FILE_TYPE
  std::size_t encoder = 0;                 ///< siemens-eec
  std::size_t first_table = 0;             ///< siemens-cec
  bool negate = false;                     ///< values with the other sign, where the control's is not known for sure
  bool negate_own = false;                 ///< heidenhain-kinematics-comp: the same for the columns of axes themselves
  double unit_mm = 1e-3;                   ///< FANUC: detection unit; of rotary axes as many degrees
  std::vector<double> reference_position;  ///< [axes] FANUC: reference position of the control, mm or rad
};

/// A table with what its uncertainty is computed from.
struct WrittenTable : TableFigures {
  std::vector<double> positions;    ///< places at which the uncertainty is looked at
  std::vector<double> corrections;  ///< [positions]
  /// The same values for other errors, at the same positions. Refers to the machine that the writer was given.
  std::function<std::vector<double>(const ErrorSet&)> values;
};

/// Tables for a control, written and read back. Refers to the machine that the writer was given.
struct WrittenTables {
  std::vector<ControlFile> files;
  std::vector<WrittenTable> tables;
  std::vector<std::string> remarks;
  std::vector<std::string> problems;              ///< why the control could not hold them; then nothing is written
  std::unique_ptr<CommandCorrection> correction;  ///< of the text as it is read back
};

/// A format: a row of data and a writer, in a file of its own.
struct TableFormat {
  std::string name;     ///< "siemens-cec"
  std::string control;  ///< whose tables they are: "SINUMERIK"
  TableKind kind = TableKind::own_axis;
  std::string what;              ///< one line
  std::string convention;        ///< sign and units of the values, how the control uses them
  std::string unverified;        ///< what of the syntax is not known for sure; empty: all of it is documented
  std::set<TableSetting> takes;  ///< the others would change nothing and are refused
  std::string axis_names;        ///< what ControlAxisName::name is: "number of the joint"; empty: no axes are named
  bool file_per_axis = false;    ///< one axis alone is one file
  std::size_t most_nodes = 10000;
  double default_tolerance_mm = 1e-4;
  std::string cannot;       ///< why what is not carried is not
  bool directions = false;  ///< tables differ by direction: reversal values are in them
  /// Which setting of the control compensates a lost motion (minus the reversal value, mm or rad) of an axis, given by
  /// its name in the control, where the tables do not; null: not known.
  std::function<std::string(const std::string& axis, double lost_motion, bool rotary)> backlash;
  /// What the control calls the axis that it counts as `index`, from 0 (joint_order.h); null: as the machine file does.
  std::function<std::string(std::size_t index, const Axis& axis)> default_name;
  /// @throws InputError for a machine or a request that the control cannot take
  std::function<WrittenTables(const Machine&, const ErrorSet&, const WriterRequest&)> write;
};

/// All formats, in the order in which they are listed.
const std::vector<TableFormat>& table_formats();
/// @throws InputError naming the formats there are
const TableFormat& table_format(const std::string& name);

/// @throws InputError for a setting that would have no effect: a user who negates a sign must know that it was not
void refuse_settings_of_other_formats(const TableFormat& format, const std::set<TableSetting>& given);

/// What names of axes have to be, for messages: "AXIS=NAME, such as X=X1; here the number of the joint".
std::string axis_names_expected(const TableFormat& format);

}  // namespace abbe
