#include "abbe/report/words/machine_check_words.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/machine/coupling.h"
#include "abbe/machine/drawing.h"
#include "abbe/machine/machine_check.h"
#include "abbe/report/evaluations/machine_json.h"

namespace abbe {
namespace {

std::vector<std::string> motion_names(const Machine& machine, std::size_t axis) {
  std::vector<std::string> names;
  for (int k = 0; k < kComponentCount; ++k) {
    names.push_back(error_motion_name(machine, axis, static_cast<Component>(k)));
  }
  return names;
}

std::vector<std::string> location_names(const Machine& machine, std::size_t axis) {
  std::vector<std::string> names;
  for (int k = 0; k < kComponentCount; ++k) {
    const Component component = static_cast<Component>(k);
    if (location_error_is_valid(machine.axes[axis], component)) {
      names.push_back(location_error_name(machine, axis, component));
    }
  }
  return names;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::string travel_text(const Axis& axis) {
  if (axis.endless) return "endless";
  const double unit = position_unit(axis);
  return fmt::format("{:g} .. {:g} {}", axis.travel_min / unit, axis.travel_max / unit, position_suffix(axis));
}

}  // namespace

nlohmann::ordered_json machine_check_json(const Machine& machine) {
  nlohmann::ordered_json json;
  json["name"] = machine.name;
  json["chain"] = machine.chain();
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    nlohmann::ordered_json entry = axis_json(axis);
    entry["endless"] = axis.endless;
    if (!axis.endless) {
      const double unit = position_unit(axis);
      entry[std::string("travel_") + position_suffix(axis)] = {axis.travel_min / unit, axis.travel_max / unit};
    }
    add_couplings(machine, i, entry);
    entry["error_motions"] = motion_names(machine, i);
    entry["location_errors"] = location_names(machine, i);
    json["axes"].push_back(entry);
  }
  json["notes"] = find_remarks(machine);
  return json;
}

std::string machine_check_text(const Machine& machine) {
  std::string text;
  if (!machine.description.empty()) text += fmt::format("{}\n\n", machine.description);
  text += fmt::format("{}\n", draw_machine(machine));
  text += fmt::format("{:<5} {:<7} {:<10} {:<24} {:<26} {}\n", "axis", "kind", "carries", "direction", "point / mm",
                      "travel");
  for (const Axis& axis : machine.axes) {
    const auto triple = [](const Eigen::Vector3d& v) { return fmt::format("({:g}, {:g}, {:g})", v.x(), v.y(), v.z()); };
    text += fmt::format("{:<5} {:<7} {:<10} {:<24} {:<26} {}\n", axis.name + (axis.primed ? "'" : ""),
                        axis.kind == AxisKind::rotary ? "rotary" : "linear",
                        axis.side == ChainSide::workpiece ? "workpiece" : "tool", triple(axis.direction),
                        triple(axis.point), travel_text(axis));
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const std::string formula = position_formula(machine, i);
    if (!formula.empty()) text += fmt::format("position of {}\n", formula);
  }
  std::size_t motions = 0, locations = 0;
  text += "\nerror motions (ISO 230-1, ISO 230-7) and location errors\n";
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const std::vector<std::string> names = location_names(machine, i);
    text += fmt::format("{:<5} {}   {}\n", machine.axes[i].name, joined(motion_names(machine, i)), joined(names));
    motions += kComponentCount;
    locations += names.size();
  }
  text += fmt::format("{} error motions, {} location errors\n", motions, locations);
  for (const std::string& remark : find_remarks(machine)) text += fmt::format("note: {}\n", remark);
  return text;
}

}  // namespace abbe
