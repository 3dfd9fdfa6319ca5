#include "abbe/report/words/workpiece_words.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace abbe {

std::string workpiece_line(const WorkpieceExpansion& workpiece, double coldest, double warmest) {
  return fmt::format(
      "workpiece: {:.6g} um/(m K), right at 20 degC and now at {:.6g}{}, fixed at ({:.6g}, {:.6g}, {:.6g}) mm\n",
      1e6 * workpiece.coefficient, coldest, warmest > coldest ? fmt::format(" to {:.6g} degC", warmest) : " degC",
      workpiece.fixed_point[0], workpiece.fixed_point[1], workpiece.fixed_point[2]);
}

void add_workpiece(const Machine& machine, const WorkpieceExpansion& workpiece, double coldest, double warmest,
                   nlohmann::ordered_json& json) {
  nlohmann::ordered_json one;
  if (workpiece.state != kNoState) one["state"] = machine.states.at(workpiece.state).name;
  one["coefficient_um_per_m_K"] = 1e6 * workpiece.coefficient;
  one["standard_uncertainty_um_per_m_K"] = 1e6 * workpiece.standard_uncertainty;
  one["temperature_standard_uncertainty_K"] = workpiece.temperature_uncertainty;
  one["temperatures_degC"] = {coldest, warmest};
  one["fixed_point_mm"] = {workpiece.fixed_point[0], workpiece.fixed_point[1], workpiece.fixed_point[2]};
  json["workpiece"] = std::move(one);
}

std::string workpiece_line(const std::optional<WorkpieceExpansion>& workpiece) {
  if (!workpiece || !workpiece->temperature) return {};
  return workpiece_line(*workpiece, *workpiece->temperature, *workpiece->temperature);
}

void add_workpiece(const std::optional<WorkpieceExpansion>& workpiece, nlohmann::ordered_json& json) {
  if (!workpiece || !workpiece->temperature) return;
  WorkpieceExpansion at_temperature = *workpiece;
  at_temperature.state = kNoState;
  add_workpiece({}, at_temperature, *workpiece->temperature, *workpiece->temperature, json);
}

}  // namespace abbe
