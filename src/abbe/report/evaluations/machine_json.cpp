#include "abbe/report/evaluations/machine_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/machine/machine_couplings.h"
#include "abbe/formats/text/vector_json.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {

double for_drawing(double value) {
  if (value == 0 || !std::isfinite(value)) return 0;
  const double digits = std::pow(10.0, 3 - std::floor(std::log10(std::abs(value))));
  return std::isfinite(digits) && digits > 0 ? std::round(value * digits) / digits : value;
}

nlohmann::ordered_json axis_json(const Axis& axis) {
  nlohmann::ordered_json json;
  json["name"] = axis.name;
  json["kind"] = axis.kind == AxisKind::rotary ? "rotary" : "linear";
  json["side"] = axis.side == ChainSide::workpiece ? "workpiece" : "tool";
  json["primed"] = axis.primed;
  json["direction"] = vector_json(axis.direction);
  json["point_mm"] = vector_json(axis.point);
  return json;
}

void add_couplings(const Machine& machine, std::size_t axis, nlohmann::ordered_json& json) {
  for (const WrittenCoupling& coupling : written_couplings(machine, axis)) {
    for (const auto& ratio : coupling.ratios) json[coupling.key][ratio.of] = ratio.value;
  }
}

nlohmann::ordered_json report_machine(const Machine& machine) {
  nlohmann::ordered_json json;
  json["name"] = machine.name;
  json["description"] = machine.description;
  json["chain"] = machine.chain();
  json["tool_offset_mm"] = vector_json(machine.tool_offset);
  json["tool_reference_mm"] = vector_json(machine.tool_reference);
  json["tool_direction"] = vector_json(machine.tool_direction);
  json["workpiece_origin_mm"] = vector_json(machine.bed_from_workpiece.translation);
  json["axes"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    nlohmann::ordered_json entry = axis_json(axis);
    const double unit = position_unit(axis);
    entry[std::string("travel_min_") + position_suffix(axis)] = axis.travel_min / unit;
    entry[std::string("travel_max_") + position_suffix(axis)] = axis.travel_max / unit;
    if (axis.kind == AxisKind::rotary) entry["endless"] = axis.endless;
    add_couplings(machine, i, entry);
    json["axes"].push_back(entry);
  }
  return json;
}

}  // namespace abbe
