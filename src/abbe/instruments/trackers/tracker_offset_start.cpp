#include "abbe/instruments/trackers/tracker_offset_start.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/trackers/pose_tracker_start.h"

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Index = Eigen::Index;

constexpr double kFarExtent = 0.03;         // of the extent of the points: a reading as far off counts in full
constexpr double kWellFound = 0.25;         // misfit of a station below which stated offsets stay
constexpr double kMuchBetter = 0.5;         // of the misfit, for offsets to be taken
constexpr std::size_t kMostOfStation = 60;  // readings that the search of offsets takes, evenly chosen
constexpr std::size_t kSubsets = 64;
constexpr double kWorthRefining = 4;  // times the lowest score so far
constexpr double kSubsetQuantile = 0.55;
constexpr double kUndetermined = 1e-6;  // eigenvalues of the scaled normal matrix, of the largest
constexpr double kOutlying = 4.5;       // times the median distance

/// A reading of one station: the point in the frame of the tracker, and the body that carries the reflector.
struct SeenReflector {
  std::size_t reflector;
  Vector3d measured;
  RigidTransform body;
};

/// The pose of one station and the offsets of all reflectors.
struct StationAndOffsets {
  RigidTransform pose;
  std::vector<Vector3d> offset;  ///< [reflectors]
};

class OffsetSearch {
 public:
  OffsetSearch(const TrackerSetup& setup, std::vector<SeenReflector> seen) : seen_(std::move(seen)) {
    first_column_.assign(setup.reflectors.size(), -1);
    for (const SeenReflector& one : seen_) {
      Index& column = first_column_[one.reflector];
      if (column >= 0 || !offset_is_open(setup.reflectors[one.reflector])) continue;
      column = 3 * open_++;
    }
    for (const Reflector& reflector : setup.reflectors) stated_.push_back(reflector.offset);
    std::vector<Vector3d> points;
    for (const SeenReflector& one : seen_) points.push_back(one.measured);
    extent_ = std::max(extent_of_points(points), 1e-9);
  }

  /// The offsets with which most readings agree best; those stated if there is nothing to be found.
  std::vector<Vector3d> found() const {
    const std::size_t n = seen_.size();
    // As many equations as unknowns, and one reading more.
    const std::size_t least = (12 + 3 * static_cast<std::size_t>(open_) + 2) / 3 + 1;
    if (open_ == 0 || n < 4) return stated_;
    std::vector<std::size_t> all(n);
    for (std::size_t k = 0; k < n; ++k) all[k] = k;
    StationAndOffsets best = concentrated(linear_start(all), 3);
    double lowest = score(best);
    std::mt19937_64 generator(1);
    for (std::size_t trial = 0; trial < kSubsets && n > least; ++trial) {
      std::vector<std::size_t> subset = all;
      for (std::size_t i = 0; i < least; ++i) std::swap(subset[i], subset[i + generator() % (n - i)]);
      subset.resize(least);
      StationAndOffsets candidate = linear_start(subset);
      if (!(score(candidate) < kWorthRefining * lowest)) continue;
      candidate = concentrated(std::move(candidate), 2);
      const double value = score(candidate);
      if (!(value < lowest)) continue;
      lowest = value;
      best = std::move(candidate);
    }
    return concentrated(std::move(best), 8).offset;
  }

 private:
  Vector3d apart(const StationAndOffsets& at, const SeenReflector& one) const {
    return at.pose * one.measured - one.body * at.offset[one.reflector];
  }
  std::vector<double> distances_at(const StationAndOffsets& at) const {
    std::vector<double> result;
    for (const SeenReflector& one : seen_) result.push_back(apart(at, one).norm());
    return result;
  }
  static double quantile_of(std::vector<double> values, double fraction) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return std::isfinite(*at) ? *at : std::numeric_limits<double>::infinity();
  }
  double score(const StationAndOffsets& at) const { return quantile_of(distances_at(at), kSubsetQuantile); }

  /// Shortest solution in the scaled unknowns: what the equations do not determine stays zero.
  static Eigen::VectorXd solved(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right) {
    const SymmetricEigen<> modes(normal);
    Eigen::VectorXd along = modes.eigenvectors().transpose() * right;
    const double least = kUndetermined * modes.eigenvalues()[modes.eigenvalues().size() - 1];
    for (Index i = 0; i < along.size(); ++i) {
      along[i] = modes.eigenvalues()[i] > least ? along[i] / modes.eigenvalues()[i] : 0;
    }
    return modes.eigenvectors() * along;
  }

  /// With the nine entries of the rotation free, then made a rotation.
  StationAndOffsets linear_start(const std::vector<std::size_t>& used) const {
    Vector3d centre = Vector3d::Zero();
    for (const std::size_t k : used) centre += seen_[k].measured / static_cast<double>(used.size());
    const Index unknowns = 12 + 3 * open_;
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    Eigen::MatrixXd row = Eigen::MatrixXd::Zero(3, unknowns);
    for (const std::size_t k : used) {
      const SeenReflector& one = seen_[k];
      row.setZero();
      const Vector3d scaled = (one.measured - centre) / extent_;
      for (Index c = 0; c < 3; ++c) row.block<1, 3>(c, 3 * c) = scaled.transpose();
      row.block<3, 3>(0, 9) = Matrix3d::Identity();
      if (const Index column = first_column_[one.reflector]; column >= 0) {
        row.block<3, 3>(0, 12 + column) = -one.body.rotation;
      }
      normal += row.transpose() * row;
      right += row.transpose() * (one.body * stated_[one.reflector]);
    }
    const Eigen::VectorXd x = solved(normal, right);
    Matrix3d entries;
    for (Index c = 0; c < 3; ++c) entries.row(c) = x.segment<3>(3 * c).transpose();
    StationAndOffsets start;
    start.pose.rotation = rotation_from_correlation(entries);
    start.pose.translation = x.segment<3>(9) - start.pose.rotation * centre;
    start.offset = stated_;
    add_to_offsets(x, 12, start);
    return start;
  }

  void add_to_offsets(const Eigen::VectorXd& x, Index first, StationAndOffsets& at) const {
    for (std::size_t r = 0; r < first_column_.size(); ++r) {
      if (first_column_[r] >= 0) at.offset[r] += x.segment<3>(first + first_column_[r]);
    }
  }

  /// Gauss-Newton steps, each with the readings that do not lie far off.
  StationAndOffsets concentrated(StationAndOffsets at, int steps) const {
    const Index unknowns = 6 + 3 * open_;
    Eigen::MatrixXd row = Eigen::MatrixXd::Zero(3, unknowns);
    for (int step = 0; step < steps; ++step) {
      const std::vector<double> apart_mm = distances_at(at);
      const double most = kOutlying * quantile_of(apart_mm, 0.5);
      Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
      Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
      for (std::size_t k = 0; k < seen_.size(); ++k) {
        if (!(apart_mm[k] <= most)) continue;
        const SeenReflector& one = seen_[k];
        const Vector3d turned = at.pose.rotation * one.measured / extent_;
        row.setZero();
        row.block<3, 3>(0, 0) << 0, turned.z(), -turned.y(), -turned.z(), 0, turned.x(), turned.y(), -turned.x(), 0;
        row.block<3, 3>(0, 3) = Matrix3d::Identity();
        if (const Index column = first_column_[one.reflector]; column >= 0) {
          row.block<3, 3>(0, 6 + column) = -one.body.rotation;
        }
        normal += row.transpose() * row;
        right -= row.transpose() * apart(at, one);
      }
      const Eigen::VectorXd x = solved(normal, right);
      at.pose.rotation = rotation_from_vector(x.head<3>() / extent_) * at.pose.rotation;
      at.pose.translation += x.segment<3>(3);
      add_to_offsets(x, 6, at);
    }
    return at;
  }

  std::vector<SeenReflector> seen_;
  std::vector<Index> first_column_;  ///< [reflectors] of the offset among the open ones; -1: it is given
  std::vector<Vector3d> stated_;     ///< [reflectors]
  Index open_ = 0;
  double extent_ = 1;
};

/// How badly a station explains its readings, 0 to 1: mean of min(1, (deviation / far)^2).
double misfit_of(const StationStart& station, const std::vector<SeenReflector>& seen, const TrackerSetup& setup) {
  if (station.status == BestFitStatus::no_consensus) return 1;
  const double far = kFarExtent * station.extent_mm;
  if (seen.empty() || !(far > 0)) return 0;
  double sum = 0;
  for (const SeenReflector& one : seen) {
    const Vector3d apart = station.body_from_tracker * one.measured - one.body * setup.reflectors[one.reflector].offset;
    sum += std::min(1.0, apart.squaredNorm() / (far * far));
  }
  return sum / static_cast<double>(seen.size());
}

/// Readings of a station, evenly chosen.
std::vector<SeenReflector> seen_from(const Machine& machine, const LaserTracker& tracker,
                                     const InstrumentReadings& readings, const TrackerReadings& seen,
                                     std::size_t station) {
  std::vector<std::size_t> own, chosen;
  for (std::size_t k = 0; k < readings.count(); ++k) {
    if (seen.station[k] == station) own.push_back(k);
  }
  const std::size_t taken = std::min(own.size(), kMostOfStation);
  for (std::size_t i = 0; i < taken; ++i) chosen.push_back(own[i * own.size() / taken]);
  const std::vector<RigidTransform> bodies = seen_bodies(machine, ErrorSet{}, tracker, readings.subset(chosen));
  std::vector<SeenReflector> result;
  for (std::size_t i = 0; i < taken; ++i) {
    result.push_back({seen.reflector[chosen[i]], seen.point(chosen[i]), bodies[i]});
  }
  return result;
}

}  // namespace

bool offset_is_open(const Reflector& reflector) {
  return reflector.estimate_offset && reflector.offset_standard_uncertainty.isZero();
}

TrackerStart find_poses_and_offsets(const Machine& machine, const LaserTracker& tracker,
                                    const InstrumentReadings& readings, TrackerSetup& setup) {
  const TrackerReadings seen = tracker.tracker_readings(readings);
  TrackerStart best = find_station_poses(machine, ErrorSet{}, setup, seen);
  if (std::none_of(setup.reflectors.begin(), setup.reflectors.end(), offset_is_open)) return best;
  std::vector<std::vector<SeenReflector>> from;  // [stations]
  for (std::size_t s = 0; s < setup.stations.size(); ++s) {
    from.push_back(seen_from(machine, tracker, readings, seen, s));
  }
  const auto misfit = [&](const TrackerStart& start, const TrackerSetup& with) {
    double sum = 0;
    for (std::size_t s = 0; s < from.size(); ++s) {
      sum += static_cast<double>(start.stations[s].readings) * misfit_of(start.stations[s], from[s], with);
    }
    return sum;
  };
  double least = misfit(best, setup);
  for (std::size_t s = 0; s < setup.stations.size(); ++s) {
    const BestFitStatus status = best.stations[s].status;
    if (status != BestFitStatus::ok && status != BestFitStatus::no_consensus) continue;
    if (misfit_of(best.stations[s], from[s], setup) <= kWellFound) continue;
    TrackerSetup other = setup;
    const std::vector<Vector3d> offsets = OffsetSearch(setup, from[s]).found();
    bool finite = true;
    for (std::size_t r = 0; r < offsets.size(); ++r) {
      finite = finite && offsets[r].allFinite();
      other.reflectors[r].offset = offsets[r];
    }
    if (!finite) continue;
    TrackerStart start = find_station_poses(machine, ErrorSet{}, other, seen);
    const double now = misfit(start, other);
    if (!(now < kMuchBetter * least)) continue;
    least = now;
    best = std::move(start);
    setup = std::move(other);
  }
  return best;
}

}  // namespace abbe
