#include "reproduce/wang_ball_bar.h"

#include <array>
#include <cmath>
#include <numbers>

#include "abbe/errors/actual_pose.h"
#include "abbe/machine/machine.h"
#include "abbe/verify/circular.h"
#include "reproduce/wang_study.h"

namespace abbe {
namespace {

constexpr double kRadius = 100;
constexpr std::size_t kReadings = 360;

}  // namespace

std::vector<WangCircle> wang_ball_bar(const ErrorSet& errors) {
  const Machine machine = wang_machine();
  const std::array<std::size_t, 3> linear = {machine.find_axis("X"), machine.find_axis("Y"), machine.find_axis("Z")};
  std::vector<double> centre(machine.axes.size(), 0.0);
  // Inside the measured positions, 0 to 400, 0 to 200 and 0 to 400 mm.
  centre[linear[0]] = 200;
  centre[linear[1]] = 100;
  centre[linear[2]] = 200;
  const Eigen::Vector3d socket =
      nominal_bed_from_workpiece(machine, centre).inverse() * nominal_bed_from_tool(machine, centre).translation;
  std::vector<WangCircle> circles;
  for (std::size_t first = 0; first < 3; ++first) {
    const std::size_t second = (first + 1) % 3;
    WangCircle circle;
    circle.plane = {"XYZ"[first], "XYZ"[second]};
    CircularReadings readings;
    readings.kind = CircularAngle::commanded;
    for (std::size_t i = 0; i < kReadings; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kReadings;
      std::vector<double> pose = centre;
      pose[linear[first]] += kRadius * std::cos(angle);
      pose[linear[second]] += kRadius * std::sin(angle);
      const double length = (actual_bed_from_tool(machine, errors, pose).translation -
                             actual_bed_from_workpiece(machine, errors, pose) * socket)
                                .norm();
      circle.deviation.push_back(length - kRadius);
      readings.angle.push_back(angle);
      readings.radius.push_back(length);
    }
    CircularOptions options;
    options.nominal_radius = kRadius;
    const CircularDeviation result = circular_deviations({CircularReadings{}, readings}, options).paths[1];
    circle.converged = result.status == CircleStatus::done;
    circle.circular = result.circular;
    circles.push_back(std::move(circle));
  }
  return circles;
}

}  // namespace abbe
