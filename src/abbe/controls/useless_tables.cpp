#include "abbe/controls/useless_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "abbe/controls/writer_request.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

/// Below it nothing is worth a table: mm and rad, root mean square.
constexpr double kNothingToCorrect = 1e-6;
/// Another format is named if it leaves no more than this share of the error.
constexpr double kWorthNaming = 0.5;
constexpr std::size_t kQuickNodes = 33;

bool is_reversal(const ControlTables& made, const CarriedError& error) {
  return std::any_of(made.reversals.begin(), made.reversals.end(),
                     [&](const ControlNote& one) { return one.name == error.name; });
}

/// Formats that take most of these errors away on this machine.
std::vector<std::string> formats_that_do(const Machine& machine, const ErrorSet& errors, const WriterRequest& request,
                                         const ControlTables& made) {
  std::vector<std::string> names;
  for (const TableFormat& format : table_formats()) {
    if (format.name == made.format->name) continue;
    try {
      WriterRequest quick = request;
      quick.names = control_axis_names(machine, format, {});
      quick.left_out.clear();
      quick.negate = quick.negate_own = false;
      quick.most_nodes = 0;
      quick.nodes = kQuickNodes;
      const WrittenTables tables = format.write(machine, errors, quick);
      if (!tables.problems.empty()) continue;
      const PoseDeviations after = deviations_with(machine, errors, made.poses, *tables.correction);
      if (after.position_statistics.rms <= kWorthNaming * made.before.position_statistics.rms) {
        names.push_back(format.name);
      }
    } catch (const InputError&) {
      continue;  // The format needs options that only the user knows, or another machine.
    }
  }
  return names;
}

}  // namespace

std::string useless_tables(const Machine& machine, const ErrorSet& errors, const WriterRequest& request,
                           const ControlTables& made, double least_reduction) {
  const double least = least_reduction;
  const double before = made.before.position_statistics.rms, after = made.after.position_statistics.rms;
  const double turn_before = made.before.orientation_statistics.rms, turn_after = made.after.orientation_statistics.rms;
  if (!(least > 0) || (before < kNothingToCorrect && turn_before < kNothingToCorrect)) return {};
  const bool all_left_out = made.tables.empty() && !made.left_out.empty();
  if (all_left_out || before - after >= least * before) return {};
  if (turn_before >= kNothingToCorrect && turn_before - turn_after >= least * turn_before) return {};
  std::string not_carried;
  for (const CarriedError& error : made.errors) {
    if (error.effect_before - error.effect_after >= least * before) return {};
    const bool counts = error.effect_before >= least * before && !is_reversal(made, error);
    if (counts) not_carried += (not_carried.empty() ? "" : ", ") + error.name;
  }
  if (not_carried.empty()) return {};
  std::string text = fmt::format(
      "the tables would remove {:.2g} % of the volumetric error ({:.3f} to {:.3f} um rms), less than "
      "--least-reduction-percent {:g}: {} does not carry {}",
      std::max(0.0, 100 * (before - after) / before), 1e3 * before, 1e3 * after, 100 * least, made.format->name,
      not_carried);
  std::string ways;
  for (const std::string& format : formats_that_do(machine, errors, request, made))
    ways += (ways.empty() ? "" : ", ") + format;
  text += ways.empty() ? "; no other table does either. " : fmt::format("; tables that do: {}. ", ways);
  return text + "`abbe compensate gcode` corrects the programs instead";
}

}  // namespace abbe
