#pragma once

// For plans of readings while set-ups drift: what they are worth at the times at which they are taken, and which
// readings are taken when.
#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "abbe/study/planning/planning.h"
#include "abbe/study/planning/planning_setting.h"

namespace abbe {

/// Whether the study has the drift of a set-up identified.
bool has_drift(const Study& study);

/// Rows of readings as they are taken: at the times of their order and at the states of these times; drifts projected
/// out (PlanningModel::rows_of()).
/// @param readings  in their order, with an end in the course of the states
PlanningCandidates rows_as_taken(const PlanningModel& model, const std::vector<CandidateReading>& readings);

/// Readings that follow each other under one condition and, where these take turns, with one set-up.
struct PlanningPart {
  std::size_t condition = 0;
  std::size_t setup = PosesAt::kEverySetup;
  double time_s = 0;     ///< mean of its readings
  std::size_t room = 0;  ///< readings
};

/// Divides readings in their order, of which each gets its part.
std::vector<PlanningPart> parts_in_order(const Study& study, const PlannedStates& states,
                                         std::vector<CandidateReading>& readings);

/// Candidates in the parts of a plan; drifts are further unknowns.
struct TimedCandidates {
  std::unique_ptr<const PlanningModel> model;
  PlanningModel::Candidates candidates;
  std::unique_ptr<const PlanningSpace> space;
};

/// Rows over the estimates of a model as rows over those of a model that has drifts too.
Eigen::MatrixXd with_drifts(const Eigen::MatrixXd& rows, const PlanningModel& from, const PlanningModel& to);

/// Chooses again, beside the drift and in parts of the measurement, so that poses may be returned to.
///
/// A round shares the measurement out in parts, offers each of them the poses of the plan and others, and exchanges
/// readings within and between parts, with the drift at the middle of each part. What it finds is put in order, takes
/// its times, and counts if its criterion is smaller there.
/// @param space    without drift: what has to be determined
/// @param options  criterion, its functionals and the time left
/// @return candidates of the last choice that counted; empty if none did
TimedCandidates choose_in_time(const PlanningSetting& setting, const PlanningSpace& space,
                               const PlanningOptions& options, StudyPlan& result, const std::stop_token& stop);

/// What readings are worth as they are taken; none where they do not determine everything.
std::optional<PlanPoint> point_as_taken(const PlanningModel& model, const PlanningSpace& space,
                                        const Eigen::MatrixXd& predictions,
                                        const std::vector<CandidateReading>& readings);

/// Curve and choices at random of a plan beside drift, each at times of its own.
void add_choices_in_time(const PlanningSetting& setting, const PlanningSpace& space, const TimedCandidates& timed,
                         const PlanningOptions& options, std::span<const std::size_t> counts, StudyPlan& result,
                         const std::stop_token& stop);

/// What the plan says about drift: text and JSON.
std::string planned_drift_text(const StudyPlan& result);
nlohmann::ordered_json planned_drift_json(const StudyPlan& result);

}  // namespace abbe
