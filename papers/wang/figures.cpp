#include "wang/figures.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "abbe/geometry/angle_units.h"
#include "abbe/report/drawings/svg_plot.h"
#include "wang/tables.h"

namespace abbe {
namespace {

constexpr std::size_t kFigurePoints = 36;

PoseList circle_poses() {
  constexpr double kFigureRadius = 100;  // mm, that of the ball bar
  PoseList poses;
  for (std::size_t i = 0; i < kFigurePoints; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kFigurePoints;
    std::vector<double> pose = wang_zero_pose();  // chain order C X Z A Y B
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
      std::vector<std::size_t> rows = wang_zero_rows();
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
      std::vector<std::size_t> rows = wang_zero_rows();
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

/// Rounded, and no minus zero.
double to_a_nanometre(double mm) { return std::round(1e6 * mm) / 1e6 + 0.0; }
/// The same in um; rounded last, so that a file has six decimals at most.
double um_to_a_picometre(double mm) { return std::round(1e9 * mm) / 1e6 + 0.0; }

/// Relative difference up to which two means are the same but for rounding.
constexpr double kSameMean = 1e-6;
bool wang_size_grows(double half, double twice) { return twice > (1 + kSameMean) * half; }
const char* wang_size_words(double half, double twice) {
  if (wang_size_grows(half, twice)) return "grows too";
  return wang_size_grows(twice, half) ? "becomes smaller" : "does not depend on the size";
}

const char* in_which_unit(bool degrees, bool millidegrees) {
  if (degrees && millidegrees) return "yes, in both units";
  if (degrees) return "only with the angles in degrees as printed";
  return millidegrees ? "only with the angles in millidegrees" : "no, in neither unit";
}

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
  const double ratio_degrees = c.complete_degrees / c.displacements,
               ratio_millidegrees = c.complete_millidegrees / c.displacements;
  return {
      {"(1) complete error", "it is of the order of 1 mm",
       fmt::format("over all poses its mean is {:.0f} um and its least value {:.0f} um with the angles in degrees; in "
                   "millidegrees its mean is {:.1f} um",
                   1e3 * c.complete_degrees, 1e3 * c.smallest_degrees, 1e3 * c.complete_millidegrees),
       fmt::format("{}; {:.2g} % of the poses lie between 0.32 and 3.2 mm in degrees, and the largest error in "
                   "millidegrees is {:.3g} mm",
                   in_which_unit(is_of_the_order(c.complete_degrees, 1), is_of_the_order(c.complete_millidegrees, 1)),
                   100 * c.share_of_order_1_mm, c.largest_millidegrees)},
      {"(1) complete / displacements only", "it is about 10",
       fmt::format("it is {:.0f} in degrees and {:.2f} in millidegrees", ratio_degrees, ratio_millidegrees),
       in_which_unit(is_of_the_order(ratio_degrees, 10), is_of_the_order(ratio_millidegrees, 10))},
      {"(2) angles against displacements", "the angles count more",
       fmt::format("the error by the angles only is {:.0f} times that by the displacements only in degrees and {:.2f} "
                   "times in millidegrees",
                   c.angles_degrees / c.displacements, c.angles_millidegrees / c.displacements),
       in_which_unit(c.angles_degrees > c.displacements, c.angles_millidegrees > c.displacements)},
      {"(3) larger structure, larger error", "a larger structure makes a larger error",
       fmt::format("with points twice and half as far from their axes the mean is {:.0f} and {:.0f} um in degrees, "
                   "{:.1f} and {:.1f} um in millidegrees, {:.1f} and {:.1f} um by the displacements only",
                   1e3 * twice.degrees, 1e3 * half.degrees, 1e3 * twice.millidegrees, 1e3 * half.millidegrees,
                   1e3 * twice.no_angles, 1e3 * half.no_angles),
       fmt::format("{}; the error by the displacements only {}",
                   in_which_unit(wang_size_grows(half.degrees, twice.degrees),
                                 wang_size_grows(half.millidegrees, twice.millidegrees)),
                   wang_size_words(half.no_angles, twice.no_angles))}};
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
                                 {"largest_millidegrees_um", 1e3 * c.largest_millidegrees},
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

ReproducedTable wang_point_table(const std::vector<WangPoints>& points) {
  ReproducedTable table{
      "machining-points",
      "Figures 13 and 14: machining points in three readings, axis commands, and E in the machine frame",
      {{"points"}, {"number", "", 0}},
      {},
      {},
      false};
  add_columns(table, {"X", "Y", "Z"}, "mm", 3);
  add_columns(table, {"A", "B", "C"}, "deg", 3);
  add_columns(table, {"x", "y", "z"}, "mm", 3);
  for (const char* angles : {"degrees", "millidegrees", "displacements"}) {
    const std::string words = angles;
    add_columns(table, {"E x " + words, "E y " + words, "E z " + words}, "um");
  }
  for (const WangPoints& set : points) {
    for (std::size_t i = 0; i < set.degrees.norm.size(); ++i) {
      const std::vector<double> pose = set.degrees.poses.pose(i);  // C X Z A Y B
      std::vector<ReproducedCell> row = {set.name,
                                         i + 1,
                                         to_a_nanometre(pose[1]),
                                         to_a_nanometre(pose[4]),
                                         pose[2],
                                         pose[3] / kDegree,
                                         pose[5] / kDegree,
                                         pose[0] / kDegree};
      for (const std::vector<double>& place : set.degrees.machining_point) row.emplace_back(to_a_nanometre(place[i]));
      for (const WangMap* map : {&set.degrees, &set.millidegrees, &set.no_angles}) {
        for (const std::vector<double>& error : map->error) row.emplace_back(um_to_a_picometre(error[i]));
      }
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

std::vector<EvaluationPlot> wang_point_plots(const std::vector<WangPoints>& points) {
  XyPlot places("Figure 13: machining points, top view", "x in mm", "y in mm"),
      degrees("Figure 14: angles in degrees as printed", "point", "|E| in \xC2\xB5m"),
      small("Figure 14: angles in millidegrees, or left out", "point", "|E| in \xC2\xB5m");
  places.keep_the_same_scale();
  degrees.include_y(0);
  small.include_y(0);
  constexpr PlotColour kColours[] = {PlotColour::first, PlotColour::second, PlotColour::ink};
  constexpr Marker kMarkers[] = {Marker::circle, Marker::cross, Marker::up};
  for (std::size_t s = 0; s < points.size(); ++s) {
    const WangPoints& set = points[s];
    const auto& p = set.degrees.machining_point;
    std::vector<PlotPoint> top;
    for (std::size_t i = 0; i < set.degrees.norm.size(); ++i) top.push_back({p[0][i], p[1][i]});
    places.points(top, kMarkers[s], {kColours[s], 1.4}, set.name);
    degrees.line(numbered(set.degrees.norm), {kColours[s], 1.4}, set.name);
    small.line(numbered(set.millidegrees.norm), {kColours[s], 1.4}, set.name);
    small.points(numbered(set.no_angles.norm), kMarkers[s], {kColours[s], 1.4}, set.name + ", without angles");
  }
  degrees.level(1000, "1 mm, the paper's level", {PlotColour::limit, 1, true, 1});
  return {
      {"figure-13", "The picture in the paper has no coordinates; these are three readings of it.", places.picture()},
      {"figure-14-degrees", "Integrated error of equation (18) at the 36 points of each reading.", degrees.picture()},
      {"figure-14-millidegrees", "Lines: angles read as millidegrees. Marks: displacement errors only.",
       small.picture()}};
}

}  // namespace abbe
