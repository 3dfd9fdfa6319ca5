#pragma once

// For plans of readings: the order in which they are taken, and how long that takes.
#include <vector>

#include "abbe/study/planning/planning.h"

namespace abbe {

/// True if all set-ups see points and stand there all the time, as trackers do.
bool sees_points_only(const Study& study);

/// s, of the slowest axis.
double travel_time(const PlanningStudy& plan, const std::vector<double>& from, const std::vector<double>& to);

/// Same readings in the order in which they are to be taken. Trackers stand there all the time; other instruments are
/// used one after the other, each at all conditions of values; a course has all of them standing. Readings that are
/// shared out among parts of the measurement go from part to part.
std::vector<CandidateReading> scheduled_readings(const Study& study, const PlannedStates& states,
                                                 const std::vector<CandidateReading>& readings);

/// s, of readings in their order; without the pauses of a course.
double measuring_time(const Study& study, const PlannedStates& states, const std::vector<CandidateReading>& readings);

}  // namespace abbe
