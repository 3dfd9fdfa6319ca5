#include "abbe/geometry/registration/pair_search.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <span>

#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kAngleBin = 0.2618;  ///< 15 degrees
constexpr double kDistanceBins = 24;  ///< over the diameter
constexpr std::size_t kPairsDrawn = 6000;
/// Lengths up to two diameters, three angles.
constexpr std::size_t kKeys = (2 * static_cast<std::size_t>(kDistanceBins) + 1) * 512;
constexpr std::uint32_t kNoKey = 0xffffffff;
constexpr std::size_t kFirstMatches = 2048;  ///< of the pairs that are tried together
constexpr std::size_t kBlocks = 32;          ///< of these pairs

/// Bin of an angle of at most 90 degrees; the sign of the cosine does not count.
std::uint32_t angle_bin(double cosine) {
  static const std::array<double, 5> limits{std::cos(kAngleBin), std::cos(2 * kAngleBin), std::cos(3 * kAngleBin),
                                            std::cos(4 * kAngleBin), std::cos(5 * kAngleBin)};
  const double amount = std::min(1.0, std::abs(cosine));
  std::uint32_t bin = 0;
  bool near = false;
  for (const double limit : limits) {
    bin += amount < limit ? 1U : 0U;
    near |= std::abs(amount - limit) < 1e-9;
  }
  // At a limit its rounding would decide.
  return near ? static_cast<std::uint32_t>(std::acos(amount) / kAngleBin) : bin;
}

/// What two points with normals look like from any side.
struct PairFeature {
  double distance = 0;
  double first = 0, second = 0, between = 0;  ///< cosines: normals to the line, normal to normal

  PairFeature(const Vector3d& p, const Vector3d& n, const Vector3d& q, const Vector3d& m) {
    const Vector3d line = q - p;
    distance = line.norm();
    if (!(distance > 0)) return;
    first = n.dot(line) / distance;
    second = m.dot(line) / distance;
    between = n.dot(m);
  }
  /// Does not depend on the signs of the normals.
  std::uint32_t key(double diameter) const {
    const std::uint32_t length = static_cast<std::uint32_t>(std::min(distance / diameter, 2.0) * kDistanceBins);
    return ((length * 8 + angle_bin(first)) * 8 + angle_bin(second)) * 8 + angle_bin(between);
  }
  PairFeature reversed() const {
    PairFeature other = *this;
    other.first = -second;
    other.second = -first;
    return other;
  }
  /// Of the reversed pair.
  static std::uint32_t reversed_key(std::uint32_t key) {
    return (key & ~0x1f8u) | (key >> 3 & 0x38u) | (key << 3 & 0x1c0u);
  }
  bool resembles(const PairFeature& other, double diameter) const {
    return std::abs(distance - other.distance) < 0.03 * diameter && std::abs(first - other.first) < 0.2 &&
           std::abs(second - other.second) < 0.2 && std::abs(between - other.between) < 0.2;
  }
  bool fixes_a_pose(double diameter) const { return distance > 0.15 * diameter && std::abs(first) < 0.96; }
};

struct PartPair {
  std::uint32_t key = 0, from = 0, to = 0;
  bool operator<(const PartPair& other) const {
    return key != other.key ? key < other.key : (from != other.from ? from < other.from : to < other.to);
  }
};

/// Axes along the line and, across it, along the first normal.
Matrix3d axes_of(const Vector3d& line, const Vector3d& normal) {
  Matrix3d axes;
  axes.col(0) = line.normalized();
  axes.col(1) = (normal - normal.dot(axes.col(0)) * axes.col(0)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

/// Two points of the scan.
struct Drawn {
  std::size_t matches = 0;  ///< pairs of the part, about
  Eigen::Index from = 0, to = 0;
};

/// Poses of a pair, and those worth adding: the pose, its score, and the least kept score above which it was given up.
struct Tried {
  static constexpr std::size_t kNumbers = 14;

  std::size_t poses = 0;
  std::vector<double> kept;

  void keep(const RigidTransform& pose, const PoseCandidates::Score& score) {
    kept.insert(kept.end(), pose.rotation.data(), pose.rotation.data() + 9);
    kept.insert(kept.end(), pose.translation.data(), pose.translation.data() + 3);
    kept.insert(kept.end(), {score.score, score.given_up_above});
  }
  void add_to(PoseCandidates& best) const {
    for (const double* at = kept.data(); at < kept.data() + kept.size(); at += kNumbers) {
      best.add({Eigen::Map<const Matrix3d>(at), Eigen::Map<const Vector3d>(at + 9)}, {at[12], at[13]});
    }
  }

  void pack(std::vector<std::byte>& bytes) const {
    const std::array<double, 2> counts{static_cast<double>(poses), static_cast<double>(kept.size())};
    pack_numbers(counts, bytes);
    pack_numbers(kept, bytes);
  }
  void unpack(std::span<const std::byte>& bytes) {
    std::array<double, 2> counts{};
    unpack_numbers(bytes, counts);
    if (!(counts[1] >= 0 && counts[1] <= kNumbers * counts[0])) {
      throw WorkError("a pair of points keeps more poses than it has");
    }
    poses = static_cast<std::size_t>(counts[0]);
    kept.resize(static_cast<std::size_t>(counts[1]));
    unpack_numbers(bytes, kept);
  }
};

class PairSearch {
 public:
  PairSearch(const PointCloud& part, const ThinnedScan& scan, const DistanceGrid& grid,
             const PairSearchOptions& options)
      : part_(part),
        scan_(scan),
        options_(options),
        generator_(options.seed),
        diameter_((part.points.rowwise().maxCoeff() - part.points.rowwise().minCoeff()).norm()),
        best_(grid, scan.points, options.reach_mm, diameter_, options.candidates, generator_) {
    pairs_ = pairs_of_part();
  }

  std::vector<PoseCandidate> run() {
    draw();
    std::size_t tried = 0, next = 0;
    // Until enough are kept, every pose is scored to the end, and twice if it were shared.
    for (; next < drawn_.size() && tried < options_.poses && !best_.is_full(); ++next) {
      for_poses(drawn_[next], [&](const RigidTransform& pose) {
        best_.add(pose);
        ++tried;
      });
    }
    // What is kept depends on what was found before. So some are tried at a time, at first few.
    for (std::size_t matches = kFirstMatches; next < drawn_.size() && tried < options_.poses; matches *= 2) {
      const std::size_t first = next;
      for (std::size_t sum = 0; next < drawn_.size() && sum < matches; ++next) sum += drawn_[next].matches;
      const std::vector<Tried> found = try_pairs(first, next - first);
      for (std::size_t k = 0; k < found.size() && tried < options_.poses; ++k) {
        found[k].add_to(best_);
        tried += found[k].poses;
      }
    }
    return best_.sorted();
  }

 private:
  using Iterator = std::vector<PartPair>::const_iterator;

  /// Pairs of the part that fix a pose, by their keys and then by their points.
  std::vector<PartPair> pairs_of_part() const {
    const Eigen::Index points = part_.size();
    // From the other side a pair has the same angles in another order.
    std::vector<std::uint32_t> keys(static_cast<std::size_t>(points * points), kNoKey);
    const auto key_at = [&](Eigen::Index i, Eigen::Index j) -> std::uint32_t& {
      return keys[static_cast<std::size_t>(i * points + j)];
    };
    for (Eigen::Index i = 0; i < points; ++i) {
      for (Eigen::Index j = i + 1; j < points; ++j) {
        const PairFeature one = part_feature(i, j), other = one.reversed();
        const bool first = one.fixes_a_pose(diameter_), second = other.fixes_a_pose(diameter_);
        if (!first && !second) continue;
        const std::uint32_t key = one.key(diameter_);
        if (first) key_at(i, j) = key;
        if (second) key_at(j, i) = PairFeature::reversed_key(key);
      }
    }
    std::vector<std::uint32_t> begin(kKeys + 1);
    for (const std::uint32_t key : keys) {
      if (key != kNoKey) ++begin[key + 1];
    }
    for (std::size_t key = 1; key <= kKeys; ++key) begin[key] += begin[key - 1];
    std::vector<PartPair> pairs(begin[kKeys]);
    for (Eigen::Index i = 0; i < points; ++i) {
      for (Eigen::Index j = 0; j < points; ++j) {
        const std::uint32_t key = key_at(i, j);
        if (key == kNoKey) continue;
        pairs[begin[key]++] = {key, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)};
      }
    }
    return pairs;
  }

  PairFeature part_feature(Eigen::Index i, Eigen::Index j) const {
    return {part_.points.col(i), part_.normals.col(i), part_.points.col(j), part_.normals.col(j)};
  }
  PairFeature scan_feature(Eigen::Index i, Eigen::Index j, double sign_i, double sign_j) const {
    return {scan_.points.col(i), sign_i * scan_.normals.col(i), scan_.points.col(j), sign_j * scan_.normals.col(j)};
  }
  std::pair<Iterator, Iterator> matches(const PairFeature& feature) const {
    const std::uint32_t key = feature.key(diameter_);
    return {std::lower_bound(pairs_.begin(), pairs_.end(), PartPair{key, 0, 0}),
            std::lower_bound(pairs_.begin(), pairs_.end(), PartPair{key + 1, 0, 0})};
  }

  void draw() {
    const std::uint64_t points = static_cast<std::uint64_t>(scan_.points.cols());
    for (std::size_t k = 0; k < kPairsDrawn; ++k) {
      const Eigen::Index i = static_cast<Eigen::Index>(generator_() % points);
      const Eigen::Index j = static_cast<Eigen::Index>(generator_() % points);
      const PairFeature feature = scan_feature(i, j, 1, 1);
      if (i == j || !feature.fixes_a_pose(diameter_)) continue;
      const auto [first, last] = matches(feature);
      if (first != last) drawn_.push_back({static_cast<std::size_t>(last - first), i, j});
    }
    std::stable_sort(drawn_.begin(), drawn_.end(),
                     [](const Drawn& a, const Drawn& b) { return a.matches < b.matches; });
  }

  /// Scores the poses of some pairs, which are shared as the options say.
  std::vector<Tried> try_pairs(std::size_t first, std::size_t count) {
    std::vector<Tried> found(count);
    const std::size_t together = count / kBlocks + 1;
    NumberedWork work{
        .name = "search for the start", .blocks = (count + together - 1) / together, .threads = options_.threads};
    work.for_all = true;
    work.is_kept = false;
    const auto tried_of = [&](std::size_t block) {
      return std::span(found).subspan(block * together, std::min(together, count - block * together));
    };
    work.fingerprint = [&] { return fingerprint(first, count); };
    work.compute = [&](std::size_t block) {
      const std::span<Tried> own = tried_of(block);
      for (std::size_t k = 0; k < own.size(); ++k) own[k] = try_pair(drawn_[first + block * together + k]);
    };
    work.pack = [&](std::size_t block, std::vector<std::byte>& bytes) {
      for (const Tried& tried : tried_of(block)) tried.pack(bytes);
    };
    work.unpack = [&](std::size_t block, std::span<const std::byte> bytes) {
      for (Tried& tried : tried_of(block)) tried.unpack(bytes);
      require_unpacked(bytes);
    };
    do_work(options_.work, work);
    return found;
  }

  std::uint64_t fingerprint(std::size_t first, std::size_t count) const {
    Digest digest;
    digest.add_text("pairs of points");
    digest.add_text(vector_instructions());
    for (const Eigen::Matrix3Xd* some : {&part_.points, &part_.normals, &scan_.points, &scan_.normals}) {
      digest.add_numbers({some->data(), static_cast<std::size_t>(some->size())});
    }
    for (const std::uint64_t number : {options_.seed, std::uint64_t{first}, std::uint64_t{count}}) digest.add(number);
    digest.add_number(options_.reach_mm);
    return digest.value();
  }

  Tried try_pair(const Drawn& pair) const {
    Tried result;
    for_poses(pair, [&](const RigidTransform& pose) {
      if (const auto found = best_.score_worth_adding(pose)) result.keep(pose, *found);
      ++result.poses;
    });
    return result;
  }

  /// Calls visit(pose) for the poses that a pair fixes.
  template <typename Visit>
  void for_poses(const Drawn& pair, const Visit& visit) const {
    const Eigen::Index from = pair.from, to = pair.to;
    for (const double sign_from : {1.0, -1.0}) {
      for (const double sign_to : {1.0, -1.0}) {
        if (scan_.outwards && (sign_from < 0 || sign_to < 0)) continue;
        const PairFeature feature = scan_feature(from, to, sign_from, sign_to);
        const Vector3d p = scan_.points.col(from), q = scan_.points.col(to);
        const Matrix3d scan_axes = axes_of(q - p, sign_from * scan_.normals.col(from));
        const auto [first, last] = matches(feature);
        for (auto at = first; at != last; ++at) {
          const Eigen::Index i = at->from, j = at->to;
          if (!feature.resembles(part_feature(i, j), diameter_)) continue;
          const Vector3d a = part_.points.col(i), b = part_.points.col(j);
          RigidTransform pose;
          pose.rotation = axes_of(b - a, part_.normals.col(i)) * scan_axes.transpose();
          pose.translation = 0.5 * (a + b) - pose.rotation * (0.5 * (p + q));
          visit(pose);
        }
      }
    }
  }

  const PointCloud& part_;
  const ThinnedScan& scan_;
  PairSearchOptions options_;
  std::mt19937_64 generator_;
  double diameter_ = 0;
  PoseCandidates best_;
  std::vector<PartPair> pairs_;
  std::vector<Drawn> drawn_;  // those that few pairs of the part resemble first
};

}  // namespace

std::vector<PoseCandidate> search_poses(const PointCloud& part, const ThinnedScan& scan, const DistanceGrid& grid,
                                        const PairSearchOptions& options) {
  if (part.size() < 3 || scan.points.cols() < 3) return {};
  return PairSearch(part, scan, grid, options).run();
}

}  // namespace abbe
