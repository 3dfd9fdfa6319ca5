#include "abbe/geometry/trilateration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>

#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The points about their middle, in their principal axes: the last is the normal of the best plane.
struct Frame {
  Vector3d middle = Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns
  Vector3d extent = Vector3d::Zero();                  ///< rms along them, mm

  explicit Frame(const std::vector<Vector3d>& points) {
    Eigen::Matrix3Xd matrix(3, static_cast<Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) matrix.col(static_cast<Index>(i)) = points[i];
    middle = matrix.rowwise().mean();
    matrix.colwise() -= middle;
    const Eigen::Matrix3d moments = matrix * matrix.transpose() / static_cast<double>(points.size());
    const SingularValues<3> svd(moments, Eigen::ComputeFullU);
    axes = svd.u();
    extent = svd.values().cwiseSqrt();
  }
  Vector3d into(const Vector3d& point) const { return axes.transpose() * (point - middle); }
  Vector3d out_of(const Vector3d& own) const { return axes * own + middle; }
};

struct StationPlace {
  Vector3d position;
  std::vector<double> dead_path;
  double scale =
      std::numeric_limits<double>::infinity();  ///< 1.4826 times the residual within which enough lengths lie
};

/// Dead path of every run for a position, points and position in one frame.
std::vector<double> medians(const TrilaterationData& data, const std::vector<Vector3d>& points,
                            const Vector3d& position) {
  std::vector<std::vector<double>> found(data.dead_path.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    found[data.run[i]].push_back((points[i] - position).norm() - data.lengths[i]);
  }
  std::vector<double> result;
  for (std::size_t r = 0; r < found.size(); ++r) {
    result.push_back(data.dead_path[r] ? *data.dead_path[r] : found[r].empty() ? 0 : median(found[r]));
  }
  return result;
}

class PositionSearch {
 public:
  PositionSearch(const TrilaterationData& data, const Frame& frame) : data_(data), frame_(frame) {
    for (const Vector3d& point : data.points) points_.push_back(frame.into(point));
    // Rousseeuw and Leroy, Robust Regression (1987), ch. 3: with the plain median of few lengths, as many as there are
    // unknowns would always be explained.
    std::size_t unknowns = 3;
    for (const std::optional<double>& known : data.dead_path) unknowns += known ? 0 : 1;
    explained_ = std::min(data.points.size(), data.points.size() / 2 + (unknowns + 1) / 2);
  }

  double residual(const StationPlace& candidate, std::size_t i) const {
    return data_.lengths[i] + candidate.dead_path[data_.run[i]] - (points_[i] - candidate.position).norm();
  }

  /// Dead paths by the median, then the scale of what remains.
  StationPlace judged(const Vector3d& position) const {
    StationPlace result{position, medians(data_, points_, position)};
    result.scale = scale_of(result);
    return result;
  }

  double scale_of(const StationPlace& candidate) const {
    std::vector<double> sizes;
    for (std::size_t i = 0; i < points_.size(); ++i) sizes.push_back(std::abs(residual(candidate, i)));
    const auto quantile = sizes.begin() + static_cast<std::ptrdiff_t>(explained_ - 1);
    std::nth_element(sizes.begin(), quantile, sizes.end());
    return 1.4826 * *quantile;
  }

  /// Linear solutions of readings of one run, in space and in the plane (both sides).
  void solve(const std::vector<std::size_t>& chosen, std::vector<Vector3d>& found) const {
    const std::optional<double>& known = data_.dead_path[data_.run[chosen.front()]];
    for (const Index dimensions : {Index{3}, Index{2}}) {
      const Index unknowns = dimensions + (known ? 1 : 2), n = static_cast<Index>(chosen.size());
      if (n < unknowns) continue;
      // Lengths about their mean keep the columns apart; the shift belongs to the dead path.
      double shift = known ? -*known : 0;
      for (const std::size_t i : chosen) shift += known ? 0 : data_.lengths[i] / static_cast<double>(n);
      Eigen::MatrixXd matrix(n, unknowns);
      Eigen::VectorXd right(n);
      for (Index k = 0; k < n; ++k) {
        const std::size_t i = chosen[static_cast<std::size_t>(k)];
        const double length = data_.lengths[i] - shift;
        matrix.row(k).head(dimensions) = 2 * points_[i].head(dimensions);
        if (!known) matrix(k, dimensions) = 2 * length;
        matrix(k, unknowns - 1) = 1;
        right[k] = points_[i].squaredNorm() - length * length;
      }
      const Eigen::VectorXd solution = PivotedQr(matrix).solve(right);
      if (!solution.allFinite()) continue;
      Vector3d position = Vector3d::Zero();
      position.head(dimensions) = solution.head(dimensions);
      const double dead = known ? 0 : solution[dimensions];
      if (dimensions == 3) {
        found.push_back(position);
        continue;
      }
      const double height = dead * dead - solution[unknowns - 1] - position.squaredNorm();
      position.z() = std::sqrt(std::max(0.0, height));
      found.push_back(position);
      position.z() = -position.z();
      found.push_back(position);
    }
  }

  /// Gauss-Newton with Tukey's weights; a step that makes the fit worse is shortened.
  StationPlace refined(StationPlace now) const {
    std::vector<Index> column(data_.dead_path.size(), -1);
    Index unknowns = 3;
    for (std::size_t r = 0; r < column.size(); ++r) {
      if (!data_.dead_path[r]) column[r] = unknowns++;
    }
    for (int iteration = 0; iteration < 100; ++iteration) {
      const double bound = 4.685 * std::max(now.scale, floor());
      Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
      Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
      for (std::size_t i = 0; i < points_.size(); ++i) {
        const double r = residual(now, i), share = r / bound;
        if (std::abs(share) >= 1) continue;
        const double weight = std::pow(1 - share * share, 2);
        const Vector3d sight = now.position - points_[i];
        const double distance = sight.norm();
        if (!(distance > 0)) continue;
        Eigen::VectorXd row = Eigen::VectorXd::Zero(unknowns);
        row.head<3>() = sight / distance;
        if (column[data_.run[i]] >= 0) row[column[data_.run[i]]] = -1;
        normal += weight * row * row.transpose();
        right += weight * r * row;
      }
      normal.diagonal() *= 1 + 1e-12;
      normal.diagonal().array() += 1e-14 * normal.diagonal().maxCoeff() + 1e-300;
      const Eigen::VectorXd step = Ldlt<>(normal).solve(right);
      if (!step.allFinite()) return now;
      bool better = false;
      for (double share = 1; share > 1e-3 && !better; share *= 0.5) {
        StationPlace next = now;
        next.position += share * step.head<3>();
        for (std::size_t r = 0; r < column.size(); ++r) {
          if (column[r] >= 0) next.dead_path[r] += share * step[column[r]];
        }
        next.scale = scale_of(next);
        // Near the solution the median wavers by rounding and by readings that change sides.
        if (next.scale <= 1.05 * now.scale + floor()) {
          now = next;
          better = true;
        }
      }
      if (!better || step.norm() < 1e-9) break;
    }
    return now;
  }

  double floor() const { return 1e-9 + 1e-12 * frame_.extent[0]; }

 private:
  const TrilaterationData& data_;
  const Frame& frame_;
  std::vector<Vector3d> points_;
  std::size_t explained_ = 0;  ///< lengths that a position has to explain
};

/// Start positions: subsets of the longest run, drawn with a fixed seed, and all of its readings.
std::vector<Vector3d> drawn_positions(const TrilaterationData& data, const PositionSearch& search, std::size_t draws) {
  std::vector<std::vector<std::size_t>> runs(data.dead_path.size());
  for (std::size_t i = 0; i < data.run.size(); ++i) runs[data.run[i]].push_back(i);
  const std::vector<std::size_t>& longest =
      *std::max_element(runs.begin(), runs.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  std::vector<Vector3d> found;
  search.solve(longest, found);
  std::mt19937_64 generator(20231);
  const std::size_t size = std::min<std::size_t>(longest.size(), 7);
  for (std::size_t draw = 0; draw < draws && longest.size() > size; ++draw) {
    std::vector<std::size_t> left = longest, chosen;
    for (std::size_t k = 0; k < size; ++k) {
      const std::size_t pick = k + static_cast<std::size_t>(generator() % (left.size() - k));
      std::swap(left[k], left[pick]);
      chosen.push_back(left[k]);
    }
    search.solve(chosen, found);
  }
  return found;
}

void check(const TrilaterationData& data) {
  const std::size_t n = data.points.size();
  if (data.lengths.size() != n || data.run.size() != n) throw std::invalid_argument("trilateration: sizes differ");
  for (const std::size_t run : data.run) {
    if (run >= data.dead_path.size()) throw std::invalid_argument("trilateration: run without dead path");
  }
}

}  // namespace

std::vector<double> dead_paths_at(const TrilaterationData& data, const Vector3d& position) {
  check(data);
  return medians(data, data.points, position);
}

Trilateration trilaterate(const TrilaterationData& data, const TrilaterationOptions& options) {
  check(data);
  const std::size_t n = data.points.size();
  Trilateration result;
  result.dead_path.assign(data.dead_path.size(), 0.0);
  result.inliers.assign(n, 1);
  result.position = data.near.value_or(Vector3d::Zero());
  std::size_t open = 0;
  for (const std::optional<double>& known : data.dead_path) open += known ? 0 : 1;
  if (n < 3 + open) {
    result.status = TrilaterationStatus::too_few_points;
    return result;
  }
  const Frame frame(data.points);
  if (frame.extent[1] < 1e-6 * frame.extent[0] + 1e-6) {
    result.status = TrilaterationStatus::collinear;
    result.direction = frame.axes.col(0);
    return result;
  }
  const PositionSearch search(data, frame);
  std::vector<StationPlace> candidates;
  for (const Vector3d& position : drawn_positions(data, search, options.draws)) {
    candidates.push_back(search.judged(position));
  }
  if (data.near) candidates.push_back(search.judged(frame.into(*data.near)));
  std::sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.scale < b.scale; });
  if (candidates.size() > 8) candidates.resize(8);
  StationPlace best;
  for (const StationPlace& candidate : candidates) {
    const StationPlace refined = search.refined(candidate);
    if (refined.scale < best.scale) best = refined;
  }
  if (!(best.scale < options.tolerance)) {
    result.status = TrilaterationStatus::no_consensus;
    return result;
  }
  result.status = TrilaterationStatus::ok;
  const StationPlace other = search.refined(search.judged(best.position.cwiseProduct(Vector3d(1, 1, -1))));
  const double apart = std::abs(other.position.z() - best.position.z());
  if (other.scale < 1.5 * best.scale + search.floor() && apart > 10 * (best.scale + search.floor())) {
    result.status = TrilaterationStatus::mirrored;
    result.direction = frame.axes.col(2);
    result.other = frame.out_of(other.position);
    if (data.near &&
        (frame.into(*data.near) - other.position).norm() < (frame.into(*data.near) - best.position).norm()) {
      result.other = frame.out_of(best.position);
      best = other;
    }
  }
  result.position = frame.out_of(best.position);
  result.dead_path = best.dead_path;
  double sum = 0, taken = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double r = search.residual(best, i);
    result.inliers[i] = std::abs(r) < 4.685 * std::max(best.scale, search.floor()) ? 1 : 0;
    if (result.inliers[i] == 0) continue;
    sum += r * r;
    taken += 1;
  }
  result.rms = taken > 0 ? std::sqrt(sum / taken) : 0;
  return result;
}

}  // namespace abbe
