#include "abbe/controls/table_limits.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "abbe/machine/axis_unit.h"
#include "abbe/machine/position_words.h"

namespace abbe {
namespace {

/// Tables that make the error larger by more than this are refused.
constexpr double kWorse = 1.02;

void find_largest(const Machine& machine, const CommandCorrection& correction, ControlTables& made) {
  PoseList added;
  correction.evaluate(made.poses, added);
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    double& largest = rotary ? made.largest_rad : made.largest_mm;
    for (std::size_t k = 0; k < made.poses.count(); ++k) {
      if (!(std::abs(added.axis[i][k]) > largest)) continue;
      largest = std::abs(added.axis[i][k]);
      (rotary ? made.largest_rad_at : made.largest_mm_at) =
          fmt::format("{} for axis {}", position_words(machine, made.poses.pose(k)), machine.axes[i].name);
    }
  }
}

}  // namespace

void check_limits(const ControlTableRequest& request, const CommandCorrection& correction, ControlTables& made) {
  find_largest(request.machine, correction, made);
  const auto refuse = [&](double value, bool is_angle, const std::string& where) {
    const double scale = micro_per_unit(is_angle);
    const std::optional<double>& asked = is_angle ? request.limit_rad : request.limit_mm;
    if (!asked) return;
    const double limit = scale * *asked, shown = scale * value;
    if (!(shown <= limit)) {
      const char* const unit = micro_unit(is_angle);
      made.refused.push_back(fmt::format("{:.3f} {} is above --limit-{} {:g}: {}", shown, unit, unit, limit, where));
    }
  };
  const double before = made.before.position_statistics.rms, after = made.after.position_statistics.rms;
  if (!made.tables.empty() && after > kWorse * before) {
    made.refused.push_back(
        fmt::format("the displacement of the tool would grow from {:.3f} to {:.3f} um rms: the tables are valid only "
                    "near the reference pose (--at, --axis)",
                    1e3 * before, 1e3 * after));
  }
  for (const TableFigures& table : made.tables) refuse(table.largest, table.is_angle, "table " + table.name);
  refuse(made.largest_mm, false, made.largest_mm_at);
  refuse(made.largest_rad, true, made.largest_rad_at);
}

}  // namespace abbe
