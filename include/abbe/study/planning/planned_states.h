#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/formats/readings/channel_file.h"
#include "abbe/formats/study/study.h"

namespace abbe {

/// States of a machine under which readings are taken one after the other: a combination of values, or a part of the
/// expected course.
struct PlanningCondition {
  std::vector<double> states;      ///< [states of the machine] values, NaN where they are not needed; empty: no states
  std::vector<std::size_t> level;  ///< [PlanningStudy::states] index of the value
  double from_s = 0, to_s = 0;     ///< of a part of the course; equal for values
  bool possible = true;            ///< false: errors are used there, and nothing can be measured
};

/// At which states the readings of a plan can be taken, and at which its errors will be used: by the tables
/// [plan.state.NAME] or [plan.course] of a study. Errors without measured and lag states have one condition.
class PlannedStates {
 public:
  PlannedStates() : conditions_(1) {}
  /// @throws InputError for states that the tables do not give, and errors that depend on the side of approach
  PlannedStates(const Study& study, const ErrorSet& errors);

  /// False where the errors need no values of states.
  bool any() const { return !conditions_.front().states.empty(); }
  bool has_course() const { return any() && !channels_.empty(); }
  const std::vector<PlanningCondition>& conditions() const { return conditions_; }
  /// States at which the errors will be used, [..][states of the machine]; one empty one without states.
  const std::vector<std::vector<double>>& used_at() const { return used_at_; }
  /// [used_at()] s; empty without a course.
  const std::vector<double>& used_at_time() const { return used_at_time_; }
  /// States at times of the course, [times][states of the machine]. @throws InputError for a time that it does not
  /// cover
  std::vector<std::vector<double>> at_times(const std::vector<double>& time_s) const;
  /// Measured states on which the errors depend, by themselves or through lags and products.
  const std::vector<std::size_t>& sensors() const { return sensors_; }
  /// What the user should know: lags that are taken to be in equilibrium.
  const std::vector<std::string>& notes() const { return notes_; }

  /// s from readings at one condition to those at another: what has to change, or 0 in a course.
  double change_time(std::size_t from, std::size_t to) const;
  /// What it costs to begin with readings after a pause of the course, s.
  double visit_time() const { return visit_; }
  /// Conditions in the order in which they are gone through: by time, or with few of the slow changes.
  std::vector<std::size_t> in_order(std::vector<std::size_t> conditions) const;
  /// s for all changes between these conditions, and the visits to the machine.
  double change_time(const std::vector<std::size_t>& conditions) const;
  /// "ambient_degC = 21.5"
  std::string words(const std::vector<double>& states) const;

 private:
  void take_values(const Study& study, const ErrorSet& errors);
  void add_values();
  void add_course(const Study& study);
  std::vector<double> states_of(const std::vector<double>& values) const;

  Machine machine_;
  std::vector<PlannedState> values_;
  std::vector<std::size_t> slow_first_;  ///< indices into values_
  StateChannels channels_;
  double visit_ = 0;
  std::vector<std::size_t> needed_, sensors_;
  std::vector<PlanningCondition> conditions_;
  std::vector<std::vector<double>> used_at_{{}};
  std::vector<double> used_at_time_;
  std::vector<std::string> notes_;
};

/// Measured states on which a state depends, itself or those behind a lag or in a product; increasing.
std::vector<std::size_t> sensors_of_state(const Machine& machine, std::size_t state);

/// Gives poses these states, the same at all or one row for each. @param states  [1 or poses][states of the machine]
void give_states(const std::vector<std::vector<double>>& states, PoseList& poses);

}  // namespace abbe
