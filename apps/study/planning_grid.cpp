#include <algorithm>
#include <cmath>

#include "study/planning.h"

namespace abbe {
namespace {

constexpr double kMostOfTheNumber = 1.25;
constexpr std::size_t kMostGridsOfTheNumber = 24;
constexpr std::size_t kMostGridReadings = 20000;
constexpr std::size_t kLargestStep = 12;

using Counts = std::vector<std::size_t>;

std::size_t product(const Counts& counts) {
  std::size_t result = 1;
  for (const std::size_t count : counts) result *= count;
  return result;
}

class GridSearch {
 public:
  GridSearch(const PlanningModel& model, const PlanningSpace& space, const Eigen::MatrixXd& predictions,
             StudyPlan& result)
      : model_(model), space_(space), predictions_(predictions), result_(result) {
    const std::vector<AxisRange>& axes = model.study().planning->axes;
    least_.assign(axes.size(), 1);
    // With fewer positions of an axis than its basis has functions, some combination of them is zero at all of them.
    for (const ErrorMotion& motion : model.errors().motions)
      if (!axes[motion.axis].is_fixed())
        least_[motion.axis] = std::max(least_[motion.axis], motion.coefficients.size());
    for (std::size_t i = 0; i < axes.size(); ++i)
      if (!axes[i].is_fixed()) least_[i] = std::max<std::size_t>(least_[i], 2);
    const double all = static_cast<double>(result.candidates + result.hidden);
    visible_ = all > 0 ? static_cast<double>(result.candidates) / all : 1;
  }

  void run() {
    const std::size_t wanted = result_.readings.size();
    for (const SightsPerPose sights : {SightsPerPose::every, SightsPerPose::cycle}) {
      const double per_pose =
          visible_ * (sights == SightsPerPose::every ? static_cast<double>(model_.sight_count()) : 1);
      found_.clear();
      collect(Counts{}, static_cast<double>(wanted) / per_pose,
              kMostOfTheNumber * 1.1 * static_cast<double>(wanted) / per_pose);
      std::stable_sort(found_.begin(), found_.end(),
                       [](const Counts& a, const Counts& b) { return product(a) < product(b); });
      if (found_.size() > kMostGridsOfTheNumber) found_.resize(kMostGridsOfTheNumber);
      for (const Counts& counts : found_) {
        const GridPoint grid = evaluate(counts, sights);
        if (!grid.value.determined || grid.value.readings < wanted ||
            static_cast<double>(grid.value.readings) > kMostOfTheNumber * static_cast<double>(wanted))
          continue;
        if (!result_.same_grid || grid.value.uncertainty < result_.same_grid->value.uncertainty)
          result_.same_grid = grid;
      }
    }
    for (const SightsPerPose sights : {SightsPerPose::every, SightsPerPose::cycle}) find_equal(sights);
    if (result_.equal_grid) result_.largest_grid.reset();
  }

 private:
  /// All counts, none below the least, with a product between the limits.
  void collect(Counts counts, double lower, double upper) {
    const std::size_t axis = counts.size();
    if (axis == least_.size()) {
      const double poses = static_cast<double>(product(counts));
      if (poses >= lower && poses <= upper) found_.push_back(counts);
      return;
    }
    std::size_t rest = 1;
    for (std::size_t i = axis + 1; i < least_.size(); ++i) rest *= least_[i];
    const std::size_t before = product(counts);
    const bool fixed = least_[axis] == 1;
    counts.push_back(least_[axis]);
    for (; static_cast<double>(before * counts.back() * rest) <= upper; ++counts.back()) {
      collect(counts, lower, upper);
      if (fixed) break;
    }
  }

  GridPoint evaluate(const Counts& counts, SightsPerPose sights) {
    ++result_.grids_tried;
    std::vector<AxisRange> ranges = model_.study().planning->axes;
    for (std::size_t i = 0; i < ranges.size(); ++i) ranges[i].count = counts[i];
    const PlanningModel::Candidates grid = model_.readings_at(grid_plan(model_.study().machine, ranges), sights);
    const PlanValue value = value_of(space_, grid.rows, predictions_);
    GridPoint point{counts, sights, {}};
    point.value.readings = grid.readings.size();
    point.value.determined = value.determined;
    point.value.uncertainty = std::sqrt(value.variance / (static_cast<double>(predictions_.rows()) / 3));
    return point;
  }

  bool good(const GridPoint& grid) const {
    return grid.value.determined && grid.value.uncertainty <= result_.uncertainty;
  }

  void find_equal(SightsPerPose sights) {
    const double per_pose = sights == SightsPerPose::every ? static_cast<double>(model_.sight_count()) : 1;
    for (std::size_t step = 0; step < kLargestStep; ++step) {
      Counts counts = least_;
      for (std::size_t& count : counts) count += count > 1 ? step : 0;
      const double readings = static_cast<double>(product(counts)) * per_pose * visible_;
      const double most = result_.equal_grid ? static_cast<double>(result_.equal_grid->value.readings) * 2
                                             : static_cast<double>(kMostGridReadings);
      if (readings > most) return;
      GridPoint grid = evaluate(counts, sights);
      if (!good(grid)) {
        if (grid.value.determined &&
            (!result_.largest_grid || grid.value.readings > result_.largest_grid->value.readings))
          result_.largest_grid = grid;
        continue;
      }
      // Fewer positions of one axis after the other, as long as it stays as good.
      for (bool smaller = true; smaller;) {
        smaller = false;
        for (std::size_t i = 0; i < counts.size(); ++i) {
          if (counts[i] <= least_[i]) continue;
          --counts[i];
          const GridPoint less = evaluate(counts, sights);
          if (good(less)) {
            grid = less;
            smaller = true;
          } else {
            ++counts[i];
          }
        }
      }
      if (!result_.equal_grid || grid.value.readings < result_.equal_grid->value.readings) result_.equal_grid = grid;
      return;
    }
  }

  const PlanningModel& model_;
  const PlanningSpace& space_;
  const Eigen::MatrixXd& predictions_;
  StudyPlan& result_;
  Counts least_;
  double visible_ = 1;
  std::vector<Counts> found_;
};

}  // namespace

void compare_with_grids(const PlanningModel& model, const PlanningSpace& space, const Eigen::MatrixXd& predictions,
                        StudyPlan& result) {
  GridSearch(model, space, predictions, result).run();
}

}  // namespace abbe
