#include <nlohmann/json.hpp>
#include <string>

#include "abbe/machine/axis_unit.h"
#include "abbe/verify/evaluations/statistics.h"
#include "wang/dial_tables.h"
#include "wang/tables.h"

namespace abbe {

nlohmann::ordered_json wang_dials_json(const WangDialFigures& figures) {
  nlohmann::ordered_json json;
  for (const WangGridComparison& grid : figures.grids) {
    json["one_dial_grids"][grid.axis] = {{"printed_rms_bias_um", {1e3 * grid.printed_second, 1e3 * grid.printed_first}},
                                         {"printed_roll_rms_bias_urad", 1e6 * grid.printed_roll},
                                         {"printed_pitch_yaw_urad", {1e6 * grid.printed_pitch, 1e6 * grid.printed_yaw}},
                                         {"correct_rms_bias_um", {1e3 * grid.correct_second, 1e3 * grid.correct_first}},
                                         {"correct_roll_rms_bias_urad", 1e6 * grid.correct_roll},
                                         {"dial_travel_if_degrees_mm", grid.dial_range_mm}};
  }
  const Machine machine = wang_machine();
  for (const WangDialAxis& axis : figures.study.axes) {
    const std::size_t index = machine.find_axis(kWangAxisNames[axis.table]);
    nlohmann::ordered_json uncertainty;
    for (std::size_t c = 0; c < 6; ++c) {
      if (!axis.with_noise.seen[c]) continue;
      const auto component = static_cast<Component>(c);
      const bool angle = is_rotation(component);
      uncertainty[error_motion_name(machine, index, component) + "_" + micro_unit(angle)] =
          axis.largest_standard_uncertainty(c) * micro_per_unit(angle);
    }
    json["axes"][kWangAxisNames[axis.table]] = {{"bias_um", 1e3 * axis.bias_mm},
                                                {"bias_urad", 1e6 * axis.bias_rad},
                                                {"largest_standard_uncertainty", uncertainty}};
  }
  json["seen_by_the_papers_instruments"] = figures.study.seen_by_dials;
  json["values"] = figures.study.values;
  json["values_within_k2"] = figures.study.inside;
  const WangDialMap& map = figures.map;
  json["map"] = {{"poses", map.poses},
                 {"mean_um", 1e3 * map.norm.mean},
                 {"mean_standard_uncertainty_um", 1e3 * map.uncertainty.mean},
                 {"largest_standard_uncertainty_um", 1e3 * map.uncertainty.maximum},
                 {"components_within_k2", map.inside}};
  const auto list = [](const Eigen::Vector3d& v) {
    return nlohmann::ordered_json{1e3 * v.x(), 1e3 * v.y(), 1e3 * v.z()};
  };
  json["zero_pose_um"] = list(map.zero_pose);
  json["zero_pose_standard_uncertainty_um"] = list(map.zero_pose_uncertainty);
  return json;
}

nlohmann::ordered_json wang_ball_bar_json(const WangBallBarStudy& bar) {
  nlohmann::ordered_json json;
  for (const WangBallBarModel& model : bar.models) {
    for (const WangCircle& circle : model.circles) {
      if (circle.converged) json[model.name][circle.plane] = 1e3 * circle.circular;
    }
  }
  for (std::size_t i = 0; i < bar.with_noise.size(); ++i) {
    const WangCircle& circle = bar.with_noise[i];
    const SampleStatistics band = sample_statistics(circle.uncertainty);
    json["from decoupled errors"][circle.plane] = {
        {"circular_deviation_um", circle.converged ? nlohmann::ordered_json(1e3 * circle.circular) : nullptr},
        {"circular_deviation_U_k2_um", 2e3 * circle.circular_uncertainty},
        {"deviation_U_k2_mean_um", 2e3 * band.mean},
        {"deviation_U_k2_largest_um", 2e3 * band.maximum},
        {"share_within_k2", wang_share_within(circle, bar.without_noise[i])}};
  }
  return json;
}

}  // namespace abbe
