#include "wang/results.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/report/evaluations/statistics_json.h"
#include "abbe/study/report/summary.h"
#include "progress.h"
#include "wang/tables.h"

namespace abbe {
namespace {

WangMeanColumn check_mean_column() {
  WangMeanColumn result;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    for (int component = 0; component < 6; ++component) {
      const auto value = [&](std::size_t i) {
        const WangRow& row = wang_row(axis, i);
        const double values[] = {row.dx, row.dy, row.dz, row.ex, row.ey, row.ez};
        return values[component];
      };
      bool constant = true;
      double sum = 0;
      for (std::size_t i = 0; i < 11; ++i) {
        sum += value(i);
        constant = constant && value(i) == value(0);
      }
      if (constant) continue;
      const double mean = sum / 11;
      ++result.rows;
      // Printed with one or two digits. A relative 1e-12 keeps a mean that ends in the printed digit from being cut
      // below it.
      for (const double step : {10.0, 100.0}) {
        if (std::abs(std::trunc(mean * step * (1 + 1e-12)) / step - value(11)) < 1e-9) {
          ++result.equal;
          break;
        }
      }
    }
  }
  return result;
}

std::vector<WangPopulationRow> all_populations(int threads) {
  std::vector<WangPopulationRow> rows;
  for (const std::size_t count : {std::size_t{11}, std::size_t{12}}) {
    const auto add = [&](const char* words, WangAngleUnit unit, bool displacements) {
      const WangReading reading{.angles = unit, .composition = {}, .rows = count, .displacements = displacements};
      rows.push_back({fmt::format("{}^6, {}", count, words), reading, {}});
    };
    add("degrees as printed", WangAngleUnit::degrees, true);
    add("degrees as printed, angles only", WangAngleUnit::degrees, false);
    add("millidegrees", WangAngleUnit::millidegrees, true);
    add("millidegrees, angles only", WangAngleUnit::millidegrees, false);
    add("displacements only", WangAngleUnit::none, true);
  }
  Progress progress("evaluating all poses");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].population = wang_all_poses(rows[i].reading, threads);
    progress(i + 1, rows.size());
  }
  return rows;
}

nlohmann::ordered_json population_json(const WangPopulation& population) {
  nlohmann::ordered_json json = statistics_um(population.norm);
  json["poses"] = population.norm.count;
  json["mean_components_um"] = {1e3 * population.mean_components.x(), 1e3 * population.mean_components.y(),
                                1e3 * population.mean_components.z()};
  return json;
}

WangConclusions conclusions_of(const std::vector<WangPopulationRow>& populations) {
  // 11^6: degrees, degrees angles only, millidegrees, millidegrees angles only, displacements only.
  const auto mean = [&](std::size_t row) { return populations[row].population.norm.mean; };
  WangConclusions c;
  c.complete_degrees = mean(0);
  c.angles_degrees = mean(1);
  c.complete_millidegrees = mean(2);
  c.angles_millidegrees = mean(3);
  c.displacements = mean(4);
  c.largest_millidegrees = populations[2].population.norm.maximum;
  c.smallest_degrees = populations[0].population.norm.minimum;
  c.share_of_order_1_mm = populations[0].population.share_of_order_1_mm;
  c.sizes = wang_sizes();
  return c;
}

/// Against tests/golden/wang/forward_chain.csv, which has nine decimals.
bool zero_pose_agrees(const WangResults& r) {
  const Eigen::Vector3d degrees(-5.400842140, -5.349159759, 6.435605205),
      millidegrees(-0.004549911, -0.002405497, 0.009471109), displacements(0.001, 0.0027, 0.003);
  constexpr double kLimit = 1e-8;  // mm
  return (r.degrees.machine - degrees).norm() < kLimit && (r.millidegrees.machine - millidegrees).norm() < kLimit &&
         (r.displacements.machine - displacements).norm() < kLimit;
}

}  // namespace

WangResults wang_results(int threads) {
  const Machine machine = wang_machine();
  const auto error = [&](WangAngleUnit unit) {
    return wang_integrated_error(machine, wang_errors({.angles = unit, .composition = {}, .rows = 12}),
                                 wang_zero_pose());
  };
  WangResults r;
  r.degrees = error(WangAngleUnit::degrees);
  r.millidegrees = error(WangAngleUnit::millidegrees);
  r.displacements = error(WangAngleUnit::none);
  r.mean_column = check_mean_column();
  r.populations = all_populations(threads);
  r.points = wang_points();
  r.conclusions = conclusions_of(r.populations);
  r.dials = wang_dial_figures();
  r.grid = wang_grid_map(wang_errors({}));
  r.agrees = zero_pose_agrees(r);
  return r;
}

nlohmann::ordered_json wang_details(const WangResults& r) {
  nlohmann::ordered_json json;
  const auto list = [](const Eigen::Vector3d& v) { return nlohmann::ordered_json{v.x(), v.y(), v.z()}; };
  json["zero_pose_error_mm"] = {{"paper", list(WangPrinted().complete)},
                                {"degrees", list(r.degrees.machine)},
                                {"millidegrees", list(r.millidegrees.machine)},
                                {"displacements", list(r.displacements.machine)}};
  json["mean_columns"] = {{"rows", r.mean_column.rows}, {"equal_to_cut_off_mean", r.mean_column.equal}};
  json["machining_points"] = wang_points_json(r.points);
  json["conclusions"] = wang_conclusions_json(r.conclusions);
  json["dials"] = wang_dials_json(r.dials);
  json["ball_bar_circular_deviation_um"] = wang_ball_bar_json(r.dials.ball_bar);
  for (const WangPopulationRow& row : r.populations) json["populations_um"][row.name] = population_json(row.population);
  return json;
}

}  // namespace abbe
