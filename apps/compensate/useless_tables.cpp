#include "compensate/useless_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "abbe/compensate/point_correction.h"
#include "abbe/formats/input_error.h"
#include "compensate/table_options.h"

namespace abbe {
namespace {

/// Below it nothing is worth a table: mm and rad, root mean square.
constexpr double kNothingToCorrect = 1e-6;
/// Another format is named if it leaves no more than this share of the error.
constexpr double kWorthNaming = 0.5;
constexpr std::size_t kQuickNodes = 33;

bool is_reversal(const TableReport& report, const CarriedError& error) {
  return std::any_of(report.reversals.begin(), report.reversals.end(),
                     [&](const std::pair<std::string, std::string>& one) { return one.first == error.name; });
}

/// Formats that take most of these errors away on this machine.
std::vector<std::string> formats_that_do(const ErrorSet& errors, const TableRequest& request,
                                         const TableReport& report) {
  const Machine& machine = *report.machine;
  std::vector<std::string> names;
  for (const TableFormat& format : table_formats()) {
    if (format.name == report.format->name) continue;
    try {
      TableRequest quick = request;
      quick.names = table_axis_names(machine, format, {});
      quick.left_out.clear();
      quick.negate = false;
      quick.most_nodes = 0;
      quick.nodes = kQuickNodes;
      const ControllerTables tables = format.make(machine, errors, quick);
      if (!tables.problems.empty()) continue;
      const PoseDeviations after = deviations_with(machine, errors, report.poses, *tables.correction);
      if (after.position_statistics.rms <= kWorthNaming * report.before.position_statistics.rms) {
        names.push_back(format.name);
      }
    } catch (const InputError&) {
      continue;  // The format needs options that only the user knows, or another machine.
    }
  }
  return names;
}

}  // namespace

std::string useless_tables(const ErrorSet& errors, const TableRequest& request, const TableReport& report,
                           double least_percent) {
  const double least = 0.01 * least_percent;
  const double before = report.before.position_statistics.rms, after = report.after.position_statistics.rms;
  const double turn_before = report.before.orientation_statistics.rms,
               turn_after = report.after.orientation_statistics.rms;
  if (!(least > 0) || (before < kNothingToCorrect && turn_before < kNothingToCorrect)) return {};
  const bool all_left_out = report.tables->tables.empty() && !report.left_out.empty();
  if (all_left_out || before - after >= least * before) return {};
  if (turn_before >= kNothingToCorrect && turn_before - turn_after >= least * turn_before) return {};
  std::string not_carried;
  for (const CarriedError& error : report.errors) {
    if (error.effect_before - error.effect_after >= least * before) return {};
    const bool counts = error.effect_before >= least * before && !is_reversal(report, error);
    if (counts) not_carried += (not_carried.empty() ? "" : ", ") + error.name;
  }
  if (not_carried.empty()) return {};
  std::string text = fmt::format(
      "the tables would take away {:.2g} % of the volumetric error ({:.3f} to {:.3f} um rms), less than "
      "--least-reduction-percent {:g}: {} does not carry {}",
      std::max(0.0, 100 * (before - after) / before), 1e3 * before, 1e3 * after, least_percent, report.format->name,
      not_carried);
  std::string ways;
  for (const std::string& format : formats_that_do(errors, request, report))
    ways += (ways.empty() ? "" : ", ") + format;
  text += ways.empty() ? "; no other table does either. " : fmt::format("; tables that do: {}. ", ways);
  return text + "`abbe compensate gcode` corrects the programs instead";
}

}  // namespace abbe
