#pragma once

#include <Eigen/Core>

#include "abbe/study/study_result.h"
#include "abbe/verify/error_map.h"
#include "abbe/verify/parts/determined_part.h"

namespace abbe {

struct Study;

/// Ranges over which the identified errors are known, and the true ones of a simulation.
std::vector<AxisRange> ranges_of_known_errors(const Study& study, const StudyResult& result);

/// Random poses over these ranges, at the references of the states.
/// @param both_directions  every axis comes from either side
PoseList poses_not_measured(const Study& study, const StudyResult& result, std::size_t count, bool both_directions);

/// Options of maps at these poses.
ErrorMapOptions unseen_map_options(const Study& study);

/// Directions that the gauge fixes, as far as they are errors of the machine: [machine parameters, constraints].
Eigen::MatrixXd unseen_directions(const Identification& identification);

/// @param open  columns of unseen_directions()
void tell_open_directions(const StudyResult& result, const OpenDirections& open, UnseenPoses& unseen);

/// Which of the unseen directions the volumetric error depends on, where no truth is known.
void find_open_directions(const Study& study, const StudyResult& result, std::size_t poses, UnseenPoses& unseen);

}  // namespace abbe
