#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/study/study_parts.h"
#include "abbe/instruments/setup_drift.h"

namespace abbe {
namespace {

constexpr int kLargestDriftDegree = 3, kMostKnots = 200, kUsualKnots = 24;
constexpr double kDriftHour = 3600;
constexpr double kUsualWalk = 1e-3;  // mm/sqrt(h): where an estimate starts; turns: rad/sqrt(h) per metre of it

/// "random_walk_um_per_sqrt_h" in mm/sqrt(s), "random_walk_urad_per_sqrt_h" in rad/sqrt(s).
std::optional<double> read_walk(TomlTable& table, const char* unit) {
  const std::string key = fmt::format("random_walk_{}_per_sqrt_h", unit);
  const std::optional<double> value = table.optional_number(key, Quantity::dimensionless);
  if (!value) return std::nullopt;
  if (!(*value > 0)) table.fail(key, "is not above zero", "how far it wanders in an hour, for example 3");
  return *value / std::sqrt(kDriftHour) * (unit == std::string("um") ? 1e-3 : 1e-6);
}

std::vector<int> read_drift_components(TomlTable& table) {
  std::vector<int> components;
  for (const std::string& name : table.texts_or_none("components")) {
    int component = 0;
    while (component < 6 && name != drift_component_name(component)) ++component;
    if (component == 6) {
      table.fail("components", fmt::format("\"{}\" is not a motion of a set-up", name), "x, y, z, rx, ry, rz");
    }
    if (std::find(components.begin(), components.end(), component) != components.end()) {
      table.fail("components", fmt::format("\"{}\" is given twice", name), "each motion once");
    }
    components.push_back(component);
  }
  std::sort(components.begin(), components.end());
  return components.empty() ? std::vector<int>{0, 1, 2} : components;
}

void read_true_drift(TomlTable& table, DriftPlan& plan) {
  TrueDrift& truth = plan.truth.emplace();
  for (int c = 0; c < 6; ++c) {
    const auto values = table.optional_numbers(drift_component_name(c), c < 3 ? Quantity::length : Quantity::angle);
    if (!values) continue;
    if (values->empty() || values->size() > kLargestDriftDegree) {
      table.fail_quantity(drift_component_name(c), c < 3 ? Quantity::length : Quantity::angle,
                          fmt::format("has {} coefficients", values->size()),
                          "one to three: of s, s^2, s^3, s from 0 to 1 over the readings");
    }
    truth.polynomial[static_cast<std::size_t>(c)] = *values;
  }
  truth.walk_length = read_walk(table, "um").value_or(0);
  truth.walk_angle = read_walk(table, "urad").value_or(0);
  table.finish();
}

bool has_component(const DriftPlan& plan, bool angle) {
  return std::any_of(plan.components.begin(), plan.components.end(), [&](int c) { return (c >= 3) == angle; });
}

void read_random_walk(TomlTable& table, DriftPlan& plan) {
  const std::size_t word = table.word_or("random_walk", 1, {"none", "stated", "estimated"});
  const std::optional<double> length = read_walk(table, "um"), angle = read_walk(table, "urad");
  plan.estimate_walk = word == 2;
  plan.walks = plan.estimate_walk || (word == 1 && (length || angle));
  if (word == 0 && (length || angle)) {
    table.fail("random_walk", "is \"none\" beside an intensity", "random_walk = \"stated\" or \"estimated\"");
  }
  plan.walk_length = length.value_or(kUsualWalk / std::sqrt(kDriftHour));
  plan.walk_angle = angle.value_or(1e-3 * kUsualWalk / std::sqrt(kDriftHour));
  if (!plan.walks || plan.estimate_walk) {
    if (!plan.walks && table.has("random_walk") && word == 1) {
      table.fail("random_walk", "is \"stated\", and no intensity is", "random_walk_um_per_sqrt_h = 3");
    }
    return;
  }
  if (has_component(plan, false) && !length) {
    table.fail("", "shifts wander, and it is not said how far", "random_walk_um_per_sqrt_h");
  }
  if (has_component(plan, true) && !angle) {
    table.fail("", "turns wander, and it is not said how far", "random_walk_urad_per_sqrt_h");
  }
}

}  // namespace

std::optional<DriftPlan> read_drift(TomlTable& setup, bool simulated) {
  auto table = setup.optional_table("drift");
  if (!table) return std::nullopt;
  DriftPlan plan;
  plan.components = read_drift_components(*table);
  plan.degree = static_cast<int>(table->integer_or("degree", 0, 0, kLargestDriftDegree));
  read_random_walk(*table, plan);
  plan.knots = static_cast<std::size_t>(table->integer_or("knots", kUsualKnots, 2, kMostKnots));
  if (table->has("knots") && !plan.walks) table->fail("knots", "are those of a random walk", "random_walk");
  if (const auto about = table->optional_numbers("about", Quantity::length, 3)) {
    plan.about = Eigen::Vector3d((*about)[0], (*about)[1], (*about)[2]);
  }
  if (auto truth = table->optional_table("true")) {
    if (!simulated) table->fail("true", "belongs to a simulation only", "[simulate]");
    read_true_drift(*truth, plan);
  }
  table->finish();
  if (!plan.is_identified() && !plan.truth) {
    table->fail("", "nothing is said to drift", "degree = 1 to 3, or random_walk_um_per_sqrt_h");
  }
  return plan;
}

}  // namespace abbe
