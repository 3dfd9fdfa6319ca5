#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>

#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/angle_units.h"
#include "wang/results.h"

namespace abbe {
namespace {

struct WangOrder {
  const char* name;
  Composition composition;
};
constexpr WangOrder kWangOrders[] = {
    {"iso: linear T E, rotary E T", {ErrorOrder::iso, false}},
    {"T E for every axis", {ErrorOrder::after_motion, false}},
    {"E T for every axis", {ErrorOrder::before_motion, false}},
    {"T E, first order", {ErrorOrder::after_motion, true}},
};

ReproducedTable zero_pose_table(const WangResults& r) {
  ReproducedTable table{"zero-pose",
                        "Zero pose (all axes at zero): E = (W_actual - T_actual) - (W_nominal - T_nominal)",
                        {{"quantity"}, {"x", "mm", 6}, {"y", "mm", 6}, {"z", "mm", 6}},
                        {},
                        {"The example does not show in which order errors and motion are composed: at zero it makes "
                         "no difference. Unless a row says otherwise, the angles are in degrees as printed."}};
  const auto add = [&](const std::string& words, const Eigen::Vector3d& v) {
    table.rows.push_back({words, v.x(), v.y(), v.z()});
  };
  const WangPrinted printed;
  add("E, paper, equation (44)", printed.complete);
  const Machine machine = wang_machine();
  for (const WangOrder& order : kWangOrders) {
    const ErrorSet errors =
        wang_errors({.angles = WangAngleUnit::degrees, .composition = order.composition, .rows = 12});
    add(fmt::format("E, {}", order.name), wang_integrated_error(machine, errors, wang_zero_pose()).machine);
  }
  add("E, angles read as millidegrees", r.millidegrees.machine);
  add("E, paper, equation (45), displacements only", printed.displacements);
  add("E, displacements only", r.displacements.machine);
  add("T_actual, paper, equation (42)", printed.tool);
  add("T_actual", r.degrees.tool_actual);
  add("W_actual, paper, equation (43)", printed.workpiece);
  add("W_actual", r.degrees.workpiece_actual);
  return table;
}

ReproducedTable population_table(const WangResults& r) {
  ReproducedTable table{"populations",
                        "Integrated error |E| of equation (18) over all combinations of the measured positions",
                        {{"positions and angles"},
                         {"poses", "", 0},
                         {"smallest", "um", 1},
                         {"mean", "um", 1},
                         {"95 %", "um", 1},
                         {"largest", "um", 1}},
                        {},
                        {}};
  const auto add = [&](const std::string& words, const SampleStatistics& s) {
    table.rows.push_back({words, s.count, 1e3 * s.minimum, 1e3 * s.mean, 1e3 * s.p95, 1e3 * s.maximum});
  };
  for (const WangPopulationRow& row : r.populations) add(row.name, row.population.norm);
  add("poses of the map: 4^6 of the 11^6, degrees as printed", r.grid.statistics);
  table.notes = {
      "The paper speaks of \"near 3 million (12^6)\" points and shows 36 of them. 12^6 takes the printed 12th column, "
      "which is the mean of the others, for a measured position."};
  return table;
}

ReproducedTable figure_14_table(const std::vector<WangPoints>& points) {
  ReproducedTable table{"figure-14",
                        "Figures 13 and 14: |E| at 36 machining points",
                        {{"points"},
                         {"angles"},
                         {"smallest", "um", 1},
                         {"mean", "um", 1},
                         {"largest", "um", 1},
                         {"choice of the points"}},
                        {{"paper, Figure 14", "complete", {}, ReproducedCell(1000.0, 0), {}, ""},
                         {"paper, Figure 15", "left out", {}, ReproducedCell(100.0, 0), {}, ""}},
                        {"The paper shows the points in a picture without coordinates; these are three readings of it. "
                         "tables/machining-points.csv has the points, their commands and E."}};
  for (const WangPoints& set : points) {
    std::string words = set.words;
    const auto add = [&](const char* angles, const SampleStatistics& s) {
      table.rows.push_back({set.name, angles, 1e3 * s.minimum, 1e3 * s.mean, 1e3 * s.maximum, words});
      words.clear();
    };
    add("degrees as printed", set.degrees.statistics);
    add("millidegrees", set.millidegrees.statistics);
    add("left out", set.no_angles.statistics);
  }
  return table;
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

/// A pose away from zero shows what (33) and (35) leave out.
ReproducedTable inverse_table() {
  const Machine machine = wang_machine();
  const double alpha = 20 * kDegree, beta = 25 * kDegree, gamma = 40 * kDegree;
  const Eigen::Vector3d t(200, 0, 0), w = wang_workpiece_point(), wanted(120, 30, -250);
  const Eigen::Vector3d printed(wanted.x() - 200 * std::cos(beta) + 200 * std::cos(gamma), wanted.y(),
                                wanted.z() + 200 * std::sin(beta) + 400);
  ReproducedTable table{"inverse",
                        "Inverse kinematics for the machining point (120, 30, -250) mm, A = 20, B = 25, C = 40 degrees",
                        {{"equation"}, {"X", "mm", 6}, {"Y", "mm", 6}, {"Z", "mm", 6}, {"misses by", "mm", 6}},
                        {},
                        {}};
  const auto add = [&](const char* words, const Eigen::Vector3d& axes) {
    const std::vector<double> pose = {gamma, axes.x(), axes.z(), alpha, axes.y(), beta};
    const Eigen::Vector3d reached =
        nominal_bed_from_tool(machine, pose).translation - nominal_bed_from_workpiece(machine, pose) * w;
    table.rows.push_back({words, axes.x(), axes.y(), axes.z(), (reached - wanted).norm()});
  };
  add("(34), corrected", linear_axes_for(wanted, alpha, beta, gamma, t, w));
  add("(35), as printed", printed);
  return table;
}

ReproducedTable claim_table(const WangConclusions& conclusions) {
  ReproducedTable table{"claims",
                        "Conclusions of the paper, |E| over all poses of the 11 measured positions per axis",
                        {{"claim"}, {"paper"}, {"holds"}},
                        {},
                        {}};
  for (const auto& row : wang_conclusion_rows(conclusions)) table.rows.push_back({row[0], row[1], row[3]});
  return table;
}

}  // namespace

std::vector<ReproducedTable> wang_tables(const WangResults& r) {
  std::vector<ReproducedTable> tables = {zero_pose_table(r), population_table(r), figure_14_table(r.points),
                                         wang_point_table(r.points), claim_table(r.conclusions)};
  for (ReproducedTable& table : wang_dial_tables(r.dials)) tables.push_back(std::move(table));
  tables.push_back(inverse_table());
  return tables;
}

std::vector<PublishedNumber> wang_published(const WangResults& r) {
  std::vector<PublishedNumber> rows;
  const auto add = [&](const char* where, const Eigen::Vector3d& paper, const Eigen::Vector3d& here, const char* note) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      rows.push_back({fmt::format("{}, {}", where, "xyz"[i]), "mm", paper[i], here[i], note, 5});
    }
  };
  const WangPrinted printed;
  constexpr const char* kDegrees = "zero pose, angles in degrees as printed";
  add("(42), T_actual", printed.tool, r.degrees.tool_actual, kDegrees);
  add("(43), W_actual", printed.workpiece, r.degrees.workpiece_actual, kDegrees);
  add("(44), E", printed.complete, r.degrees.machine, kDegrees);
  add("(45), E by displacements only", printed.displacements, r.displacements.machine, "zero pose");
  const WangPoints& circle = r.points.front();
  rows.push_back({"Figure 14, |E| at 36 points", "um", 1000.0, 1e3 * circle.degrees.statistics.mean,
                  fmt::format("here: mean on the circle, degrees as printed; in millidegrees {:.1f} um",
                              1e3 * circle.millidegrees.statistics.mean),
                  1});
  rows.push_back({"Figure 15, |E| by displacements only", "um", 100.0, 1e3 * circle.no_angles.statistics.mean,
                  "here: mean on the circle", 1});
  const WangConclusions& c = r.conclusions;
  rows.push_back(
      {"Conclusion (1), complete / displacements only", "", 10.0, c.complete_degrees / c.displacements,
       fmt::format("here: degrees as printed; in millidegrees {:.2f}", c.complete_millidegrees / c.displacements), 1});
  return rows;
}

}  // namespace abbe
