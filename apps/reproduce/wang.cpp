#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/errors/actual_pose.h"
#include "abbe/formats/errors_file.h"
#include "abbe/formats/json_text.h"
#include "abbe/formats/machine_file.h"
#include "abbe/formats/map_file.h"
#include "abbe/formats/results_folder.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/report/report.h"
#include "abbe/verify/error_map.h"
#include "exit_code.h"
#include "progress.h"
#include "reproduce/reproduce.h"
#include "reproduce/wang_grids.h"
#include "reproduce/wang_print.h"
#include "reproduce/wang_study.h"
#include "reproduce/wang_tables.h"
#include "study/report_data.h"
#include "study/results.h"
#include "study/summary.h"

namespace abbe {
namespace {

struct Order {
  const char* name;
  Composition composition;
};
constexpr Order kOrders[] = {
    {"iso: linear T E, rotary E T", {ErrorOrder::iso, false}},
    {"T E for every axis", {ErrorOrder::after_motion, false}},
    {"E T for every axis", {ErrorOrder::before_motion, false}},
    {"T E, first order", {ErrorOrder::after_motion, true}},
};

/// The paper's zero pose: first column of every table, B at 0 degrees (its seventh).
std::vector<double> zero_pose() { return wang_positions({0, 0, 0, 0, 6, 0}); }

std::string scaled_triple(const Eigen::Vector3d& v, const char* unit, double scale, int digits) {
  return fmt::format("({:.{}f}, {:.{}f}, {:.{}f}) {}", v.x() * scale, digits, v.y() * scale, digits, v.z() * scale,
                     digits, unit);
}

/// How many of the tables' columns 12 are the cut-off mean of columns 1 to 11.
struct MeanColumn {
  int rows = 0, equal = 0;
};

MeanColumn check_mean_column() {
  MeanColumn result;
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

/// Inverse kinematics (34): X, Y, Z of the machine that bring the tool to a machining point, given the angles.
Eigen::Vector3d linear_axes_for(const Eigen::Vector3d& point, double alpha, double beta, double gamma,
                                const Eigen::Vector3d& t, const Eigen::Vector3d& w) {
  const double along = t.x() * std::cos(beta) + t.z() * std::sin(beta);
  const double across = t.z() * std::cos(beta) - t.x() * std::sin(beta);
  const Eigen::Vector3d work(w.x() * std::cos(gamma) - w.y() * std::sin(gamma),
                             w.x() * std::sin(gamma) + w.y() * std::cos(gamma), w.z());
  const Eigen::Vector3d target = point + work;
  // Chain X Z A Y B t: y lies behind A, so it is found from the y coordinate with A's rotation undone.
  const double y = (target.y() + std::sin(alpha) * across) / std::cos(alpha) - t.y();
  const double z = target.z() - (y + t.y()) * std::sin(alpha) - std::cos(alpha) * across;
  return {target.x() - along, y, z};
}

nlohmann::ordered_json population_json(const WangPopulation& population) {
  nlohmann::ordered_json json = statistics_um(population.norm);
  json["poses"] = population.norm.count;
  json["mean_components_um"] = {1e3 * population.mean_components.x(), 1e3 * population.mean_components.y(),
                                1e3 * population.mean_components.z()};
  return json;
}

struct PopulationRow {
  std::string name;
  WangReading reading;
  WangPopulation population;
};

std::vector<PopulationRow> all_populations(int threads) {
  std::vector<PopulationRow> rows;
  Progress progress("evaluating all poses");
  for (std::size_t count : {std::size_t{11}, std::size_t{12}}) {
    for (WangAngleUnit unit : {WangAngleUnit::degrees, WangAngleUnit::millidegrees}) {
      const std::string label =
          fmt::format("{}^6, {}", count, unit == WangAngleUnit::degrees ? "degrees as printed" : "millidegrees");
      WangReading reading{.angles = unit, .composition = {}, .rows = count, .displacements = true};
      rows.push_back({label, reading, wang_all_poses(reading, threads)});
      progress(rows.size(), 8);
      WangReading angles = reading;
      angles.displacements = false;
      rows.push_back({label + ", angles only", angles, wang_all_poses(angles, threads)});
      progress(rows.size(), 8);
    }
    WangReading displacements{.angles = WangAngleUnit::none, .composition = {}, .rows = count, .displacements = true};
    rows.push_back(
        {fmt::format("{}^6, displacements only", count), displacements, wang_all_poses(displacements, threads)});
  }
  return rows;
}

/// Map, tables, machine, errors and page.
void write_folder(const std::filesystem::path& output, const std::vector<PopulationRow>& populations,
                  const WangDialFigures& dials, int threads) {
  const Machine machine = wang_machine();
  const ErrorSet errors = wang_errors({});
  const ErrorSet small = wang_errors({.angles = WangAngleUnit::millidegrees, .composition = {}});
  PoseGrid grid;
  std::vector<std::size_t> counts;
  for (const Axis& axis : machine.axes) {
    // Up to the last measured position, not the printed mean.
    const double last = axis.travel_min + (axis.travel_max - axis.travel_min) * 10 / 11;
    grid.values.push_back(evenly_spaced(axis.travel_min, last, 4));
    counts.push_back(4);
  }
  const PoseSource source = pose_source(grid);
  PoseList poses;
  poses.axis.assign(6, std::vector<double>(source.count));
  std::vector<double*> pointers;
  for (std::vector<double>& values : poses.axis) pointers.push_back(values.data());
  source.fill(0, source.count, pointers.data());
  ErrorMapOptions options;
  options.threads = threads;
  const ErrorMap map = error_map(machine, errors, nullptr, pose_source(poses), options);
  const ErrorMap map_small = error_map(machine, small, nullptr, pose_source(poses), options);

  nlohmann::ordered_json summary;
  summary["format"] = "abbe-summary/1";
  summary["study"] = "Wang et al. (2020)";
  summary["machine"] = machine.name;
  summary["chain"] = machine.chain();
  summary["verdict"] = fmt::format(
      "Integrated error of the measured grinder over {} poses: mean {:.3f} mm, largest {:.3f} mm with the angles in "
      "degrees as printed; "
      "mean {:.1f} um, largest {:.1f} um if they are millidegrees.",
      populations[0].population.norm.count, populations[0].population.norm.mean, populations[0].population.norm.maximum,
      1e3 * populations[2].population.norm.mean, 1e3 * populations[2].population.norm.maximum);
  summary["map"] = {{"poses", map.count()},
                    {"description", "grid of 4 positions per axis, angles in degrees as printed"},
                    {"reference", "model"},
                    {"position_before_um", statistics_um(map.statistics)}};

  nlohmann::ordered_json data;
  data["format"] = "abbe-report/1";
  data["title"] = "Integrated error of a gear grinder (Wang et al. 2020, Tables A1 to A6)";
  data["generator"] = "abbe " ABBE_VERSION;
  data["machine"] = report_machine(machine);
  data["summary"] = summary;
  data["map"] =
      report_map(machine, poses, map, nullptr, nullptr, "grid of 4 positions per axis, angles in degrees as printed");
  nlohmann::ordered_json histograms = nlohmann::ordered_json::array();
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const PopulationRow& row : populations) {
    const WangPopulation& p = row.population;
    rows.push_back({row.name, p.norm.count, 1e3 * p.norm.mean, 1e3 * p.norm.p95, 1e3 * p.norm.maximum});
    if (!row.reading.displacements || row.reading.angles == WangAngleUnit::none) continue;
    std::vector<double> edges;
    for (std::size_t i = 0; i <= p.histogram.counts.size(); ++i) {
      edges.push_back(for_drawing(1e3 * (p.histogram.from + p.histogram.width * static_cast<double>(i))));
    }
    histograms.push_back({{"title", "Integrated error, " + row.name},
                          {"edges_um", edges},
                          {"before_counts", p.histogram.counts},
                          {"before_percentiles_um", {{"median", 1e3 * p.norm.median}, {"p95", 1e3 * p.norm.p95}}}});
  }
  data["histograms"] = histograms;
  data["tables"] = {
      {{"title", "Integrated error over all poses / um"},
       {"columns", {"", "poses", "mean", "95 %", "largest"}},
       {"rows", rows},
       {"note", "Share of angle and displacement errors: compare the rows with angles only and displacements only."}}};
  data["assumptions"] = {
      "Order of errors against the motion: iso (the paper leaves it open; the zero pose does not depend on it).",
      "Tables A1 to A6 as printed; the 12th column is the cut-off mean of the others, not a measurement.",
      "Angles in degrees as printed; probably a factor 1000 too large (inferred, not proven)."};
  data["references"] = {"Wang, Ran, Zhang and Li (2020), Applied Sciences 10, 2164"};

  ResultsFolder folder(output);
  folder.write("machine.machine.toml", machine_text(machine));
  folder.write(
      "errors.toml",
      errors_text(machine, {errors, {}, {{"source", "Wang et al. (2020), Tables A1 to A6, degrees as printed"}}}));
  folder.write(
      "errors_millidegrees.toml",
      errors_text(machine,
                  {small, {}, {{"source", "Wang et al. (2020), Tables A1 to A6, angles read as millidegrees"}}}));
  const MapData map_file = map_data(machine, poses, counts, map, nullptr, nullptr);
  const MapData small_file = map_data(machine, poses, counts, map_small, nullptr, nullptr);
  folder.write("maps/integrated_error_degrees.csv", map_csv(map_file));
  folder.write("maps/integrated_error_degrees.vtu", map_vtk(map_file));
  folder.write("maps/integrated_error_millidegrees.csv", map_csv(small_file));
  const DecoupledErrors& decoupled = dials.study.with_noise;
  const ErrorsFile contents{decoupled.errors, decoupled.covariance, {{"source", "simulated dial and laser readings"}}};
  folder.write("decoupled.errors.toml", errors_text(machine, contents, "decoupled.covariance.csv"));
  folder.write("decoupled.covariance.csv", covariance_text(machine, contents));
  for (const auto& [name, text] : wang_indication_files(dials.study)) folder.write("grids/" + name, text);
  for (const auto& [name, text] : wang_ball_bar_files(dials.study)) folder.write("ball_bar/" + name, text);
  ParameterCovariance covariance;
  covariance.covariance = decoupled.covariance;
  for (std::size_t p = 0; p < decoupled.errors.parameter_count(); ++p) covariance.parameters.push_back(p);
  options.covariance = &covariance;
  const ErrorMap map_decoupled = error_map(machine, decoupled.errors, nullptr, pose_source(poses), options);
  folder.write("maps/decoupled_errors.csv",
               map_csv(map_data(machine, poses, counts, map_decoupled, nullptr, &map_decoupled)));
  folder.write("summary.json", json_text(summary));
  folder.write("report.html", report_page(nlohmann::json(data)));
  folder.commit();
}

}  // namespace

int reproduce_wang(const ReproduceOptions& options) {
  if (!options.grids.empty()) return decouple_wang_grids(options);
  const Machine machine = wang_machine();
  const std::vector<double> zero = zero_pose();
  const auto error = [&](WangAngleUnit unit, const Composition& composition) {
    return wang_integrated_error(machine, wang_errors({.angles = unit, .composition = composition, .rows = 12}), zero);
  };
  const WangError complete = error(WangAngleUnit::degrees, {});
  const WangError small = error(WangAngleUnit::millidegrees, {});
  const WangError displacement = error(WangAngleUnit::none, {});
  const std::vector<PopulationRow> populations = all_populations(options.threads);
  const MeanColumn mean_column = check_mean_column();
  const WangDialFigures dials = wang_dial_figures(options.threads);

  if (!options.output.empty()) write_folder(options.output, populations, dials, options.threads);

  if (options.json) {
    nlohmann::ordered_json json;
    const auto list = [](const Eigen::Vector3d& v) { return nlohmann::ordered_json{v.x(), v.y(), v.z()}; };
    json["zero_pose_error_mm"] = {{"paper", {0.52234, -3.60976, -4.5264}},
                                  {"degrees", list(complete.machine)},
                                  {"millidegrees", list(small.machine)},
                                  {"displacements", list(displacement.machine)}};
    json["mean_columns"] = {{"rows", mean_column.rows}, {"equal_to_cut_off_mean", mean_column.equal}};
    json["dials"] = wang_dials_json(dials);
    json["ball_bar_circular_deviation_um"] = wang_ball_bar_json(dials.study);
    for (const PopulationRow& row : populations) json["populations_um"][row.name] = population_json(row.population);
    fmt::print("{}", json_text(json));
    return kDone;
  }

  fmt::print("Wang, Ran, Zhang, Li (2020), Applied Sciences 10, 2164\n");
  fmt::print("grinder {}, tool at (200, 0, 0), workpiece point (0, 0, 400) mm\n\n", machine.chain());
  fmt::print("Zero pose (X = Y = Z = 0, A = B = C = 0): E = (W_actual - T_actual) - (W_nominal - T_nominal)\n");
  fmt::print("  {:<44} {}\n", "paper, equation (44)", scaled_triple({0.52234, -3.60976, -4.5264}, "mm", 1, 5));
  for (const Order& order : kOrders) {
    fmt::print("  {:<44} {}\n", order.name,
               scaled_triple(error(WangAngleUnit::degrees, order.composition).machine, "mm", 1, 6));
  }
  fmt::print("  {:<44} {}\n", "angles read as millidegrees", scaled_triple(small.machine, "um", 1e3, 3));
  fmt::print("  {:<44} {}\n", "paper, equation (45), displacements only",
             scaled_triple({0.001, 0.0027, -0.0002}, "mm", 1, 4));
  fmt::print("  {:<44} {}\n", "displacements only", scaled_triple(displacement.machine, "mm", 1, 4));
  fmt::print("  T_actual: paper (42) (193.93746, 1.72736, -4.4856), here {}\n",
             scaled_triple(complete.tool_actual, "mm", 1, 5));
  fmt::print("  W_actual: paper (43) (-5.5402, -1.8824, 399.9592), here {}\n\n",
             scaled_triple(complete.workpiece_actual, "mm", 1, 5));

  fmt::print("Why the paper's figures differ\n");
  fmt::print(
      "  (36)-(39) mix displacements of i = 1 with angles of column 12; (40), (41), (43) have wrong signs or "
      "digits;\n");
  fmt::print("  (42) prints T_X T_Z only, and 193.93746 is a slip for 199.93746; (44) adds up wrongly.\n");
  fmt::print(
      "  (45): z must be +0.0030 mm; |E| is then {:.1f} um, so the agreement with the ball bar claimed at 0.1 mm\n",
      1e3 * displacement.machine.norm());
  fmt::print("  fails by a factor of {:.0f}.\n", 0.1 / displacement.machine.norm());
  fmt::print(
      "  Column 12 of Tables A1 to A6 is the cut-off mean of columns 1 to 11 in {} of {} rows that vary: no "
      "measurement.\n",
      mean_column.equal, mean_column.rows);
  fmt::print("  Strokes of A and B are swapped against Tables A4 and A5.\n\n");

  fmt::print("Integrated error over all combinations of the measured positions\n");
  fmt::print("  {:<44} {:>10} {:>11} {:>11} {:>11}\n", "", "poses", "mean / um", "95 % / um", "max / um");
  for (const PopulationRow& row : populations) {
    const SampleStatistics& s = row.population.norm;
    fmt::print("  {:<44} {:>10} {:>11.2f} {:>11.2f} {:>11.2f}\n", row.name, s.count, 1e3 * s.mean, 1e3 * s.p95,
               1e3 * s.maximum);
  }
  const double angles = populations[1].population.norm.mean, displacements = populations[4].population.norm.mean;
  fmt::print(
      "  Angle errors alone are {:.0f} times the displacement errors alone (degrees as printed), {:.2f} times "
      "(millidegrees).\n",
      angles / displacements, populations[3].population.norm.mean / displacements);
  fmt::print("  The paper speaks of 'near 3 million (12^6)' points and shows 36 of them.\n\n");

  print_wang_ball_bar(dials.study, displacement.machine.norm());
  print_wang_dials(dials);

  // A pose away from zero shows what (33) and (35) leave out.
  const double alpha = 20 * kDegree, beta = 25 * kDegree, gamma = 40 * kDegree;
  const Eigen::Vector3d t(200, 0, 0), w = wang_workpiece_point();
  const Eigen::Vector3d wanted(120, 30, -250);
  const Eigen::Vector3d linear = linear_axes_for(wanted, alpha, beta, gamma, t, w);
  const std::vector<double> pose = {gamma, linear.x(), linear.z(), alpha, linear.y(), beta};
  const Eigen::Vector3d reached =
      nominal_bed_from_tool(machine, pose).translation - nominal_bed_from_workpiece(machine, pose) * w;
  const Eigen::Vector3d printed(wanted.x() - 200 * std::cos(beta) + 200 * std::cos(gamma), wanted.y(),
                                wanted.z() + 200 * std::sin(beta) + 400);
  const std::vector<double> printed_pose = {gamma, printed.x(), printed.z(), alpha, printed.y(), beta};
  const Eigen::Vector3d printed_reached =
      nominal_bed_from_tool(machine, printed_pose).translation - nominal_bed_from_workpiece(machine, printed_pose) * w;
  fmt::print("Inverse kinematics for machining point {} with A = 20, B = 25, C = 40 deg\n",
             scaled_triple(wanted, "mm", 1, 1));
  fmt::print("  corrected (34): X, Y, Z = {}, misses by {:.1e} mm\n", scaled_triple(linear, "mm", 1, 6),
             (reached - wanted).norm());
  fmt::print("  printed (35):   X, Y, Z = {}, misses by {:.3f} mm\n", scaled_triple(printed, "mm", 1, 6),
             (printed_reached - wanted).norm());
  fmt::print(
      "  (32) does not follow from the chain X Z A Y B; the term -200 cos(gamma) in (33) and (35) is spurious.\n");
  if (!options.output.empty()) {
    fmt::print("\nresults in {}\nreport:    {}\n", options.output.string(), (options.output / "report.html").string());
  }
  return kDone;
}

}  // namespace abbe
