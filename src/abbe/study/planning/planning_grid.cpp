#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"
#include "abbe/study/planning/planning.h"
#include "abbe/study/planning/planning_drift.h"
#include "abbe/study/planning/planning_schedule.h"
#include "abbe/study/results_of_items.h"

namespace abbe {
namespace {

using Counts = std::vector<std::size_t>;
// A grid may have up to this many times the readings it is compared with, never fewer.
constexpr double kMostOfTheNumber = 1.2;
// Of each family, for one number.
constexpr std::size_t kMostGrids = 40;
// So many of the best are looked at whether they determine everything.
constexpr std::size_t kLookedAt = 12;
constexpr std::size_t kMostPerAxis = 12;
constexpr double kLargerNumbers[] = {2.5, 3, 4};

/// Poses in a regular order, and which sight is used at each.
struct Grid {
  std::string words;
  PoseList poses;
  std::vector<std::size_t> sight;  // empty: every one
};

std::size_t product(const Counts& counts) {
  std::size_t result = 1;
  for (const std::size_t count : counts) result *= count;
  return result;
}

/// Every so many of a list, so that no more than `most` are left.
template <typename T>
void thin(std::vector<T>& list, std::size_t most) {
  if (list.size() <= most) return;
  std::vector<T> kept;
  for (std::size_t k = 0; k < most; ++k) kept.push_back(list[k * list.size() / most]);
  list = std::move(kept);
}

class GridSearch {
 public:
  /// @param conditions  at which every grid is gone through
  GridSearch(const PlanningModel& model, const PlanningSpace& space, const Eigen::MatrixXd& predictions,
             StudyPlan& result, const JobOptions& job, std::vector<std::size_t> conditions = {0})
      : model_(model),
        space_(space),
        predictions_(predictions),
        result_(result),
        job_(job),
        conditions_(std::move(conditions)),
        ranges_(model.study().planning->axes) {
    const double all = static_cast<double>(result.candidates + result.hidden);
    visible_ = all > 0 ? static_cast<double>(result.candidates) / all : 1;
    const std::size_t poses = static_cast<std::size_t>(all) / model.sight_count() + result.forbidden;
    if (poses > 0) visible_ *= 1 - static_cast<double>(result.forbidden) / static_cast<double>(poses);
  }

  void run() {
    const std::size_t wanted = result_.readings.size();
    result_.same_number = best_of(wanted);
    for (const PlanPoint& point : result_.curve)
      result_.curve_grids.push_back(point.readings == wanted ? result_.same_number : best_of(point.readings));
    for (const double factor : kLargerNumbers) {
      if (result_.equal_grid) break;
      best_of(static_cast<std::size_t>(factor * static_cast<double>(wanted)));
    }
  }

  /// Of as many readings as the plan has.
  GridsOfANumber of_same_number() { return best_of(result_.readings.size()); }

 private:
  const Machine& machine() const { return model_.study().machine; }
  bool rotary(std::size_t i) const { return machine().axes[i].kind == AxisKind::rotary; }

  GridsOfANumber best_of(std::size_t number) {
    struct Tried {
      double with_prior;
      const Grid* grid;
    };
    std::vector<Grid> grids;
    const std::size_t at_each = number / conditions_.size();
    add_factorial(at_each, grids);
    add_composite(at_each, grids);
    std::vector<Tried> tried;
    const std::vector<ItemResult> all = results_of_items(job_.work, grid_items(grids, number));
    for (std::size_t i = 0; i < grids.size(); ++i) {
      if (!all[i].numbers.empty()) tried.push_back({all[i].numbers.front(), &grids[i]});
    }
    std::stable_sort(tried.begin(), tried.end(),
                     [](const Tried& a, const Tried& b) { return a.with_prior < b.with_prior; });
    GridsOfANumber best;
    best.tried = tried.size();
    const bool counts = !model_.states().any();
    if (counts) result_.grids_tried += tried.size();
    if (tried.size() > kLookedAt) tried.resize(kLookedAt);
    NumberedItems looked_at{.name = "best grids", .count = tried.size(), .threads = model_.study().threads};
    looked_at.fingerprint = [&] {
      Digest digest;
      digest.add(fingerprint(grids, number));
      for (const Tried& one : tried) digest.add_number(one.with_prior);
      return digest.value();
    };
    looked_at.compute = [&](std::size_t k) { return evaluated(*tried[k].grid); };
    const std::vector<ItemResult> found = results_of_items(job_.work, looked_at);
    for (std::size_t k = 0; k < tried.size(); ++k) {
      const GridPoint point = point_of(*tried[k].grid, tried[k].with_prior, found[k]);
      if (!best.any) best.any = point;
      if (!point.value.determined) continue;
      if (!best.determined || point.value.uncertainty < best.determined->value.uncertainty) best.determined = point;
      if (counts && point.value.uncertainty <= result_.uncertainty &&
          (!result_.equal_grid || point.value.readings < result_.equal_grid->value.readings))
        result_.equal_grid = point;
    }
    return best;
  }

  /// What all grids of a number are worth with the prior; no number where a grid has too few readings or too many.
  NumberedItems grid_items(const std::vector<Grid>& grids, std::size_t number) const {
    NumberedItems items{.name = "grids", .count = grids.size(), .threads = model_.study().threads};
    items.fingerprint = [this, &grids, number] { return fingerprint(grids, number); };
    items.compute = [this, &grids, number](std::size_t i) -> ItemResult {
      stop_if_asked(job_.stop);
      PlanningModel::Candidates readings = readings_of(grids[i], conditions_);
      const std::size_t count = readings.readings.size();
      if (count < number || static_cast<double>(count) > kMostOfTheNumber * static_cast<double>(number)) return {};
      if (!take(readings)) return {};
      return {{uncertainty_with_prior(model_, readings.rows.rows, predictions_)}};
    };
    return items;
  }

  /// Of the grids, of what is predicted, and of the model, which shows in the rows of the first grid.
  std::uint64_t fingerprint(const std::vector<Grid>& grids, std::size_t number) const {
    Digest digest;
    const auto add_matrix = [&digest](const auto& matrix) {
      digest.add_numbers({matrix.data(), static_cast<std::size_t>(matrix.size())});
    };
    digest.add_text(vector_instructions());
    digest.add(number);
    for (const std::size_t condition : conditions_) digest.add(condition);
    for (const Grid& grid : grids) {
      for (const std::vector<double>& axis : grid.poses.axis) digest.add_numbers(axis);
      for (const std::size_t sight : grid.sight) digest.add(sight);
    }
    add_matrix(predictions_);
    add_matrix(space_.estimates_from_seen());
    add_matrix(model_.known());
    add_matrix(model_.weak_prior());
    if (!grids.empty()) add_matrix(readings_of(grids.front(), conditions_).rows.rows);
    return digest.value();
  }

  PlanningModel::Candidates readings_of(const Grid& grid, const std::vector<std::size_t>& conditions) const {
    std::vector<PosesAt> at;
    for (const std::size_t condition : conditions) at.push_back({grid.poses, condition});
    return model_.readings_at(at, grid.sight);
  }

  /// Rows at the times and states at which readings are really taken. False: the course is over before they are.
  bool take(PlanningModel::Candidates& readings) const {
    const PlannedStates& states = model_.states();
    if (!states.any() && !has_drift(model_.study())) return true;
    const auto ordered = scheduled_readings(model_.study(), states, readings.readings);
    if (states.has_course()) {
      const std::vector<double> times = reading_times(model_.study(), ordered, states);
      if (times.empty() || times.back() > states.used_at_time().back()) return false;
    }
    readings.rows = rows_as_taken(model_, ordered);
    return true;
  }

  /// Numbers of readings and open directions, the uncertainty if everything is determined, and names of open errors.
  ItemResult evaluated(const Grid& grid) const {
    stop_if_asked(job_.stop);
    PlanningModel::Candidates readings = readings_of(grid, conditions_);
    take(readings);
    const PlanValue value = value_of(space_, readings.rows, predictions_);
    const std::size_t open = space_.dimension() - value.rank;
    ItemResult result{{static_cast<double>(readings.readings.size()), static_cast<double>(open)}};
    if (value.determined)
      result.numbers.push_back(std::sqrt(value.variance / (static_cast<double>(predictions_.rows()) / 3)));
    if (open > 0) result.text = open_errors(model_, space_, readings.rows.rows, value.rank);
    return result;
  }

  static GridPoint point_of(const Grid& grid, double with_prior, const ItemResult& found) {
    GridPoint point;
    point.words = grid.words;
    point.value.readings = static_cast<std::size_t>(found.numbers.at(0));
    point.open = static_cast<std::size_t>(found.numbers.at(1));
    point.value.determined = found.numbers.size() > 2;
    if (point.value.determined) point.value.uncertainty = found.numbers[2];
    point.value.with_prior = with_prior;
    point.open_words = found.text;
    return point;
  }

  std::string counts_text(const Counts& counts) const {
    std::string text;
    for (std::size_t i = 0; i < counts.size(); ++i)
      if (counts[i] > 1) text += fmt::format("{}{} {}", text.empty() ? "" : " x ", machine().axes[i].name, counts[i]);
    return text;
  }

  /// All combinations; axes of one position stand at the middle of their range, or where `elsewhere` says (a share).
  PoseList grid_of(const Counts& counts, double elsewhere = 0.5) const {
    std::vector<AxisRange> ranges = ranges_;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      ranges[i].count = counts[i];
      if (counts[i] == 1) {
        const double share = rotary(i) ? elsewhere : 0.5;
        ranges[i] = AxisRange::fixed(ranges[i].from + share * (ranges[i].to - ranges[i].from));
      }
    }
    return grid_plan(machine(), ranges);
  }

  /// One sight at each pose so that neighbours along every axis have different ones (a Latin square).
  std::vector<std::size_t> latin(const PoseList& poses) const {
    std::vector<std::vector<double>> levels = poses.axis;
    for (std::vector<double>& one : levels) {
      std::sort(one.begin(), one.end());
      one.erase(std::unique(one.begin(), one.end()), one.end());
    }
    std::vector<std::size_t> sight;
    for (std::size_t k = 0; k < poses.count(); ++k) {
      std::size_t sum = 0;
      for (std::size_t i = 0; i < levels.size(); ++i)
        sum += static_cast<std::size_t>(std::lower_bound(levels[i].begin(), levels[i].end(), poses.axis[i][k]) -
                                        levels[i].begin());
      sight.push_back(sum);
    }
    return sight;
  }

  /// All counts of the axes marked, from two on, with a product between the limits.
  void collect(const std::vector<bool>& marked, double lower, double upper, Counts counts,
               std::vector<Counts>& found) const {
    const std::size_t axis = counts.size();
    const double before = static_cast<double>(product(counts));
    if (axis == ranges_.size()) {
      if (before >= lower && before <= upper) found.push_back(counts);
      return;
    }
    const bool moves = marked[axis] && !ranges_[axis].is_fixed();
    for (std::size_t count = moves ? 2 : 1; count <= (moves ? kMostPerAxis : 1); ++count) {
      if (before * static_cast<double>(count) > upper) break;
      counts.push_back(count);
      collect(marked, lower, upper, counts, found);
      counts.pop_back();
    }
  }

  std::vector<bool> all_axes() const { return std::vector<bool>(ranges_.size(), true); }
  std::vector<bool> axes_of(AxisKind kind) const {
    std::vector<bool> marked;
    for (const Axis& axis : machine().axes) marked.push_back(axis.kind == kind);
    return marked;
  }

  /// All axes in equal steps: every sight at each pose, or one.
  void add_factorial(std::size_t number, std::vector<Grid>& grids) const {
    for (const bool every : {true, false}) {
      const double per_pose = visible_ * (every ? static_cast<double>(model_.sight_count()) : 1);
      const double poses = static_cast<double>(number) / per_pose;
      std::vector<Counts> found;
      collect(all_axes(), 0.9 * poses, 1.3 * poses, {}, found);
      // As many positions everywhere as the axes need first: what is short on one axis leaves it open.
      sort_by_missing(found);
      if (found.size() > kMostGrids) found.resize(kMostGrids);
      for (const Counts& counts : found) {
        Grid grid{"all axes together, " + counts_text(counts), grid_of(counts), {}};
        if (every) {
          grids.push_back(std::move(grid));
          continue;
        }
        Grid shuffled = grid;
        grid.sight = latin(grid.poses);
        grid.words += ", one sight at each pose as in a Latin square";
        shuffled.words += ", one sight at each pose, drawn";
        for (std::size_t k = 0; k < shuffled.poses.count(); ++k)
          shuffled.sight.push_back(static_cast<std::size_t>(RandomStream(1, k).uniform() * 1e6));
        grids.push_back(std::move(grid));
        grids.push_back(std::move(shuffled));
      }
    }
  }

  /// How many positions are missing against the functions of the errors of each axis.
  std::size_t short_of(const Counts& counts) const {
    std::size_t missing = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      std::size_t needed = 1;
      for (const ErrorMotion& motion : model_.errors().motions)
        if (motion.axis == i) needed = std::max(needed, motion.coefficients.size());
      if (!ranges_[i].is_fixed() && counts[i] < needed) missing += needed - counts[i];
    }
    return missing;
  }

  /// Those first of which the fewest positions are missing.
  void sort_by_missing(std::vector<Counts>& list) const {
    std::vector<std::pair<std::size_t, Counts>> sorted;
    for (Counts& counts : list) {
      const std::size_t missing = short_of(counts);
      sorted.emplace_back(missing, std::move(counts));
    }
    std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t k = 0; k < list.size(); ++k) list[k] = std::move(sorted[k].second);
  }

  /// Several set-ups of the machine: the linear axes over their volume at one or two positions of the rotary axes, and
  /// the rotary axes together at one or two positions of the linear ones (Aguado et al., fig. 5, B with C).
  void add_composite(std::size_t number, std::vector<Grid>& grids) const {
    const std::vector<bool> linear = axes_of(AxisKind::linear), turning = axes_of(AxisKind::rotary);
    if (std::count(linear.begin(), linear.end(), true) == 0 || std::count(turning.begin(), turning.end(), true) == 0)
      return;
    const double poses = static_cast<double>(number) / (visible_ * static_cast<double>(model_.sight_count()));
    std::vector<Grid> found;
    for (const std::size_t times : {std::size_t{1}, std::size_t{2}})
      for (const double share : {0.35, 0.5, 0.65}) {
        std::vector<Counts> volumes, turns;
        const double first = share * poses / static_cast<double>(times), second = (1 - share) * poses;
        collect(linear, 0.8 * first, 1.25 * first, {}, volumes);
        collect(turning, 0.8 * second, 1.25 * second, {}, turns);
        sort_by_missing(volumes);
        sort_by_missing(turns);
        if (volumes.size() > 4) volumes.resize(4);
        if (turns.size() > 4) turns.resize(4);
        for (const Counts& volume : volumes)
          for (const Counts& turn : turns) {
            PoseList list = join(grid_of(volume), grid_of(turn));
            if (times == 2) list = join(list, grid_of(volume, 0.8));
            found.push_back({fmt::format("{}{} and {} by themselves", times == 2 ? "twice " : "", counts_text(volume),
                                         counts_text(turn)),
                             std::move(list),
                             {}});
          }
      }
    thin(found, 2 * kMostGrids);
    for (Grid& grid : found) grids.push_back(std::move(grid));
  }

  const PlanningModel& model_;
  const PlanningSpace& space_;
  const Eigen::MatrixXd& predictions_;
  StudyPlan& result_;
  const JobOptions& job_;
  std::vector<std::size_t> conditions_;
  const std::vector<AxisRange>& ranges_;
  double visible_ = 1;
};

constexpr std::size_t kMostSingle = 5;

/// Of all conditions, those at which every state is near its lowest and its highest value.
std::pair<std::size_t, std::size_t> ends_of_states(const PlannedStates& states) {
  const std::vector<PlanningCondition>& all = states.conditions();
  const std::size_t count = all.front().states.size();
  std::vector<double> low(count, std::numeric_limits<double>::infinity()), high(count, -low.front());
  for (const PlanningCondition& one : all) {
    for (std::size_t j = 0; j < count && one.possible; ++j) {
      if (std::isnan(one.states[j])) continue;
      low[j] = std::min(low[j], one.states[j]);
      high[j] = std::max(high[j], one.states[j]);
    }
  }
  std::size_t lowest = 0, highest = 0;
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (std::size_t c = 0; c < all.size(); ++c) {
    if (!all[c].possible) continue;
    double sum = 0;
    for (std::size_t j = 0; j < count; ++j) {
      if (high[j] > low[j] && !std::isnan(all[c].states[j])) sum += (all[c].states[j] - low[j]) / (high[j] - low[j]);
    }
    if (sum < least) {
      least = sum;
      lowest = c;
    }
    if (sum > most) {
      most = sum;
      highest = c;
    }
  }
  return {lowest, highest};
}

/// Some conditions, evenly over all at which readings can be taken.
std::vector<std::size_t> spread_conditions(const PlannedStates& states) {
  std::vector<std::size_t> all;
  for (std::size_t c = 0; c < states.conditions().size(); ++c) {
    if (states.conditions()[c].possible) all.push_back(c);
  }
  thin(all, kMostSingle);
  return all;
}

}  // namespace

void compare_with_grids(const PlanningModel& model, const PlanningSpace& space, const Eigen::MatrixXd& predictions,
                        StudyPlan& result, const JobOptions& job) {
  GridSearch(model, space, predictions, result, job).run();
}

void compare_with_plain_states(const PlanningModel& model, const PlanningSpace& space,
                               const Eigen::MatrixXd& predictions, StudyPlan& result, const JobOptions& job) {
  const auto grids_at = [&](const std::vector<std::size_t>& conditions) {
    return GridSearch(model, space, predictions, result, job, conditions).of_same_number();
  };
  const auto [lowest, highest] = ends_of_states(model.states());
  if (lowest != highest) {
    const std::vector<std::size_t> both = {std::min(lowest, highest), std::max(lowest, highest)};
    result.plain_states.push_back({PlainStates::Kind::ends, both, grids_at(both)});
  }
  PlainStates one{PlainStates::Kind::one, {}, {}};
  for (const std::size_t condition : spread_conditions(model.states())) {
    const GridsOfANumber grids = grids_at({condition});
    if (!grids.any) continue;
    if (one.grids.any && !(grids.any->value.with_prior < one.grids.any->value.with_prior)) continue;
    one.conditions = {condition};
    one.grids = grids;
  }
  if (one.grids.any) result.plain_states.push_back(std::move(one));
}

}  // namespace abbe
