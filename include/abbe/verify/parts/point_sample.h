#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace abbe {

/// A point of a long scan that is kept.
struct SampledPoint {
  std::uint64_t number = 0;  ///< among the points of the scan, from 0
  Eigen::Vector3d point;     ///< mm
  double deviation_mm = 0;
};

/// A choice of points that depends on their numbers and deviations alone, not on the order or the groups in which they
/// come: those with the smallest hash of their number, which is a random sample without replacement, and those with the
/// least and the largest deviations.
class PointSample {
 public:
  static constexpr std::size_t kDefault = 200000;
  static constexpr std::size_t kExtremes = 100;  ///< of either end

  explicit PointSample(std::size_t most = kDefault) : most_(most) {}

  /// Whether add() might keep it: most points are not, and need not be made.
  bool wants(std::uint64_t number, double deviation_mm) const;
  void add(const SampledPoint& point);
  /// Whether add() of this point, which may have been added already, leaves it here.
  bool keeps(const SampledPoint& point) const;

  /// All that are kept, in the order of their numbers, each once.
  std::vector<SampledPoint> points() const;
  const SampledPoint* least() const;    ///< of several the first; null: there are no points
  const SampledPoint* largest() const;  ///< likewise

 private:
  std::size_t most_;
  std::vector<SampledPoint> sample_, least_, largest_;  ///< heaps; the first to go is in front
};

}  // namespace abbe
