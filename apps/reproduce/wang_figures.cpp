#include "reproduce/wang_figures.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "abbe/geometry/angle_units.h"
#include "abbe/report/svg_plot.h"
#include "reproduce/wang_tables.h"

namespace abbe {
namespace {

constexpr std::size_t kFigurePoints = 36;
// Row of the zero position in every table: X Y Z A B C.
constexpr std::size_t kZeroRow[] = {0, 0, 0, 0, 6, 0};

std::vector<std::size_t> zero_rows() { return {std::begin(kZeroRow), std::end(kZeroRow)}; }

PoseList circle_poses() {
  constexpr double kFigureRadius = 100;  // mm, that of the ball bar
  PoseList poses;
  for (std::size_t i = 0; i < kFigurePoints; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kFigurePoints;
    std::vector<double> pose = wang_positions(zero_rows());  // chain order C X Z A Y B
    pose[1] = 200 + kFigureRadius * std::cos(angle);
    pose[4] = 100 + kFigureRadius * std::sin(angle);
    poses.append(pose);
  }
  return poses;
}

PoseList line_poses() {
  PoseList poses;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < 12; ++i) {
      std::vector<std::size_t> rows = zero_rows();
      rows[axis] = i;
      poses.append(wang_positions(rows));
    }
  }
  return poses;
}

PoseList square_poses() {
  PoseList poses;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < 6; ++k) {
      std::vector<std::size_t> rows = zero_rows();
      rows[0] = 2 * i;
      rows[1] = 2 * k;
      poses.append(wang_positions(rows));
    }
  }
  return poses;
}

WangPoints points_at(std::string name, std::string words, const PoseList& poses) {
  const auto map = [&](WangAngleUnit unit) {
    // 12 rows: the lines end at the printed 12th position.
    return wang_map(wang_errors({.angles = unit, .composition = {}, .rows = 12}), poses);
  };
  return {std::move(name), std::move(words), map(WangAngleUnit::degrees), map(WangAngleUnit::millidegrees),
          map(WangAngleUnit::none)};
}

double mean_at_size(double factor, WangAngleUnit unit) {
  Machine machine = wang_machine();
  machine.tool_offset *= factor;
  const WangIntegratedPlan plan(machine, wang_errors({.angles = unit, .composition = {}}),
                                factor * wang_workpiece_point());
  const WangMap at = wang_grid_map(ErrorSet{});
  std::vector<const double*> axis;
  for (const std::vector<double>& values : at.poses.axis) axis.push_back(values.data());
  std::array<std::vector<double>, 3> e;
  e.fill(std::vector<double>(at.poses.count()));
  plan.evaluate({axis, at.poses.count()}, {e[0].data(), e[1].data(), e[2].data()});
  double sum = 0;
  for (std::size_t k = 0; k < at.poses.count(); ++k) sum += Eigen::Vector3d(e[0][k], e[1][k], e[2][k]).norm();
  return sum / static_cast<double>(at.poses.count());
}

nlohmann::ordered_json size_json(const SampleStatistics& s) {
  return {{"mean_um", 1e3 * s.mean}, {"smallest_um", 1e3 * s.minimum}, {"largest_um", 1e3 * s.maximum}};
}

/// To a nanometre, and no minus zero.
double to_a_nanometre(double mm) { return std::round(1e6 * mm) / 1e6 + 0.0; }

std::vector<PlotPoint> numbered(const std::vector<double>& norm) {
  std::vector<PlotPoint> points;
  for (std::size_t i = 0; i < norm.size(); ++i) points.push_back({static_cast<double>(i + 1), 1e3 * norm[i]});
  return points;
}

}  // namespace

std::vector<WangPoints> wang_points() {
  return {
      points_at("circle", "circle of radius 100 mm in XY, steps of 10 degrees, as in a ball bar test", circle_poses()),
      points_at("lines", "12 printed positions of X, of Y and of Z, the other axes at zero", line_poses()),
      points_at("square", "6 x 6 positions of X and Y (i = 1, 3, ..., 11), the other axes at zero", square_poses())};
}

std::vector<WangSize> wang_sizes() {
  std::vector<WangSize> sizes;
  for (const double factor : {0.5, 1.0, 2.0}) {
    sizes.push_back({factor, mean_at_size(factor, WangAngleUnit::degrees),
                     mean_at_size(factor, WangAngleUnit::millidegrees), mean_at_size(factor, WangAngleUnit::none)});
  }
  return sizes;
}

std::vector<std::array<std::string, 4>> wang_conclusion_rows(const WangConclusions& c) {
  const WangSize &half = c.sizes.at(0), &twice = c.sizes.at(2);
  return {
      {"(1) complete error", "of the order of 1 mm",
       fmt::format("mean {:.0f} um, least {:.0f} um of all poses (degrees); mean {:.1f} um (millidegrees)",
                   1e3 * c.complete_degrees, 1e3 * c.smallest_degrees, 1e3 * c.complete_millidegrees),
       fmt::format("no: {:.2g} % of the poses are below 3.2 mm in degrees, none reaches 0.1 mm in millidegrees",
                   100 * c.share_of_order_1_mm)},
      {"(1) complete / displacements only", "about 10",
       fmt::format("{:.0f} (degrees), {:.2f} (millidegrees)", c.complete_degrees / c.displacements,
                   c.complete_millidegrees / c.displacements),
       "no, in neither unit"},
      {"(2) angles against displacements", "angles count more",
       fmt::format("angles only / displacements only: {:.0f} (degrees), {:.2f} (millidegrees)",
                   c.angles_degrees / c.displacements, c.angles_millidegrees / c.displacements),
       c.angles_millidegrees > c.displacements ? "yes, in both units" : "only with the angles in degrees as printed"},
      {"(3) larger structure, larger error", "yes",
       fmt::format("points twice and half as far from their axes: {:.0f} and {:.0f} um (degrees), {:.1f} and {:.1f} um "
                   "(millidegrees), {:.1f} and {:.1f} um (displacements only)",
                   1e3 * twice.degrees, 1e3 * half.degrees, 1e3 * twice.millidegrees, 1e3 * half.millidegrees,
                   1e3 * twice.no_angles, 1e3 * half.no_angles),
       "for what the angles do; displacement errors do not depend on size"}};
}

nlohmann::ordered_json wang_points_json(const std::vector<WangPoints>& points) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const WangPoints& set : points) {
    json.push_back({{"name", set.name},
                    {"points", set.words},
                    {"count", set.degrees.norm.size()},
                    {"degrees", size_json(set.degrees.statistics)},
                    {"millidegrees", size_json(set.millidegrees.statistics)},
                    {"displacements_only", size_json(set.no_angles.statistics)}});
  }
  return json;
}

nlohmann::ordered_json wang_conclusions_json(const WangConclusions& c) {
  nlohmann::ordered_json json = {{"mean_complete_degrees_um", 1e3 * c.complete_degrees},
                                 {"mean_complete_millidegrees_um", 1e3 * c.complete_millidegrees},
                                 {"mean_angles_only_degrees_um", 1e3 * c.angles_degrees},
                                 {"mean_angles_only_millidegrees_um", 1e3 * c.angles_millidegrees},
                                 {"mean_displacements_only_um", 1e3 * c.displacements},
                                 {"smallest_degrees_um", 1e3 * c.smallest_degrees},
                                 {"share_of_order_1_mm_degrees", c.share_of_order_1_mm}};
  for (const WangSize& size : c.sizes) {
    json["size"].push_back({{"factor", size.factor},
                            {"mean_degrees_um", 1e3 * size.degrees},
                            {"mean_millidegrees_um", 1e3 * size.millidegrees},
                            {"mean_displacements_only_um", 1e3 * size.no_angles}});
  }
  for (const auto& row : wang_conclusion_rows(c)) {
    json["claims"].push_back({{"claim", row[0]}, {"paper", row[1]}, {"here", row[2]}, {"holds", row[3]}});
  }
  return json;
}

void print_wang_points(const std::vector<WangPoints>& points) {
  fmt::print(
      "Figures 13 and 14: |E| at 36 machining points / um. The paper shows the points in a picture without "
      "coordinates;\nthree readings of it\n");
  fmt::print("  {:<22} {:>10} {:>10} {:>10}\n", "", "smallest", "mean", "largest");
  const auto row = [](const char* words, const SampleStatistics& s) {
    fmt::print("  {:<22} {:>10.1f} {:>10.1f} {:>10.1f}\n", words, 1e3 * s.minimum, 1e3 * s.mean, 1e3 * s.maximum);
  };
  fmt::print("  {:<22} {:>10} {:>10} {:>10}\n", "paper, Figure 14", "", "1000", "");
  fmt::print("  {:<22} {:>10} {:>10} {:>10}   (displacements only)\n", "paper, Figure 15", "", "100", "");
  for (const WangPoints& set : points) {
    fmt::print("  {}\n", set.words);
    row("  degrees as printed", set.degrees.statistics);
    row("  millidegrees", set.millidegrees.statistics);
    row("  displacements only", set.no_angles.statistics);
  }
  fmt::print("\n");
}

void print_wang_conclusions(const WangConclusions& c) {
  fmt::print("Conclusions, |E| over all poses of the 11 measured positions per axis\n");
  for (const auto& row : wang_conclusion_rows(c)) {
    fmt::print("  {}\n    paper: {}\n    here:  {}\n    holds: {}\n", row[0], row[1], row[2], row[3]);
  }
  fmt::print("\n");
}

std::vector<std::pair<std::string, std::string>> wang_point_files(const std::vector<WangPoints>& points) {
  std::string csv =
      "# Figures 13 and 14 of Wang et al. (2020): 36 machining points in three readings, and E of equation (18) at "
      "them, machine frame\n"
      "points,number,X_mm,Y_mm,Z_mm,A_deg,B_deg,C_deg,x_mm,y_mm,z_mm";
  for (const char* unit : {"degrees", "millidegrees", "displacements"}) {
    for (const char axis : {'x', 'y', 'z'}) csv += fmt::format(",E_{}_{}_um", axis, unit);
  }
  csv += "\n";
  XyPlot places("Machining points (Figure 13), top view", "x in mm", "y in mm"),
      degrees("Integrated error of the machining points (Figure 14), angles in degrees as printed", "point",
              "|E| in \xC2\xB5m"),
      small("Integrated error of the machining points, angles in millidegrees and left out", "point",
            "|E| in \xC2\xB5m");
  places.keep_the_same_scale();
  degrees.include_y(0);
  small.include_y(0);
  constexpr PlotColour kColours[] = {PlotColour::first, PlotColour::second, PlotColour::ink};
  constexpr Marker kMarkers[] = {Marker::circle, Marker::cross, Marker::circle};
  for (std::size_t s = 0; s < points.size(); ++s) {
    const WangPoints& set = points[s];
    std::vector<PlotPoint> top;
    for (std::size_t i = 0; i < set.degrees.norm.size(); ++i) {
      const std::vector<double> pose = set.degrees.poses.pose(i);  // C X Z A Y B
      const auto& p = set.degrees.machining_point;
      csv += fmt::format("{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6f},{:.6f},{:.6f}", set.name, i + 1,
                         pose[1], pose[4], pose[2], pose[3] / kDegree, pose[5] / kDegree, pose[0] / kDegree,
                         to_a_nanometre(p[0][i]), to_a_nanometre(p[1][i]), to_a_nanometre(p[2][i]));
      for (const WangMap* map : {&set.degrees, &set.millidegrees, &set.no_angles}) {
        for (std::size_t d = 0; d < 3; ++d) csv += fmt::format(",{:.6f}", 1e3 * map->error[d][i]);
      }
      csv += "\n";
      top.push_back({p[0][i], p[1][i]});
    }
    places.points(top, kMarkers[s], {kColours[s], 1.4}, set.name);
    degrees.line(numbered(set.degrees.norm), {kColours[s], 1.4}, set.name);
    small.line(numbered(set.millidegrees.norm), {kColours[s], 1.4}, set.name);
    small.points(numbered(set.no_angles.norm), kMarkers[s], {kColours[s], 1.4}, set.name + ", without angles");
  }
  degrees.level(1000, "1 mm, the paper's level", {PlotColour::limit, 1, true, 1});
  return {{"machining_points.csv", csv},
          {"figure_13.svg", places.svg()},
          {"figure_14_degrees.svg", degrees.svg()},
          {"figure_14_millidegrees.svg", small.svg()}};
}

}  // namespace abbe
