#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "abbe/compensate/command_correction.h"
#include "abbe/errors/error_set.h"
#include "abbe/formats/table_axis_names.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// What the user asks of tables; mm and rad.
struct TableRequest {
  std::vector<double> reference;  ///< [axes] where the other axes stand while one moves
  std::vector<bool> axes;         ///< [axes] wanted
  double tolerance_mm = 1e-4;
  double tolerance_rad = 1e-7;
  std::size_t most_nodes = 0;              ///< 0: what the control has room for
  std::size_t nodes = 0;                   ///< if not 0: exactly so many per table, to compare quickly
  std::vector<TableAxisName> names;        ///< as the control calls the axes
  std::set<std::string> left_out;          ///< names of tables (TableSummary::name) that are not written
  int type = 1;                            ///< linuxcnc: COMP_FILE_TYPE
  std::size_t encoder = 0;                 ///< siemens-eec
  std::size_t first_table = 0;             ///< siemens-cec
  bool negate = false;                     ///< values with the other sign, where the control's is not known for sure
  double unit_mm = 1e-3;                   ///< FANUC: detection unit; of rotary axes as many degrees
  std::vector<double> reference_position;  ///< [axes] FANUC: reference position of the control, mm or rad
};

/// A part of the tables that can be left out, and what it says.
struct TableSummary {
  std::string name;  ///< "X", "Y for X"
  std::size_t nodes = 0;
  double step = 0;  ///< mm or rad
  bool step_is_angle = false;
  bool is_angle = false;            ///< the values
  double largest = 0;               ///< mm or rad
  double largest_at = 0;            ///< where, mm or rad
  double interpolation_error = 0;   ///< mm or rad
  bool within = true;               ///< the tolerance of interpolation is kept
  std::vector<double> positions;    ///< places at which the uncertainty is looked at
  std::vector<double> corrections;  ///< [positions]
  /// The same values for other errors, at the same positions.
  std::function<std::vector<double>(const ErrorSet&)> values;
};

/// Tables for a control, written and read back.
struct ControllerTables {
  std::vector<std::pair<std::string, std::string>> files;  ///< name proposed, text
  std::vector<TableSummary> tables;
  std::vector<std::string> remarks;
  std::vector<std::string> problems;              ///< why the control could not hold them; then nothing is written
  std::unique_ptr<CommandCorrection> correction;  ///< of the text as it is read back
};

struct TableFormat {
  std::string name;
  std::string what;            ///< one line
  std::string convention;      ///< sign and units of the values, how the control uses them
  std::string unverified;      ///< what of the syntax is not known for sure; empty: all of it is documented
  std::string axis_names;      ///< what --name gives: "joint number", empty: the format names no axes
  bool file_per_axis = false;  ///< one axis alone is one file
  std::size_t most_nodes = 10000;
  double default_interpolation_um = 0.1;
  std::string cannot;       ///< why what is not carried is not
  bool directions = false;  ///< tables differ by direction: reversal values are in them
  /// What of the control takes a lost motion (minus the reversal value) of an axis by its name there: "12 um", where
  /// the tables do not; null: nothing is known of it.
  std::function<std::string(const std::string& axis, double lost_motion, bool rotary)> backlash;
  std::function<std::string(std::size_t index, const Axis& axis)> default_name;
  std::function<ControllerTables(const Machine&, const ErrorSet&, const TableRequest&)> make;
};

const std::vector<TableFormat>& table_formats();
/// @throws InputError naming the formats there are
const TableFormat& table_format(const std::string& name);

}  // namespace abbe
