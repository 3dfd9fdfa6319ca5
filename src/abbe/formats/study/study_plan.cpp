#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "abbe/formats/study/study_parts.h"

namespace abbe {
namespace {

constexpr int kLargestPointCount = 10'000'000;
constexpr int kLargestRepeatCount = 10'000;
constexpr int kLargestStepCount = 100'000;

std::string all_names(const std::vector<std::string>& items) {
  std::string names;
  for (const std::string& item : items) names += (names.empty() ? "" : ", ") + item;
  return names;
}

std::size_t find_name(const std::vector<std::string>& items, const std::string& name) {
  return static_cast<std::size_t>(std::find(items.begin(), items.end(), name) - items.begin());
}

/// Unit direction of "X", "Y" or "Z" of the machine frame.
Eigen::Vector3d machine_direction(TomlTable& table, const std::string& word) {
  static const std::vector<std::string> kWords = {"X", "Y", "Z"};
  const std::size_t axis = find_name(kWords, word);
  if (axis == kWords.size())
    table.fail("plane", fmt::format("unknown direction \"{}\"", word), "\"X\", \"Y\" or \"Z\"");
  return Eigen::Vector3d::Unit(static_cast<Eigen::Index>(axis));
}

void read_circle(TomlTable& table, MeasurementPlan& plan) {
  const std::vector<std::string> plane = table.texts("plane");
  if (plane.size() != 2 || plane[0] == plane[1]) {
    table.fail("plane", "is not a plane", "two directions of the machine frame: plane = [\"X\", \"Y\"]");
  }
  plan.circle.u = machine_direction(table, plane[0]);
  plan.circle.v = machine_direction(table, plane[1]);
  plan.circle.radius = table.number("radius", Quantity::length);
  if (!(plan.circle.radius > 0)) {
    table.fail_quantity("radius", Quantity::length, "is not above zero", "the radius of the circle");
  }
  plan.circle.from_angle = table.number_or("from", Quantity::angle, 0);
  plan.circle.to_angle = table.number_or("to", Quantity::angle, 2 * std::numbers::pi);
  plan.circle.count = static_cast<std::size_t>(plan.points);
}

/// Axes that move, as the file orders them, or in the order of the chain.
void read_step_diagonal(TomlTable& table, const Machine& machine, MeasurementPlan& plan) {
  plan.steps = static_cast<std::size_t>(table.integer("steps", 1, kLargestStepCount));
  for (const std::string& name : table.texts_or_none("order")) {
    const std::size_t axis = machine.find_axis(name);
    if (axis == Machine::npos || plan.axes[axis].is_fixed()) {
      table.fail("order", fmt::format("{} does not move", name), "axes with a range");
    }
    if (std::find(plan.order.begin(), plan.order.end(), axis) != plan.order.end()) {
      table.fail("order", fmt::format("{} is given twice", name), "every moving axis once");
    }
    plan.order.push_back(axis);
  }
  const bool by_chain = plan.order.empty();
  for (std::size_t axis = 0; axis < plan.axes.size(); ++axis) {
    if (plan.axes[axis].is_fixed()) continue;
    if (by_chain) plan.order.push_back(axis);
    if (std::find(plan.order.begin(), plan.order.end(), axis) == plan.order.end()) {
      table.fail("order", fmt::format("{} has a range and is missing", machine.axes[axis].name),
                 "every moving axis once");
    }
  }
}

void read_targets(TomlTable& table, const PlanNames& names, MeasurementPlan& plan) {
  for (const std::string& name : table.texts_or_none(names.key)) {
    plan.targets.push_back(find_name(names.targets, name));
    if (plan.targets.back() < names.targets.size()) continue;
    table.fail(names.key, fmt::format("there is no {} \"{}\"", names.one, name), "one of " + all_names(names.targets));
  }
  if (plan.targets.empty()) {
    for (std::size_t i = 0; i < names.targets.size(); ++i) plan.targets.push_back(i);
  }
  if (names.stations.empty()) return;
  const std::string station = table.text_or("station", names.stations.front());
  plan.station = find_name(names.stations, station);
  if (plan.station == names.stations.size()) {
    table.fail("station", fmt::format("there is no station \"{}\"", station), "one of " + all_names(names.stations));
  }
}

void check_moving_axes(TomlTable& table, const Machine& machine, const MeasurementPlan& plan) {
  std::ptrdiff_t moving = 0;
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    if (plan.axes[i].is_fixed()) continue;
    ++moving;
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    if (plan.kind == PlanKind::follow && !rotary) {
      table.fail("axis", fmt::format("{} is linear and follows by itself", machine.axes[i].name),
                 "ranges of rotary axes only");
    }
    if (plan.kind == PlanKind::circle) {
      table.fail("axis", fmt::format("{} goes round by itself, or stays", machine.axes[i].name), "at_mm or at_deg");
    }
  }
  const bool two = plan.kind == PlanKind::spiral || plan.kind == PlanKind::step_diagonal;
  const std::ptrdiff_t needed = two ? 2 : plan.kind == PlanKind::circle ? 0 : 1;
  if (moving < needed) {
    table.fail("", "too few axes move", needed == 2 ? "ranges of two axes" : "the range of an axis");
  }
}

}  // namespace

MeasurementPlan read_plan(TomlTable& table, const std::filesystem::path& folder, const Machine& machine,
                          const PlanNames& names) {
  MeasurementPlan plan;
  plan.kind = static_cast<PlanKind>(
      table.word("kind", {"grid", "line", "random", "spiral", "circle", "follow", "step-diagonal", "poses"}));
  if (plan.kind == PlanKind::poses) {
    plan.file = folder / table.text("file");
    plan.repeats = static_cast<std::size_t>(table.integer_or("repeats", 1, 1, kLargestRepeatCount));
    plan.there_and_back = table.boolean_or("there_and_back", false);
    for (std::size_t i = 0; i < names.targets.size(); ++i) plan.targets.push_back(i);
    table.finish();
    return plan;
  }
  const bool is_grid = plan.kind == PlanKind::grid || plan.kind == PlanKind::follow;
  const bool is_step_diagonal = plan.kind == PlanKind::step_diagonal;
  const bool may_fall = plan.kind == PlanKind::line || is_step_diagonal;
  plan.axes = read_axis_ranges(table, machine, is_grid, may_fall ? RangeOrder::either : RangeOrder::rising);
  if (is_step_diagonal) read_step_diagonal(table, machine, plan);
  if (!is_grid && !is_step_diagonal) plan.points = static_cast<int>(table.integer("points", 1, kLargestPointCount));
  if (plan.kind == PlanKind::spiral) plan.turns = table.size_or("turns", Quantity::dimensionless, 5);
  if (plan.kind == PlanKind::circle) read_circle(table, plan);
  if (plan.kind == PlanKind::follow) {
    if (const auto displacement = table.optional_numbers("displacement", Quantity::length, 3)) {
      plan.displacement = {(*displacement)[0], (*displacement)[1], (*displacement)[2]};
    }
  }
  if ((plan.kind == PlanKind::circle || plan.kind == PlanKind::follow) && !names.stations.empty()) {
    table.fail("kind", "a tracker has no points that meet",
               "\"grid\", \"line\", \"random\", \"spiral\" or \"step-diagonal\"");
  }
  check_moving_axes(table, machine, plan);
  if (is_grid) {
    double poses = 1;
    for (const AxisRange& range : plan.axes) poses *= range.is_fixed() ? 1 : static_cast<double>(range.count);
    if (poses > kLargestPointCount) table.fail("", fmt::format("the grid has {:.3g} poses", poses), "at most 1e7");
  }
  plan.repeats = static_cast<std::size_t>(table.integer_or("repeats", 1, 1, kLargestRepeatCount));
  plan.there_and_back = table.boolean_or("there_and_back", false);
  read_targets(table, names, plan);
  table.finish();
  return plan;
}

}  // namespace abbe
