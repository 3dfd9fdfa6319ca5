#include "abbe/verify/evaluations/circular_diagnosis.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

/// Unknowns of the fit: the scales enter as radius and mismatch, so that the mismatch is known where the length is not.
enum CircularUnknown : Eigen::Index {
  kCentreFirst,
  kCentreSecond,
  kRadius,
  kMismatch,
  kSquareness,
  kReversalFirst,
  kReversalSecond,
  kServo,
  kUnknowns
};
using Row = Eigen::Matrix<double, 1, kUnknowns>;

double sign(double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

/// d(radial deviation)/d(unknowns) at an angle, moving counter-clockwise (turn = 1) or clockwise (-1).
Row row_at(double angle, double turn, double radius) {
  const double c = std::cos(angle), s = std::sin(angle);
  Row row;
  row[kCentreFirst] = c;
  row[kCentreSecond] = s;
  row[kRadius] = 1;
  row[kMismatch] = radius * (c * c - s * s) / 2;
  row[kSquareness] = -radius * s * c;
  row[kReversalFirst] = -turn * sign(s) * c / 2;
  row[kReversalSecond] = turn * sign(c) * s / 2;
  row[kServo] = turn * s * c;
  return row;
}

/// Readings that one independent reading is worth, from the autocorrelation of the residuals along each path.
double correlation_length(const std::array<std::vector<double>, 2>& residuals) {
  double squares = 0;
  std::size_t count = 0, longest = 0;
  for (const std::vector<double>& path : residuals) {
    for (const double value : path) squares += value * value;
    count += path.size();
    longest = std::max(longest, path.size());
  }
  if (!(squares > 0)) return 1;
  const double n = static_cast<double>(count);
  double sum = 1;
  for (std::size_t lag = 1; lag < longest / 2; ++lag) {
    double product = 0;
    for (const std::vector<double>& path : residuals) {
      for (std::size_t i = lag; i < path.size(); ++i) product += path[i] * path[i - lag];
    }
    const double correlation = product / squares;
    if (correlation < 2 / std::sqrt(n)) break;
    sum += 2 * correlation;
  }
  return sum;
}

/// Values in the order of their angles: neighbours along the path, whatever the order of the rows.
std::vector<double> along_path(const std::vector<double>& angles, const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return angles[a] < angles[b]; });
  std::vector<double> sorted;
  for (const std::size_t i : order) sorted.push_back(values[i]);
  return sorted;
}

struct Fit {
  Eigen::VectorXd values;        // [unknowns]
  Eigen::MatrixXd covariance;    // [unknowns, unknowns] for residuals of variance one, truncated
  Eigen::VectorXd distinctness;  // [unknowns]
};

/// Least squares by singular values of the columns scaled to one. Null directions get nothing; an unknown in them has
/// distinctness zero, so that its value is never shown.
Fit fit(const Eigen::MatrixXd& rows, const Eigen::VectorXd& right) {
  Fit result;
  Eigen::VectorXd scale(kUnknowns);
  for (Eigen::Index j = 0; j < kUnknowns; ++j) {
    const double norm = rows.col(j).norm();
    scale[j] = norm > 0 ? norm : 1;
  }
  const Eigen::MatrixXd scaled = rows * scale.cwiseInverse().asDiagonal();
  const Qr qr(scaled);
  const Eigen::MatrixXd triangle = qr.upper(kUnknowns);
  const Eigen::VectorXd rotated = qr.rotated_back(right).head(kUnknowns);
  const SingularValues<> svd(triangle);
  const Eigen::VectorXd& singular = svd.values();
  Eigen::VectorXd inverse = Eigen::VectorXd::Zero(kUnknowns), spread = inverse;
  for (Eigen::Index k = 0; k < kUnknowns; ++k) {
    const double floor = 1e-10 * singular[0];
    if (singular[k] > floor) inverse[k] = 1 / singular[k];
    spread[k] = 1 / std::max(singular[k], floor);
  }
  const Eigen::MatrixXd& v = svd.v();
  result.values = scale.cwiseInverse().asDiagonal() * (v * inverse.asDiagonal() * (svd.u().transpose() * rotated));
  const Eigen::MatrixXd factor = scale.cwiseInverse().asDiagonal() * v * inverse.asDiagonal();
  result.covariance = factor * factor.transpose();
  result.distinctness = Eigen::VectorXd::Zero(kUnknowns);
  for (Eigen::Index j = 0; j < kUnknowns; ++j) {
    if (rows.col(j).norm() > 0) result.distinctness[j] = 1 / (v.row(j).transpose().cwiseProduct(spread)).norm();
  }
  return result;
}

/// Where the unknown of a cause stands; the two scales are made of two of them.
constexpr std::array<Eigen::Index, kCircularCauses> kUnknownOf = {
    kCentreFirst, kCentreSecond, kRadius, kMismatch, -1, -1, kSquareness, kReversalFirst, kReversalSecond, kServo};

}  // namespace

CircularDiagnosis circular_diagnosis(const std::array<CircularReadings, 2>& paths, const DiagnosisOptions& options) {
  assert(options.nominal_radius > 0);
  CircularDiagnosis result;
  CircularReadings all = paths[0].count() > 0 ? paths[0] : paths[1];
  if (paths[0].count() > 0) {
    all.angle.insert(all.angle.end(), paths[1].angle.begin(), paths[1].angle.end());
    all.radius.insert(all.radius.end(), paths[1].radius.begin(), paths[1].radius.end());
  }
  const auto n = static_cast<Eigen::Index>(all.count());
  result.status = DiagnosisStatus::too_few_readings;
  if (n <= kUnknowns) return result;
  const CircleCentre gauss = least_squares_circle(all);
  const Eigen::Vector2d centre = gauss.status == CircleStatus::done ? gauss.centre : Eigen::Vector2d::Zero();

  Eigen::MatrixXd rows(n, kUnknowns);
  Eigen::VectorXd right(n);
  const auto clockwise = static_cast<Eigen::Index>(paths[0].count());
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto reading = static_cast<std::size_t>(i);
    const double radius = radius_about(all, reading, centre);
    if (!(radius > 0)) return result;
    rows.row(i) = row_at(angle_about(all, reading, centre), i < clockwise ? -1 : 1, options.nominal_radius);
    right[i] = radius - options.nominal_radius;
  }
  // Left out: rows of zeros, which say nothing.
  Eigen::MatrixXd fitted_rows = rows;
  Eigen::VectorXd taken = Eigen::VectorXd::Ones(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double angle = angle_about(all, static_cast<std::size_t>(i), centre);
    if (std::abs(std::remainder(angle, std::numbers::pi / 2)) >= options.reversal_margin) continue;
    taken[i] = 0;
    fitted_rows.row(i).setZero();
  }
  const double count = taken.sum(), unknowns = static_cast<double>(kUnknowns);
  if (count <= unknowns) return result;
  const Fit solution = fit(fitted_rows, right.cwiseProduct(taken));
  const Eigen::VectorXd all_residuals = right - rows * solution.values, residuals = all_residuals.cwiseProduct(taken);
  std::array<std::vector<double>, 2> taken_residuals;
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t path = i < clockwise ? 0 : 1;
    result.residuals[path].push_back(all_residuals[i]);
    taken_residuals[path].push_back(residuals[i]);
    result.modelled[path].push_back(rows.row(i).tail<kUnknowns - 2>().dot(solution.values.tail<kUnknowns - 2>()));
  }
  result.residual_rms = std::sqrt(residuals.squaredNorm() / (count - unknowns));
  result.residual_peak_to_peak = residuals.maxCoeff() - residuals.minCoeff();
  for (std::size_t path = 0; path < 2; ++path)
    taken_residuals[path] = along_path(paths[path].angle, taken_residuals[path]);
  result.correlation_length = correlation_length(taken_residuals);
  // As many readings as are independent; at least one more than unknowns, else nothing could be said at all.
  const double independent = std::max(count / result.correlation_length, unknowns + 1);
  const double variance = residuals.squaredNorm() / (independent - unknowns);

  const auto effect_of = [&](const Eigen::VectorXd& pattern) { return pattern.maxCoeff() - pattern.minCoeff(); };
  for (std::size_t k = 0; k < kCircularCauses; ++k) {
    CircularCauseValue& cause = result.causes[k];
    const Eigen::Index j = kUnknownOf[k];
    if (j < 0) continue;
    cause.distinctness = solution.distinctness[j];
    cause.separable = cause.distinctness >= kLeastDistinctness;
    if (!cause.separable) continue;
    cause.value = solution.values[j];
    cause.uncertainty = std::sqrt(variance * solution.covariance(j, j));
    cause.effect = effect_of(rows.col(j) * cause.value);
    if (j == kCentreFirst) cause.value += centre.x();
    if (j == kCentreSecond) cause.value += centre.y();
    if (j == kRadius) cause.uncertainty = std::hypot(cause.uncertainty, options.length_uncertainty);
  }
  const CircularCauseValue& radius = result.causes[static_cast<std::size_t>(CircularCause::radius)];
  const CircularCauseValue& mismatch = result.causes[static_cast<std::size_t>(CircularCause::scale_mismatch)];
  for (const double side : {1.0, -1.0}) {
    CircularCauseValue& scale =
        result.causes[static_cast<std::size_t>(side > 0 ? CircularCause::scale_first : CircularCause::scale_second)];
    scale.distinctness = std::min(radius.distinctness, mismatch.distinctness);
    scale.separable = options.length_calibrated && radius.separable && mismatch.separable;
    if (!scale.separable) continue;
    // scale = radius / R +- mismatch / 2
    const double r = options.nominal_radius;
    const Eigen::MatrixXd& c = solution.covariance;
    const double of_fit =
        c(kRadius, kRadius) / (r * r) + c(kMismatch, kMismatch) / 4 + side * c(kRadius, kMismatch) / r;
    scale.value = radius.value / r + side * mismatch.value / 2;
    scale.uncertainty = std::hypot(std::sqrt(std::max(0.0, variance * of_fit)), options.length_uncertainty / r);
    scale.effect = effect_of(rows.col(kMismatch) * (scale.value * side) + rows.col(kRadius) * (scale.value * r / 2));
  }
  const bool all_separable = std::all_of(result.causes.begin(), result.causes.end(),
                                         [](const CircularCauseValue& cause) { return cause.separable; });
  result.status = all_separable ? DiagnosisStatus::done : DiagnosisStatus::partly_separable;
  return result;
}

}  // namespace abbe
