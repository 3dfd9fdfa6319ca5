#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/errors/actual_pose.h"
#include "abbe/formats/json_text.h"
#include "abbe/formats/results_folder.h"
#include "abbe/geometry/angle_units.h"
#include "exit_code.h"
#include "reproduce/reproduce.h"
#include "reproduce/wang_grids.h"
#include "reproduce/wang_results.h"

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

std::string scaled_triple(const Eigen::Vector3d& v, const char* unit, double scale, int digits) {
  return fmt::format("({:.{}f}, {:.{}f}, {:.{}f}) {}", v.x() * scale, digits, v.y() * scale, digits, v.z() * scale,
                     digits, unit);
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

void print_zero_pose(const WangResults& r) {
  const Machine machine = wang_machine();
  const auto error = [&](const Composition& composition) {
    const ErrorSet errors = wang_errors({.angles = WangAngleUnit::degrees, .composition = composition, .rows = 12});
    return wang_integrated_error(machine, errors, wang_zero_pose()).machine;
  };
  fmt::print("Zero pose (X = Y = Z = 0, A = B = C = 0): E = (W_actual - T_actual) - (W_nominal - T_nominal)\n");
  fmt::print("  {:<44} {}\n", "paper, equation (44)", scaled_triple({0.52234, -3.60976, -4.5264}, "mm", 1, 5));
  for (const Order& order : kOrders) {
    fmt::print("  {:<44} {}\n", order.name, scaled_triple(error(order.composition), "mm", 1, 6));
  }
  fmt::print("  {:<44} {}\n", "angles read as millidegrees", scaled_triple(r.millidegrees.machine, "mm", 1, 6));
  fmt::print("  {:<44} {}\n", "paper, equation (45), displacements only",
             scaled_triple({0.001, 0.0027, -0.0002}, "mm", 1, 4));
  fmt::print("  {:<44} {}\n", "displacements only", scaled_triple(r.displacements.machine, "mm", 1, 4));
  fmt::print("  T_actual: paper (42) (193.93746, 1.72736, -4.4856), here {}\n",
             scaled_triple(r.degrees.tool_actual, "mm", 1, 5));
  fmt::print("  W_actual: paper (43) (-5.5402, -1.8824, 399.9592), here {}\n\n",
             scaled_triple(r.degrees.workpiece_actual, "mm", 1, 5));
}

void print_causes(const WangResults& r) {
  const double displacement = r.displacements.machine.norm();
  fmt::print("Why the paper's figures differ\n");
  fmt::print(
      "  (36)-(39) mix displacements of i = 1 with angles of column 12; (40), (41), (43) have wrong signs or "
      "digits;\n");
  fmt::print("  (42) prints T_X T_Z only, and 193.93746 is a slip for 199.93746; (44) adds up wrongly.\n");
  fmt::print(
      "  (45): z must be +0.0030 mm; |E| is then {:.1f} um, so the agreement with the ball bar claimed at 0.1 mm\n",
      1e3 * displacement);
  fmt::print("  fails by a factor of {:.0f}.\n", 0.1 / displacement);
  fmt::print(
      "  Column 12 of Tables A1 to A6 is the cut-off mean of columns 1 to 11 in {} of {} rows that vary: no "
      "measurement.\n",
      r.mean_column.equal, r.mean_column.rows);
  fmt::print("  Strokes of A and B are swapped against Tables A4 and A5.\n\n");
}

void print_populations(const WangResults& r) {
  fmt::print("|E| of equation (18) over all combinations of the measured positions\n");
  fmt::print("  {:<44} {:>10} {:>11} {:>11} {:>11}\n", "", "poses", "mean / um", "95 % / um", "max / um");
  for (const WangPopulationRow& row : r.populations) {
    const SampleStatistics& s = row.population.norm;
    fmt::print("  {:<44} {:>10} {:>11.2f} {:>11.2f} {:>11.2f}\n", row.name, s.count, 1e3 * s.mean, 1e3 * s.p95,
               1e3 * s.maximum);
  }
  fmt::print("  The paper speaks of 'near 3 million (12^6)' points and shows 36 of them.\n\n");
}

/// A pose away from zero shows what (33) and (35) leave out.
void print_inverse() {
  const Machine machine = wang_machine();
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
}

}  // namespace

void print_wang(const WangResults& r) {
  fmt::print("Wang, Ran, Zhang, Li (2020), Applied Sciences 10, 2164\n");
  fmt::print("grinder {}, tool at (200, 0, 0), workpiece point (0, 0, 400) mm\n\n", wang_machine().chain());
  print_zero_pose(r);
  print_causes(r);
  print_populations(r);
  print_wang_points(r.points);
  print_wang_conclusions(r.conclusions);
  print_wang_ball_bar(r.dials.study, r.displacements.machine.norm());
  print_wang_dials(r.dials);
  print_inverse();
}

int reproduce_wang(const ReproduceOptions& options) {
  if (!options.grids.empty()) return decouple_wang_grids(options);
  if (!options.output.empty()) check_results_folder(options.output);
  const WangResults results = wang_results(options.threads);
  if (!options.output.empty()) write_wang_folder(results, options.output);
  if (options.json) {
    fmt::print("{}", json_text(wang_json(results)));
    return kDone;
  }
  print_wang(results);
  if (!options.output.empty()) {
    fmt::print("\nresults in {}\nreport:    {}\n", options.output.string(), (options.output / "report.html").string());
  }
  return kDone;
}

}  // namespace abbe
