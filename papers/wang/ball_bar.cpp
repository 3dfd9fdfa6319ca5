#include "wang/ball_bar.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_stream.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/instruments/ball_bar.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/machine/machine.h"
#include "abbe/report/drawings/svg_polar_plot.h"
#include "abbe/verify/evaluations/circular.h"

namespace abbe {
namespace {

constexpr double kRadius = 100;
constexpr std::size_t kReadings = 360;
constexpr int kSamples = 400;
constexpr std::uint64_t kSamplingSeed = 15;

/// Derivatives of the indicated lengths by all parameters of the errors, [readings, p].
Eigen::MatrixXd length_slopes(const Machine& machine, const ErrorSet& errors, const Eigen::Vector3d& socket,
                              InstrumentReadings readings) {
  BallBarSetup setup;
  setup.spindle_ball = SetupPoint::exact(machine.tool_offset);
  setup.balls = {{"socket", SetupPoint::exact(socket)}};
  const std::size_t count = readings.count();
  readings.measured = {std::vector<double>(count, kRadius)};
  readings.uncertainty = {std::vector<double>(count, 1.0)};
  const InstrumentObservations observations(machine, errors, std::make_shared<BallBar>(setup), std::move(readings));
  std::vector<std::size_t> parameters(errors.parameter_count());
  std::iota(parameters.begin(), parameters.end(), std::size_t{0});
  Eigen::MatrixXd slopes(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(parameters.size()));
  std::vector<double> residuals(Observations::kBlockSize), block(parameters.size() * Observations::kBlockSize);
  for (std::size_t first = 0; first < count; first += Observations::kBlockSize) {
    const std::size_t size = std::min(Observations::kBlockSize, count - first);
    observations.evaluate(first, size, parameters, {}, residuals.data(), block.data(), Observations::kBlockSize);
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      for (std::size_t k = 0; k < size; ++k) {
        // A residual is measured minus modelled, here with the uncertainty one.
        slopes(static_cast<Eigen::Index>(first + k), static_cast<Eigen::Index>(p)) =
            -block[p * Observations::kBlockSize + k];
      }
    }
  }
  return slopes;
}

/// G of radii by degrees.
CircularDeviation circular_deviation(std::vector<double> radii) {
  CircularReadings readings;
  readings.kind = CircularAngle::commanded;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    readings.angle.push_back(2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(radii.size()));
  }
  readings.radius = std::move(radii);
  CircularOptions options;
  options.nominal_radius = kRadius;
  return circular_deviations({CircularReadings{}, readings}, options).paths[1];
}

void add_uncertainty(const Eigen::MatrixXd& slopes, const Eigen::MatrixXd& covariance, WangCircle& circle) {
  const Eigen::MatrixXd trace = slopes * covariance * slopes.transpose();
  for (Eigen::Index k = 0; k < trace.rows(); ++k) circle.uncertainty.push_back(std::sqrt(std::max(0.0, trace(k, k))));
  // G is the largest less the smallest of many: which angles decide it changes with the noise, so it is sampled.
  const SymmetricEigen<> solver(trace);
  const Eigen::MatrixXd factor = solver.eigenvectors() * solver.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  RandomStream random(kSamplingSeed);
  double squares = 0;
  for (int sample = 0; sample < kSamples; ++sample) {
    Eigen::VectorXd normal(trace.rows());
    for (double& value : normal) value = random.normal();
    const Eigen::VectorXd off = factor * normal;
    std::vector<double> radii;
    for (Eigen::Index k = 0; k < trace.rows(); ++k) {
      radii.push_back(kRadius + circle.deviation[static_cast<std::size_t>(k)] + off[k]);
    }
    const double change = circular_deviation(std::move(radii)).circular - circle.circular;
    squares += change * change / kSamples;
  }
  circle.circular_uncertainty = std::sqrt(squares);
}

/// The readings of the tables whose circles are shown beside that of the errors found.
std::vector<WangBallBarModel> ball_bar_models() {
  std::vector<WangBallBarModel> models = {
      {"displacements only", {.angles = WangAngleUnit::none, .composition = {}}, {}},
      {"angles only, millidegrees",
       {.angles = WangAngleUnit::millidegrees, .composition = {}, .rows = 11, .displacements = false},
       {}},
      {"complete, millidegrees", {.angles = WangAngleUnit::millidegrees, .composition = {}}, {}},
      {"complete, degrees as printed", {.angles = WangAngleUnit::degrees, .composition = {}}, {}}};
  for (WangBallBarModel& model : models) model.circles = wang_ball_bar(wang_errors(model.reading));
  return models;
}

double degrees_at(std::size_t reading) { return 360.0 * static_cast<double>(reading) / kReadings; }

}  // namespace

std::vector<WangCircle> wang_ball_bar(const ErrorSet& errors, const Eigen::MatrixXd* covariance) {
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
    std::vector<double> radii;
    InstrumentReadings poses;
    for (std::size_t i = 0; i < kReadings; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kReadings;
      std::vector<double> pose = centre;
      pose[linear[first]] += kRadius * std::cos(angle);
      pose[linear[second]] += kRadius * std::sin(angle);
      const double length = (actual_bed_from_tool(machine, errors, pose).translation -
                             actual_bed_from_workpiece(machine, errors, pose) * socket)
                                .norm();
      circle.deviation.push_back(length - kRadius);
      radii.push_back(length);
      poses.append(pose, 0);
    }
    const CircularDeviation result = circular_deviation(std::move(radii));
    circle.converged = result.status == CircleStatus::done;
    circle.circular = result.circular;
    if (covariance != nullptr) {
      add_uncertainty(length_slopes(machine, errors, socket, std::move(poses)), *covariance, circle);
    }
    circles.push_back(std::move(circle));
  }
  return circles;
}

WangBallBarStudy wang_ball_bar_study(const DecoupledErrors& with_noise, const DecoupledErrors& without_noise) {
  return {ball_bar_models(), wang_ball_bar(with_noise.errors, &with_noise.covariance),
          wang_ball_bar(without_noise.errors)};
}

double wang_share_within(const WangCircle& circle, const WangCircle& without_noise) {
  std::size_t within = 0;
  for (std::size_t k = 0; k < circle.uncertainty.size(); ++k) {
    within += std::abs(circle.deviation[k] - without_noise.deviation[k]) <= 2 * circle.uncertainty[k] ? 1U : 0U;
  }
  return circle.uncertainty.empty() ? 0 : static_cast<double>(within) / static_cast<double>(circle.uncertainty.size());
}

SvgPicture wang_circle_picture(const WangCircle& circle, const WangCircle& without_noise) {
  std::vector<PolarPoint> found, low, high, exact;
  for (std::size_t k = 0; k < circle.deviation.size(); ++k) {
    const double angle = degrees_at(k) * kDegree, value = 1e3 * circle.deviation[k];
    const double band = 2e3 * circle.uncertainty[k];
    found.push_back({angle, value});
    low.push_back({angle, value - band});
    high.push_back({angle, value + band});
    exact.push_back({angle, 1e3 * without_noise.deviation[k]});
  }
  PolarPlot plot(fmt::format("Ball bar in {}, from 36 decoupled errors", circle.plane), "deviation in \xC2\xB5m");
  plot.name_axes(std::string("+") + circle.plane[0], std::string("+") + circle.plane[1]);
  const PlotStyle band{PlotColour::first, 1, true, 0.7};
  plot.line(low, true, band, "expanded uncertainty, k = 2");
  plot.line(high, true, band);
  plot.line(exact, true, {PlotColour::second, 1.2, false, 1}, "from readings without noise");
  plot.line(found, true, {PlotColour::first, 1.8, false, 1}, "deviation");
  return plot.picture();
}

}  // namespace abbe
