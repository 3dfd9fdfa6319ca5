#include "abbe/identify/trust/outlier_clusters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "abbe/geometry/angle_units.h"
#include "abbe/identify/distributions.h"

namespace abbe {
namespace {

constexpr std::size_t kMostClasses = 24;
constexpr double kClusterByChance = 1e-6;
constexpr double kLeastRegion = 0.05;    // of all readings
constexpr double kLeastLeftOut = 0.5;    // of the readings of a region
constexpr std::size_t kFewestPoses = 5;  // in a part: fewer say nothing about it

/// Readings, or poses, of which some are marked.
struct MarkedCount {
  std::size_t all = 0, marked = 0;
  void add(bool is_marked) {
    ++all;
    marked += is_marked ? 1U : 0U;
  }
  MarkedCount& operator+=(const MarkedCount& other) {
    all += other.all;
    marked += other.marked;
    return *this;
  }
};

/// One used reading.
struct UsedReading {
  std::size_t observations = 0, reading = 0, pose = 0;  ///< pose: which run of readings at the same pose
  bool outlier = false;
};

/// What is counted in one class of a quantity.
struct ClassCount {
  MarkedCount readings, poses;
  double from = 0, to = 0;  ///< smallest and largest value in it
};

class ClusterSearch {
 public:
  ClusterSearch(const Problem& problem, const std::vector<Outlier>& outliers, const std::vector<ReadingFacts>& facts)
      : problem_(problem), facts_(facts) {
    std::vector<std::vector<bool>> marked;
    for (const SelectedObservations& selected : problem.observations)
      marked.emplace_back(selected.observations->reading_count(), false);
    for (const Outlier& outlier : outliers) marked[outlier.observations][outlier.reading] = true;
    std::size_t pose = 0;
    for (std::size_t o = 0; o < problem.observations.size(); ++o) {
      const SelectedObservations& selected = problem.observations[o];
      std::vector<double> previous;
      for (std::size_t k = 0; k < selected.observations->reading_count(); ++k) {
        if (!selected.use.empty() && selected.use[k] == 0) continue;
        std::vector<double> positions = selected.observations->positions(k);
        if (positions != previous) {
          ++pose;
          pose_positions_.push_back(positions);
          pose_marked_.push_back(false);
        }
        previous = std::move(positions);
        used_.push_back({o, k, pose - 1, marked[o][k]});
        if (marked[o][k]) pose_marked_.back() = true;
        all_.add(marked[o][k]);
      }
    }
  }

  std::vector<OutlierCluster> run() {
    if (all_.marked == 0 || all_.marked == all_.all) return {};
    for (std::size_t axis = 0; axis < problem_.machine.axes.size(); ++axis) look_along_axis(axis);
    for (std::size_t o = 0; o < facts_.size(); ++o) {
      look_along_time(o);
      for (std::size_t l = 0; l < facts_[o].labels.size(); ++l) look_at_label(o, facts_[o].labels[l]);
    }
    look_at_setups();
    std::vector<OutlierCluster> clusters;
    for (OutlierCluster& best : best_) {
      best.probability = std::min(1.0, best.probability * static_cast<double>(parts_));
      if (best.probability < kClusterByChance) clusters.push_back(std::move(best));
    }
    std::stable_sort(clusters.begin(), clusters.end(),
                     [](const OutlierCluster& a, const OutlierCluster& b) { return a.probability < b.probability; });
    return clusters;
  }

 private:
  /// Classes of a quantity with about as many poses each, in its order; equal values stay together.
  /// @param of  the values of used readings, all of the same pose alike; NaN: not looked at
  std::vector<ClassCount> classes_of(const std::function<double(const UsedReading&)>& of) const {
    std::vector<std::pair<double, std::size_t>> poses;  // value, pose
    std::vector<MarkedCount> readings(pose_positions_.size());
    std::vector<bool> seen(pose_positions_.size(), false);
    for (const UsedReading& used : used_) {
      const double value = of(used);
      if (std::isnan(value)) continue;
      readings[used.pose].add(used.outlier);
      if (!seen[used.pose]) poses.emplace_back(value, used.pose);
      seen[used.pose] = true;
    }
    std::sort(poses.begin(), poses.end());
    std::vector<ClassCount> classes;
    const double per_class = static_cast<double>(poses.size()) / static_cast<double>(kMostClasses);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const auto& [value, pose] = poses[i];
      const bool new_value = i == 0 || value > poses[i - 1].first;
      const bool full = classes.empty() || static_cast<double>(i) >= per_class * static_cast<double>(classes.size());
      if (new_value && full) classes.push_back({{}, {}, value, value});
      ClassCount& last = classes.back();
      last.to = value;
      last.readings += readings[pose];
      last.poses.add(pose_marked_[pose]);
    }
    return classes;
  }

  /// The most significant range of whole classes.
  void look_along(const std::vector<ClassCount>& classes, const std::function<std::string(double, double)>& words) {
    MarkedCount poses;
    for (const ClassCount& one : classes) poses += one.poses;
    OutlierCluster best;
    for (std::size_t first = 0; first < classes.size(); ++first) {
      MarkedCount readings_in, poses_in;
      for (std::size_t last = first; last < classes.size(); ++last) {
        readings_in += classes[last].readings;
        poses_in += classes[last].poses;
        if (poses_in.all == poses.all || poses_in.all < kFewestPoses) continue;
        ++parts_;
        const double chance = hypergeometric_exceedance(poses.all, poses.marked, poses_in.all, poses_in.marked);
        if (chance < best.probability)
          best = cluster(words(classes[first].from, classes[last].to), readings_in, chance);
      }
    }
    if (best.probability < 1) best_.push_back(best);
  }

  OutlierCluster cluster(std::string where, const MarkedCount& in, double chance) const {
    return {std::move(where), in.all, in.marked, all_.all - in.all, all_.marked - in.marked, chance};
  }

  void look_along_axis(std::size_t axis) {
    const Axis& of = problem_.machine.axes[axis];
    const bool rotary = of.kind == AxisKind::rotary;
    const double unit = rotary ? 1 / kDegree : 1;
    look_along(classes_of([&](const UsedReading& used) { return pose_positions_[used.pose][axis]; }), [&](double from,
                                                                                                          double to) {
      return fmt::format("with {} from {:.6g} to {:.6g} {}", of.name, from * unit, to * unit, rotary ? "deg" : "mm");
    });
  }

  void look_along_time(std::size_t o) {
    // Without times the order of the data is that of time.
    const std::vector<double>& times = facts_[o].time_s;
    look_along(classes_of([&](const UsedReading& used) {
                 if (used.observations != o) return std::nan("");
                 return times.empty() ? static_cast<double>(used.pose) : times[used.reading];
               }),
               [&](double from, double to) {
                 return times.empty() ? fmt::format("of set-up {} in rows {} to {} of its readings", facts_[o].setup,
                                                    first_reading(from) + 1, last_reading(to) + 1)
                                      : fmt::format("of set-up {} from {:.6g} to {:.6g} s", facts_[o].setup, from, to);
               });
  }

  std::size_t first_reading(double pose) const {
    return std::find_if(used_.begin(), used_.end(),
                        [&](const UsedReading& used) { return used.pose == static_cast<std::size_t>(pose); })
        ->reading;
  }
  std::size_t last_reading(double pose) const {
    return std::find_if(used_.rbegin(), used_.rend(),
                        [&](const UsedReading& used) { return used.pose == static_cast<std::size_t>(pose); })
        ->reading;
  }

  void look_at(const std::vector<MarkedCount>& of_name, const std::function<std::string(std::size_t)>& words) {
    MarkedCount all;
    for (const MarkedCount& one : of_name) all += one;
    OutlierCluster best;
    for (std::size_t i = 0; i < of_name.size(); ++i) {
      if (of_name[i].all == 0 || of_name[i].all == all.all) continue;
      ++parts_;
      const double chance = hypergeometric_exceedance(all.all, all.marked, of_name[i].all, of_name[i].marked);
      if (chance < best.probability) best = cluster(words(i), of_name[i], chance);
    }
    if (best.probability < 1) best_.push_back(best);
  }

  void look_at_label(std::size_t o, const ReadingLabel& label) {
    std::vector<MarkedCount> of_name(label.names.size());
    for (const UsedReading& used : used_)
      if (used.observations == o) of_name[label.of_reading[used.reading]].add(used.outlier);
    look_at(of_name, [&](std::size_t i) {
      return fmt::format("of {} {} of set-up {}", label.kind, label.names[i], facts_[o].setup);
    });
  }

  void look_at_setups() {
    std::vector<MarkedCount> of_setup(facts_.size());
    for (const UsedReading& used : used_) of_setup[used.observations].add(used.outlier);
    look_at(of_setup, [&](std::size_t i) { return "of set-up " + facts_[i].setup; });
  }

  const Problem& problem_;
  const std::vector<ReadingFacts>& facts_;
  std::vector<UsedReading> used_;
  std::vector<std::vector<double>> pose_positions_;
  std::vector<bool> pose_marked_;
  MarkedCount all_;
  std::size_t parts_ = 0;
  std::vector<OutlierCluster> best_;
};

}  // namespace

bool OutlierCluster::is_region_left_out() const {
  const double in = static_cast<double>(readings);
  return in >= kLeastRegion * (in + static_cast<double>(readings_elsewhere)) &&
         static_cast<double>(outliers) >= kLeastLeftOut * in;
}

std::vector<OutlierCluster> outlier_clusters(const Problem& problem, const std::vector<Outlier>& outliers,
                                             const std::vector<ReadingFacts>& facts) {
  return ClusterSearch(problem, outliers, facts).run();
}

std::string cluster_text(const OutlierCluster& cluster) {
  return fmt::format("{} of the {} readings {} are outliers, {} of the {} others", cluster.outliers, cluster.readings,
                     cluster.where, cluster.outliers_elsewhere, cluster.readings_elsewhere);
}

}  // namespace abbe
