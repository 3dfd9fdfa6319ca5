#include "abbe/identify/trust/outlier_clusters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "abbe/geometry/angle_units.h"
#include "abbe/identify/distributions.h"

namespace abbe {
namespace {

constexpr std::size_t kMostClasses = 24;
constexpr std::size_t kMostSorted = 65536;  // poses: their classes are as good as those of more
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

/// Used readings that follow each other at the same pose.
struct UsedPose {
  std::size_t observations = 0, first = 0, last = 0;  ///< readings first .. last; unused ones may be among them
  MarkedCount readings;
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
    for (const SelectedObservations& selected : problem.observations)
      marked_.emplace_back(selected.observations->reading_count(), false);
    for (const Outlier& outlier : outliers) marked_[outlier.observations][outlier.reading] = true;
    for (std::size_t o = 0; o < problem.observations.size(); ++o) {
      std::vector<double> previous;
      for_each_used(o, [&](std::size_t k) {
        std::vector<double> positions = problem.observations[o].observations->positions(k);
        if (positions != previous) {
          poses_.push_back({o, k, k, {}});
          positions_.insert(positions_.end(), positions.begin(), positions.end());
        }
        previous = std::move(positions);
        poses_.back().last = k;
        poses_.back().readings.add(marked_[o][k]);
        all_.add(marked_[o][k]);
      });
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
      best.log_probability = std::min(0.0, best.log_probability + std::log(static_cast<double>(parts_)));
      if (best.probability() < kClusterByChance) clusters.push_back(std::move(best));
    }
    std::stable_sort(clusters.begin(), clusters.end(), [](const OutlierCluster& a, const OutlierCluster& b) {
      return a.log_probability < b.log_probability;
    });
    return clusters;
  }

 private:
  template <class Work>
  void for_each_used(std::size_t o, const Work& work) const {
    const std::vector<std::uint8_t>& use = problem_.observations[o].use;
    for (std::size_t k = 0; k < marked_[o].size(); ++k)
      if (use.empty() || use[k] != 0) work(k);
  }

  /// Smallest values of classes with about as many poses each; equal values stay together.
  /// @param values  [poses], NaN: not looked at. Of more than kMostSorted, a sample is sorted. It is spread by the
  ///                golden ratio, so that it cannot fall into step with a regular order of the readings
  static std::vector<double> starts_of_classes(const std::vector<double>& values) {
    std::vector<double> sorted;
    const std::size_t count = std::min(values.size(), kMostSorted);
    for (std::size_t i = 0; i < count; ++i) {
      const double turns = static_cast<double>(i) * std::numbers::phi;
      const double place = (turns - std::floor(turns)) * static_cast<double>(values.size());
      const double value = values[count == values.size() ? i : static_cast<std::size_t>(place)];
      if (!std::isnan(value)) sorted.push_back(value);
    }
    std::sort(sorted.begin(), sorted.end());
    std::vector<double> starts;
    const double per_class = static_cast<double>(sorted.size()) / static_cast<double>(kMostClasses);
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      const bool new_value = i == 0 || sorted[i] > sorted[i - 1];
      if (new_value && static_cast<double>(i) >= per_class * static_cast<double>(starts.size()))
        starts.push_back(sorted[i]);
    }
    return starts;
  }

  /// Classes of a quantity in its order.
  /// @param of  the value of a pose by its number; NaN: not looked at
  template <class Value>
  std::vector<ClassCount> classes_of(const Value& of) const {
    std::vector<double> values(poses_.size());
    for (std::size_t i = 0; i < poses_.size(); ++i) values[i] = of(i);
    const std::vector<double> starts = starts_of_classes(values);
    if (starts.empty()) return {};
    std::vector<ClassCount> classes(starts.size());
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const double value = values[i];
      if (std::isnan(value)) continue;
      // A value below the first start was not in the sample.
      const auto after = std::upper_bound(starts.begin() + 1, starts.end(), value);
      ClassCount& in = classes[static_cast<std::size_t>(after - starts.begin()) - 1];
      in.from = in.poses.all == 0 ? value : std::min(in.from, value);
      in.to = in.poses.all == 0 ? value : std::max(in.to, value);
      in.readings += poses_[i].readings;
      in.poses.add(poses_[i].readings.marked > 0);
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
        const double chance = log_hypergeometric_exceedance(poses.all, poses.marked, poses_in.all, poses_in.marked);
        if (chance < best.log_probability)
          best = cluster(words(classes[first].from, classes[last].to), readings_in, chance);
      }
    }
    if (best.log_probability < 0) best_.push_back(best);
  }

  OutlierCluster cluster(std::string where, const MarkedCount& in, double log_chance) const {
    return {std::move(where), in.all, in.marked, all_.all - in.all, all_.marked - in.marked, log_chance};
  }

  void look_along_axis(std::size_t axis) {
    const Axis& of = problem_.machine.axes[axis];
    const bool rotary = of.kind == AxisKind::rotary;
    const double unit = rotary ? 1 / kDegree : 1;
    const std::size_t axes = problem_.machine.axes.size();
    look_along(classes_of([&](std::size_t pose) { return positions_[pose * axes + axis]; }), [&](double from,
                                                                                                 double to) {
      return fmt::format("with {} from {:.6g} to {:.6g} {}", of.name, from * unit, to * unit, rotary ? "deg" : "mm");
    });
  }

  void look_along_time(std::size_t o) {
    // Without times the order of the data is that of time.
    const std::vector<double>& times = facts_[o].time_s;
    look_along(classes_of([&](std::size_t pose) {
                 if (poses_[pose].observations != o) return std::nan("");
                 return times.empty() ? static_cast<double>(pose) : times[poses_[pose].first];
               }),
               [&](double from, double to) {
                 if (!times.empty())
                   return fmt::format("of set-up {} from {:.6g} to {:.6g} s", facts_[o].setup, from, to);
                 return fmt::format("of set-up {} in rows {} to {} of its readings", facts_[o].setup,
                                    poses_[static_cast<std::size_t>(from)].first + 1,
                                    poses_[static_cast<std::size_t>(to)].last + 1);
               });
  }

  void look_at(const std::vector<MarkedCount>& of_name, const std::function<std::string(std::size_t)>& words) {
    MarkedCount all;
    for (const MarkedCount& one : of_name) all += one;
    OutlierCluster best;
    for (std::size_t i = 0; i < of_name.size(); ++i) {
      if (of_name[i].all == 0 || of_name[i].all == all.all) continue;
      ++parts_;
      const double chance = log_hypergeometric_exceedance(all.all, all.marked, of_name[i].all, of_name[i].marked);
      if (chance < best.log_probability) best = cluster(words(i), of_name[i], chance);
    }
    if (best.log_probability < 0) best_.push_back(best);
  }

  void look_at_label(std::size_t o, const ReadingLabel& label) {
    std::vector<MarkedCount> of_name(label.names.size());
    for_each_used(o, [&](std::size_t k) { of_name[label.of_reading[k]].add(marked_[o][k]); });
    look_at(of_name, [&](std::size_t i) {
      return fmt::format("of {} {} of set-up {}", label.kind, label.names[i], facts_[o].setup);
    });
  }

  void look_at_setups() {
    std::vector<MarkedCount> of_setup(facts_.size());
    for (const UsedPose& pose : poses_) of_setup[pose.observations] += pose.readings;
    look_at(of_setup, [&](std::size_t i) { return "of set-up " + facts_[i].setup; });
  }

  const Problem& problem_;
  const std::vector<ReadingFacts>& facts_;
  std::vector<std::vector<bool>> marked_;  // [observations][readings]
  std::vector<UsedPose> poses_;
  std::vector<double> positions_;  // [poses][axes]
  MarkedCount all_;
  std::size_t parts_ = 0;
  std::vector<OutlierCluster> best_;
};

}  // namespace

double OutlierCluster::probability() const { return std::exp(log_probability); }

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
