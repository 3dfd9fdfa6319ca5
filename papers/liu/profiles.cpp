#include "liu/profiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/fits/shape_fit.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

PoseList turns_of_c(const Machine& machine, const std::vector<double>& heights, std::size_t steps) {
  PoseList planned;
  for (const double height : heights) {
    for (std::size_t i = 0; i < steps; ++i) {
      std::vector<double> positions(machine.axes.size(), 0.0);
      positions[machine.find_axis("C")] = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(steps);
      positions[machine.find_axis("Y")] = height;
      planned.append(positions);
    }
  }
  return planned;
}

/// Centre and radius by x^2 + z^2 = 2 a x + 2 b z + c.
void fit_circle(LiuSection& section, const Eigen::Matrix3Xd& points) {
  Eigen::MatrixXd rows(points.cols(), 3);
  Eigen::VectorXd squares(points.cols());
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    rows.row(k) << 2 * points(0, k), 2 * points(2, k), 1;
    squares[k] = points(0, k) * points(0, k) + points(2, k) * points(2, k);
  }
  const Eigen::Vector3d circle = Ldlt<>(rows.transpose() * rows).solve(rows.transpose() * squares);
  section.x = circle[0];
  section.z = circle[1];
  section.radius = std::sqrt(circle[2] + circle[0] * circle[0] + circle[1] * circle[1]);
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double distance = std::hypot(points(0, k) - section.x, points(2, k) - section.z);
    low = std::min(low, distance);
    high = std::max(high, distance);
  }
  section.out_of_round = high - low;
}

/// Slope of values over heights.
double slope_of(const std::vector<LiuSection>& sections, double LiuSection::*value) {
  double height = 0, mean = 0, product = 0, square = 0;
  const auto n = static_cast<double>(sections.size());
  for (const LiuSection& s : sections) {
    height += s.height / n;
    mean += s.*value / n;
  }
  for (const LiuSection& s : sections) {
    product += (s.height - height) * (s.*value - mean);
    square += (s.height - height) * (s.height - height);
  }
  return square > 0 ? product / square : 0;
}

double correlation_of(const std::vector<double>& a, const std::vector<double>& b) {
  double aa = 0, bb = 0, ab = 0;  // both have zero mean: distances from a least-squares cylinder
  for (std::size_t k = 0; k < a.size(); ++k) {
    aa += a[k] * a[k];
    bb += b[k] * b[k];
    ab += a[k] * b[k];
  }
  return ab / std::sqrt(aa * bb);
}

}  // namespace

LiuProfile liu_profile(const Machine& machine, const LiuSectionCase& how, const std::vector<double>& heights) {
  constexpr std::size_t kSteps = 72;
  LiuStandard standard;
  standard.clamped = how.clamped;
  const RigidTransform part_from_workpiece = how.removed.inverse();
  LiuProfile profile;
  profile.words = how.words;
  for (const double height : heights) {
    const LiuScan scan = liu_scan_standard(machine, how.actual, turns_of_c(machine, {height}, kSteps), standard, {}, 0);
    const Eigen::Matrix3Xd seen = liu_points(machine, how.evaluated, scan.positions, scan.indication);
    const Eigen::Matrix3Xd points = (part_from_workpiece.rotation * seen).colwise() + part_from_workpiece.translation;
    LiuSection section;
    section.height = height;
    section.angle = scan.positions.axis[machine.find_axis("C")];
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      section.distance.push_back(std::hypot(points(0, k), points(2, k)));
      profile.deviation = std::max(profile.deviation, std::abs(section.distance.back() - kLiuRadius));
    }
    fit_circle(section, points);
    profile.out_of_round = std::max(profile.out_of_round, section.out_of_round);
    profile.sections.push_back(std::move(section));
  }
  profile.lean =
      std::atan(std::hypot(slope_of(profile.sections, &LiuSection::x), slope_of(profile.sections, &LiuSection::z)));
  profile.growth = slope_of(profile.sections, &LiuSection::radius);
  return profile;
}

RigidTransform liu_on_stage_axis(const Machine& machine, const ErrorSet& errors) {
  const std::size_t c = machine.find_axis("C");
  // A half turn is 2 d d' - 1; half of its translation is the point of the line nearest to the origin.
  const RigidTransform half = actual_motion(machine, errors, c, std::numbers::pi);
  const Eigen::Vector3d nominal = machine.axes[c].direction;
  const Eigen::Vector3d direction = (half.rotation * nominal + nominal).normalized();
  return {rotation_between(nominal, direction), 0.5 * half.translation};
}

LiuRepeats liu_repeats(const Machine& machine, const ErrorSet& truth, const LiuClampingErrors& clamping,
                       const LiuCase& calibration, double lobes) {
  LiuRepeats repeats;
  repeats.words = calibration.words;
  const LiuCampaign campaign = liu_campaign(machine, truth, clamping, calibration);
  repeats.complete = campaign.converged();
  repeats.heights = {-10, -5, 0, 5, 10};
  const PoseList path = turns_of_c(machine, {repeats.heights.begin(), repeats.heights.end()}, LiuRepeats::kSteps);
  LiuStandard standard;
  standard.clamped = liu_clamped(clamping);
  standard.taper = calibration.taper;
  standard.lobes = lobes;
  for (std::size_t run = 0; run < LiuRepeats::kRuns; ++run) {
    const LiuScan scan = liu_scan_standard(machine, truth, path, standard, liu_table_2_noise(), 1000 + run);
    const Eigen::Matrix3Xd points = liu_points(machine, campaign.c.errors, scan.positions, scan.indication);
    const ShapeFit fit = least_squares_fit(ShapeKind::cylinder, points);
    repeats.complete = repeats.complete && fit.ok();
    if (!fit.ok()) return repeats;
    repeats.rms[run] = fit.rms;
    repeats.radius[run] = fit.shape.radius;
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const Eigen::Vector3d from = points.col(k) - fit.shape.point;
      repeats.deviations[run].push_back(from.cross(fit.shape.direction).norm() - fit.shape.radius);
    }
  }
  double squares = 0;
  const std::size_t places = repeats.deviations[0].size();
  for (std::size_t k = 0; k < places; ++k) {
    double mean = 0;
    for (const std::vector<double>& run : repeats.deviations) mean += run[k] / LiuRepeats::kRuns;
    for (const std::vector<double>& run : repeats.deviations) squares += (run[k] - mean) * (run[k] - mean);
  }
  repeats.repeatability = std::sqrt(squares / static_cast<double>(places * (LiuRepeats::kRuns - 1)));
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < LiuRepeats::kRuns; ++i) {
    for (std::size_t j = 0; j < i; ++j, ++pairs) {
      repeats.correlation += correlation_of(repeats.deviations[i], repeats.deviations[j]);
    }
  }
  repeats.correlation /= static_cast<double>(pairs);
  return repeats;
}

}  // namespace abbe
