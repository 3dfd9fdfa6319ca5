#include "abbe/formats/study/study_quantity.h"

#include <fmt/format.h>

namespace abbe {
namespace {

/// What the file says of the knowledge of a quantity that has (or has not) an uncertainty.
Knowledge read_knowledge(TomlTable& table, const std::string& base, Knowledge unstated, bool has_uncertainty) {
  const std::string key = "estimate_" + base;
  if (!table.has(key)) {
    table.boolean_or(key, false);
    return has_uncertainty ? Knowledge::within : unstated;
  }
  const bool estimate = table.boolean_or(key, false);
  if (!has_uncertainty) return estimate ? Knowledge::open : Knowledge::exact;
  if (!estimate) table.fail(key, "is given together with a standard uncertainty", "only one of them");
  return Knowledge::within;
}

void refuse_truth(const TomlTable& table, const std::string& base, Quantity quantity, bool simulated) {
  if (!simulated) table.fail_quantity(base, quantity, "belongs to a simulation only", "[simulate]");
}

}  // namespace

SetupNumber read_setup_number(TomlTable& table, std::string_view base, Quantity quantity, Knowledge unstated,
                              bool simulated, std::optional<double> otherwise) {
  const std::string name(base), uncertainty = name + "_standard_uncertainty", truth = "true_" + name;
  SetupNumber number;
  number.value = otherwise ? table.number_or(name, quantity, *otherwise) : table.number(name, quantity);
  const std::optional<double> u = table.optional_number(uncertainty, quantity);
  if (u && !(*u > 0)) table.fail_quantity(uncertainty, quantity, "is not above zero", "a standard uncertainty");
  number.standard_uncertainty = u.value_or(0);
  number.knowledge = read_knowledge(table, name, unstated, u.has_value());
  number.truth = table.optional_number(truth, quantity);
  if (number.truth) refuse_truth(table, truth, quantity, simulated);
  return number;
}

SetupPoint read_setup_point(TomlTable& table, std::string_view base, Knowledge unstated, bool simulated,
                            std::optional<Eigen::Vector3d> otherwise) {
  const std::string name(base), uncertainty = name + "_standard_uncertainty", truth = "true_" + name;
  std::vector<double> values(3);
  if (auto given = table.optional_numbers(name, Quantity::length, 3)) {
    values = *given;
  } else if (otherwise) {
    for (int i = 0; i < 3; ++i) values[static_cast<std::size_t>(i)] = (*otherwise)[i];
  } else {
    values = table.numbers(name, Quantity::length, 3);
  }
  const std::optional<std::vector<double>> u = table.optional_numbers(uncertainty, Quantity::length, 3);
  const std::optional<std::vector<double>> real = table.optional_numbers(truth, Quantity::length, 3);
  if (real) refuse_truth(table, truth, Quantity::length, simulated);
  const Knowledge knowledge = read_knowledge(table, name, unstated, u.has_value());
  SetupPoint point;
  for (std::size_t i = 0; i < 3; ++i) {
    if (u && !((*u)[i] > 0)) {
      table.fail_quantity(uncertainty, Quantity::length, "is not above zero", "three standard uncertainties");
    }
    point.coordinate[i] = {values[i], knowledge, u ? (*u)[i] : 0.0, {}};
    if (real) point.coordinate[i].truth = (*real)[i];
  }
  return point;
}

std::vector<NamedPoint> read_named_points(TomlTable& table, std::string_view key, Knowledge unstated, bool simulated) {
  std::vector<NamedPoint> points;
  for (TomlTable& entry : table.tables(key)) {
    points.push_back({entry.text("name"), read_setup_point(entry, "centre", unstated, simulated)});
    entry.finish();
  }
  if (points.empty()) {
    table.fail("", fmt::format("there is no {}", key),
               fmt::format("[[{}]] with name and centre_mm = [x, y, z]", table.full_name(key)));
  }
  return points;
}

double read_noise(TomlTable& table, std::string_view base, Quantity quantity) {
  const double noise = table.number(base, quantity);
  if (!(noise > 0)) table.fail_quantity(base, quantity, "is not above zero", "a standard uncertainty");
  return noise;
}

}  // namespace abbe
