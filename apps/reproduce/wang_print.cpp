#include "reproduce/wang_print.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "abbe/formats/indication_file.h"
#include "abbe/verify/statistics.h"
#include "reproduce/wang_ball_bar.h"
#include "reproduce/wang_study.h"
#include "reproduce/wang_tables.h"

namespace abbe {
namespace {

constexpr std::uint64_t kDialSeed = 2020;

struct BallBarModel {
  const char* name;
  WangReading reading;
};
std::array<BallBarModel, 4> ball_bar_models() {
  return {{{"displacements only", {.angles = WangAngleUnit::none, .composition = {}}},
           {"angles only, millidegrees",
            {.angles = WangAngleUnit::millidegrees, .composition = {}, .rows = 11, .displacements = false}},
           {"complete, millidegrees", {.angles = WangAngleUnit::millidegrees, .composition = {}}},
           {"complete, degrees as printed", {.angles = WangAngleUnit::degrees, .composition = {}}}}};
}

/// What a ball bar would read with the errors found by dials and laser.
struct DecoupledBallBar {
  std::vector<WangCircle> with_noise, without_noise;
  explicit DecoupledBallBar(const WangDialStudy& study)
      : with_noise(wang_ball_bar(study.with_noise.errors, &study.with_noise.covariance)),
        without_noise(wang_ball_bar(study.without_noise.errors)) {}
};

/// Largest standard uncertainty over the positions; um or urad.
double largest_uncertainty(const Decoupling& found, std::size_t component) {
  double largest = 0;
  for (std::size_t i = 0; i < found.positions.size(); ++i) {
    largest = std::max(largest, found.standard_uncertainty(static_cast<Component>(component), i));
  }
  return largest * (component < 3 ? 1e3 : 1e6);
}

std::string component_name(const WangDialAxis& axis, std::size_t component) {
  return fmt::format("E{}{}", component_letter(static_cast<Component>(component)), kWangAxisNames[axis.table]);
}

}  // namespace

WangDialFigures wang_dial_figures() {
  WangDialFigures figures;
  figures.study = wang_dial_study(kDialSeed);
  figures.map = wang_dial_map(figures.study);
  figures.grids = wang_grid_comparison();
  return figures;
}

void print_wang_dials(const WangDialFigures& figures) {
  fmt::print(
      "Decoupling of one dial over grids on two faces, without noise (dial zeros 50 and -20 um, faces set 30 and\n");
  fmt::print("-20 urad off; angles read as millidegrees): root mean square bias\n");
  fmt::print("  {:<6} {:>14} {:>14} {:>14}   {:>12} {:>12} {:>14}\n", "axis", "printed (5)", "printed (8)",
             "printed (11)", "correct", "correct", "correct roll");
  for (const WangGridComparison& grid : figures.grids) {
    fmt::print("  {:<6} {:>11.1f} um {:>11.1f} um {:>9.1f} urad   {:>9.3f} um {:>9.3f} um {:>9.3f} urad\n", grid.axis,
               1e3 * grid.printed_second, 1e3 * grid.printed_first, 1e6 * grid.printed_roll, 1e3 * grid.correct_second,
               1e3 * grid.correct_first, 1e6 * grid.correct_roll);
  }
  fmt::print("  (5) and (8) keep the dial's zero and setting; (6) and (9) have opposite signs, so (11) is no roll.\n");
  const WangGridComparison& x = figures.grids[0];
  fmt::print(
      "  (7), (10) give {:.1f} and {:.1f} urad for X: slopes of the setting. One dial cannot see pitch and yaw\n",
      1e6 * x.printed_pitch, 1e6 * x.printed_yaw);
  fmt::print("  (Table A1 has {:.1f} and {:.1f} urad, constant).\n", 1e6 * x.true_pitch, 1e6 * x.true_yaw);
  fmt::print(
      "  With the angles in degrees as printed the dial would have to travel {:.1f} mm across 120 mm of face.\n\n",
      x.dial_range_mm);

  const WangDialStudy& study = figures.study;
  fmt::print(
      "36 errors from simulated readings: seven dials on a carriage (u = 0.6 um) and a laser (u = 0.011 um) per\n");
  fmt::print(
      "linear axis, four dials on a mandrel and one probe on its end per rotary axis; datum in docs/dial-grids.md\n");
  fmt::print("  {:<6} {:<28} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "axis", "", "EX / um", "EY / um", "EZ / um",
             "EA / urad", "EB / urad", "EC / urad");
  for (const WangDialAxis& axis : study.axes) {
    std::string uncertainty, bias;
    for (std::size_t c = 0; c < 6; ++c) {
      if (!axis.with_noise.seen[c]) {
        uncertainty += fmt::format(" {:>9}", "not seen");
        bias += fmt::format(" {:>9}", "");
        continue;
      }
      const Eigen::Index column = static_cast<Eigen::Index>(c);
      const double off = (axis.without_noise.errors.col(column) - axis.truth.col(column)).cwiseAbs().maxCoeff();
      uncertainty += fmt::format(" {:>9.3f}", largest_uncertainty(axis.with_noise, c));
      bias += fmt::format(" {:>9.4f}", off * (c < 3 ? 1e3 : 1e6));
    }
    fmt::print("  {:<6} {:<28}{}\n", kWangAxisNames[axis.table], "largest standard uncertainty", uncertainty);
    fmt::print("  {:<6} {:<28}{}\n", "", "bias without noise", bias);
  }
  fmt::print(
      "  The paper's instruments see {} of 36; EAA, EBB and ECC take an angle standard (added, U95 = 1 arcsec).\n",
      study.seen_by_dials);
  fmt::print("  {} of {} error values ({:.1f} %) lie within k = 2 of those without noise.\n", study.inside,
             study.values, 100.0 * static_cast<double>(study.inside) / static_cast<double>(study.values));
  const WangDialMap& map = figures.map;
  fmt::print(
      "  |E| of equation (18) over {} poses: mean {:.2f}, largest {:.2f} um; its standard uncertainty mean {:.2f},\n",
      map.poses, 1e3 * map.norm.mean, 1e3 * map.norm.maximum, 1e3 * map.uncertainty.mean);
  fmt::print("  largest {:.2f} um; {:.1f} % of the components within k = 2 of those without noise.\n",
             1e3 * map.uncertainty.maximum, 100 * map.inside);
  fmt::print(
      "  Zero pose: E = ({:.2f}, {:.2f}, {:.2f}) um, u = ({:.2f}, {:.2f}, {:.2f}) um, location errors left out.\n\n",
      1e3 * map.zero_pose.x(), 1e3 * map.zero_pose.y(), 1e3 * map.zero_pose.z(), 1e3 * map.zero_pose_uncertainty.x(),
      1e3 * map.zero_pose_uncertainty.y(), 1e3 * map.zero_pose_uncertainty.z());
}

void print_wang_ball_bar(const WangDialStudy& study, double displacements_only_mm) {
  fmt::print(
      "Ball bar of 100 mm in three planes, simulated: circular deviation G / um (ISO 230-4, least-squares centre)\n");
  fmt::print("  {:<32} {:>10} {:>10} {:>10}\n", "", "XY", "YZ", "ZX");
  double largest_displacement = 0;
  for (const BallBarModel& model : ball_bar_models()) {
    std::string row;
    for (const WangCircle& circle : wang_ball_bar(wang_errors(model.reading))) {
      row += circle.converged ? fmt::format(" {:>10.2f}", 1e3 * circle.circular) : fmt::format(" {:>10}", "no circle");
      if (model.reading.angles == WangAngleUnit::none) {
        largest_displacement = std::max(largest_displacement, circle.circular);
      }
    }
    fmt::print("  {:<32}{}\n", model.name, row);
  }
  const DecoupledBallBar bar(study);
  std::string found, uncertainty, mean, largest, share;
  for (std::size_t i = 0; i < bar.with_noise.size(); ++i) {
    const WangCircle& circle = bar.with_noise[i];
    found += circle.converged ? fmt::format(" {:>10.2f}", 1e3 * circle.circular) : fmt::format(" {:>10}", "no circle");
    uncertainty += fmt::format(" {:>10.2f}", 2e3 * circle.circular_uncertainty);
    const SampleStatistics band = sample_statistics(circle.uncertainty);
    mean += fmt::format(" {:>10.2f}", 2e3 * band.mean);
    largest += fmt::format(" {:>10.2f}", 2e3 * band.maximum);
    share += fmt::format(" {:>8.1f} %", 100 * wang_share_within(circle, bar.without_noise[i]));
  }
  fmt::print("  from the 36 decoupled errors (0.022 and 1.2 um of the readings propagated; no location errors)\n");
  fmt::print("  {:<32}{}\n", "  G", found);
  fmt::print("  {:<32}{}\n", "  U(G), k = 2", uncertainty);
  fmt::print("  {:<32}{}\n", "  U of the deviation, mean", mean);
  fmt::print("  {:<32}{}\n", "  U of the deviation, largest", largest);
  fmt::print("  {:<32}{}\n", "  within U of no noise", share);
  fmt::print(
      "  Figure 15 claims that the ball bar and the displacement errors alone agree at 0.1 mm. Displacements alone\n");
  fmt::print(
      "  give |E| = {:.2f} um at the zero pose, {:.1f} times less, and at most {:.1f} um on these circles, {:.1f} "
      "times less.\n\n",
      1e3 * displacements_only_mm, 0.1 / displacements_only_mm, 1e3 * largest_displacement, 0.1 / largest_displacement);
}

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
  for (const WangDialAxis& axis : figures.study.axes) {
    nlohmann::ordered_json uncertainty;
    for (std::size_t c = 0; c < 6; ++c) {
      if (!axis.with_noise.seen[c]) continue;
      uncertainty[component_name(axis, c) + (c < 3 ? "_um" : "_urad")] = largest_uncertainty(axis.with_noise, c);
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

nlohmann::ordered_json wang_ball_bar_json(const WangDialStudy& study) {
  nlohmann::ordered_json json;
  for (const BallBarModel& model : ball_bar_models()) {
    for (const WangCircle& circle : wang_ball_bar(wang_errors(model.reading))) {
      if (circle.converged) json[model.name][circle.plane] = 1e3 * circle.circular;
    }
  }
  const DecoupledBallBar bar(study);
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

std::vector<std::pair<std::string, std::string>> wang_ball_bar_files(const WangDialStudy& study) {
  const DecoupledBallBar bar(study);
  std::vector<std::pair<std::string, std::string>> files;
  for (std::size_t i = 0; i < bar.with_noise.size(); ++i) {
    const WangCircle &circle = bar.with_noise[i], &exact = bar.without_noise[i];
    files.emplace_back(circle.plane + ".csv", wang_circle_csv(circle, exact));
    files.emplace_back(circle.plane + ".svg", wang_circle_svg(circle, exact));
  }
  return files;
}

std::vector<std::pair<std::string, std::string>> wang_indication_files(const WangDialStudy& study) {
  const Machine machine = wang_machine();
  std::vector<std::pair<std::string, std::string>> files;
  for (const WangDialAxis& axis : study.axes) {
    const IndicationTable table{machine.find_axis(kWangAxisNames[axis.table]), axis.readings};
    files.emplace_back(std::string(kWangAxisNames[axis.table]) + ".csv", indications_text(machine, table));
  }
  return files;
}

}  // namespace abbe
