#include "liu/cylinder.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/instruments/surface_probe.h"
#include "liu/machine.h"

namespace abbe {
namespace {

/// Where the beams begin, and their directions, workpiece frame.
struct Beams {
  Eigen::Matrix3Xd zero, direction;
};

Beams beams_of(const Machine& machine, const ErrorSet& errors, const PoseList& positions) {
  const std::vector<double> zeros(positions.count(), 0.0), ones(positions.count(), 1.0);
  Beams beams{liu_points(machine, errors, positions, zeros), {}};
  beams.direction = liu_points(machine, errors, positions, ones) - beams.zero;
  return beams;
}

/// How far the beam runs to a cylinder of a radius.
double run_to_cylinder(const Eigen::Vector3d& zero, const Eigen::Vector3d& direction, const LiuAxisLine& cylinder,
                       double radius) {
  const Eigen::Vector3d from = zero - cylinder.point;
  const Eigen::Vector3d w = from - cylinder.direction.dot(from) * cylinder.direction;
  const Eigen::Vector3d d = direction - cylinder.direction.dot(direction) * cylinder.direction;
  const double a = d.squaredNorm(), b = w.dot(d), c = w.squaredNorm() - radius * radius;
  return (-b - std::sqrt(b * b - a * c)) / a;
}

/// The radius of the standard at a point near its surface.
double radius_at(const LiuStandard& standard, const Eigen::Vector3d& point) {
  const Eigen::Vector3d at = standard.clamped.rotation.transpose() * (point - standard.clamped.translation);
  const Eigen::Vector3d& axis = standard.direction;
  const double along = axis.dot(at);
  double radius = kLiuRadius + standard.taper * along;
  if (standard.lobes != 0) {
    const double other = std::abs(axis.x()) > 0.5 ? at.y() : at.x();
    radius += standard.lobes * std::cos(3 * std::atan2(at.z(), other));
  }
  return radius;
}

std::vector<double> trace(const Beams& beams, const LiuStandard& standard) {
  constexpr int kSteps = 6;  // the form changes by micrometres over millimetres: each step gains three digits
  const bool is_round = standard.taper == 0 && standard.lobes == 0;
  const LiuAxisLine axis = standard.axis();
  std::vector<double> indications(static_cast<std::size_t>(beams.zero.cols()));
  for (std::size_t k = 0; k < indications.size(); ++k) {
    const Eigen::Vector3d zero = beams.zero.col(static_cast<Eigen::Index>(k));
    const Eigen::Vector3d direction = beams.direction.col(static_cast<Eigen::Index>(k));
    double run = run_to_cylinder(zero, direction, axis, kLiuRadius);
    for (int step = 0; step < kSteps && !is_round; ++step) {
      run = run_to_cylinder(zero, direction, axis, radius_at(standard, zero + run * direction));
    }
    indications[k] = run;
  }
  return indications;
}

}  // namespace

LiuNoise liu_table_2_noise() { return {1e-3, 0.004 * kDegree, 1e-4}; }

std::vector<double> liu_indications(const Machine& machine, const ErrorSet& errors, const PoseList& positions,
                                    const LiuAxisLine& cylinder) {
  const Beams beams = beams_of(machine, errors, positions);
  std::vector<double> indications(positions.count());
  for (std::size_t k = 0; k < indications.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    indications[k] = run_to_cylinder(beams.zero.col(column), beams.direction.col(column), cylinder, kLiuRadius);
  }
  return indications;
}

LiuScan liu_scan_standard(const Machine& machine, const ErrorSet& actual, PoseList planned, const LiuStandard& standard,
                          const LiuNoise& noise, std::uint64_t stream) {
  const std::vector<double> far = trace(beams_of(machine, actual, planned), standard);
  std::vector<double>& z = planned.axis[machine.find_axis("Z")];
  for (std::size_t k = 0; k < far.size(); ++k) z[k] -= std::round(10 * far[k]) / 10;
  PoseList standing = planned;
  RandomStream random(2021, stream);
  for (std::size_t i = 0; i < machine.axes.size() && !noise.is_none(); ++i) {
    const double deviation = machine.axes[i].kind == AxisKind::rotary ? noise.rotary : noise.linear;
    for (double& position : standing.axis[i]) position += deviation * random.normal();
  }
  LiuScan scan{std::move(planned), trace(beams_of(machine, actual, standing), standard)};
  for (double& indication : scan.indication) indication += noise.probe * random.normal();
  return scan;
}

PoseList liu_four_quarters(const Machine& machine, const std::string& stage) {
  PoseList planned;
  for (std::size_t quarter = 0; quarter < kLiuQuarters; ++quarter) {
    for (std::size_t i = 0; i < kLiuAlong; ++i) {
      for (std::size_t j = 0; j < kLiuAcross; ++j) {
        std::vector<double> positions(machine.axes.size(), 0.0);
        const double along = 2 * (static_cast<double>(i) - 6), across = static_cast<double>(j) - 4;
        positions[machine.find_axis(stage)] = static_cast<double>(quarter) * std::numbers::pi / 2;
        positions[machine.find_axis("X")] = stage == "A" ? along : across;
        positions[machine.find_axis("Y")] = stage == "A" ? across : along;
        planned.append(positions);
      }
    }
  }
  return planned;
}

std::shared_ptr<const Instrument> liu_probe_on(const Eigen::Vector3d& direction, const LiuNoise& noise,
                                               const std::string& name) {
  SurfaceProbeSetup setup;
  setup.name = name;
  // The axes' deviations reach the indication by the slope of the surface and the place: 1.2 um on average.
  setup.noise = noise.is_none() ? 1e-6 : std::hypot(1.2 * noise.linear, noise.probe);
  SurfaceProbeSetup::Clamping clamping;
  clamping.name = name;
  clamping.direction = direction;
  clamping.offset = SetupPoint::open({0, 0, 0});
  clamping.tilt_first = SetupNumber::open(0);
  clamping.tilt_second = SetupNumber::open(0);
  setup.clampings.push_back(clamping);
  return std::make_shared<SurfaceProbe>(setup);
}

InstrumentReadings liu_readings(const LiuScan& scan) {
  InstrumentReadings readings;
  for (std::size_t k = 0; k < scan.positions.count(); ++k) readings.append(scan.positions.pose(k), 0);
  readings.measured = {scan.indication};
  return readings;
}

std::array<Eigen::Index, 4> liu_cylinder_parameters(const Identification& found, const std::string& probe) {
  constexpr std::array<const char*, 4> kNames = {".tilt_first", ".tilt_second", ".offset_first", ".offset_second"};
  std::array<Eigen::Index, 4> index{};
  for (std::size_t n = 0; n < 4; ++n) {
    const auto place = std::find_if(found.parameters.begin(), found.parameters.end(),
                                    [&](const auto& parameter) { return parameter.name.ends_with(probe + kNames[n]); });
    if (place == found.parameters.end()) throw std::logic_error("no parameter " + probe + kNames[n]);
    index[n] = place - found.parameters.begin();
  }
  return index;
}

LiuAxisLine liu_line(const Eigen::Vector4d& parameters, const Eigen::Vector3d& direction) {
  const DirectionFrame frame = DirectionFrame::of(direction);
  return {parameters[2] * frame.first + parameters[3] * frame.second, frame.tilted(parameters[0], parameters[1])};
}

}  // namespace abbe
