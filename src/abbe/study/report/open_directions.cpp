#include "abbe/study/report/open_directions.h"

#include <numeric>

#include "abbe/errors/error_states.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/study/random_poses.h"

namespace abbe {

std::vector<AxisRange> ranges_of_known_errors(const Study& study, const StudyResult& result) {
  std::vector<const ErrorSet*> errors = {&result.identification.errors};
  if (result.campaign.truth) errors.push_back(&*result.campaign.truth);
  return unseen_ranges(study.machine, errors);
}

PoseList poses_not_measured(const Study& study, const StudyResult& result, std::size_t count, bool both_directions) {
  PoseList list = random_unseen_poses(study.machine, ranges_of_known_errors(study, result), count,
                                      unseen_seed(study.seed), both_directions);
  stand_at_references(study.machine, list);
  return list;
}

ErrorMapOptions unseen_map_options(const Study& study) {
  ErrorMapOptions options;
  options.orientation = false;
  options.remove_rigid_motion = true;
  options.threads = study.threads;
  return options;
}

Eigen::MatrixXd unseen_directions(const Identification& identification) {
  const std::vector<GaugeConstraint>& constraints = identification.gauge.constraints;
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(identification.errors.parameter_count()),
                                                     static_cast<Eigen::Index>(constraints.size()));
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    for (std::size_t p = 0; p < identification.parameters.size(); ++p) {
      const ParameterId& id = identification.parameters[p].id;
      if (!id.is_machine()) continue;
      directions(static_cast<Eigen::Index>(id.index), static_cast<Eigen::Index>(i)) =
          constraints[i].direction[static_cast<Eigen::Index>(p)];
    }
  }
  return directions;
}

void tell_open_directions(const StudyResult& result, const OpenDirections& open, UnseenPoses& unseen) {
  for (const std::size_t direction : open.directions) {
    const GaugeConstraint& constraint = result.identification.gauge.constraints[direction];
    unseen.open.push_back(constraint.words);
    unseen.open_constraints.push_back(direction);
  }
  unseen.open_known = true;
  unseen.open_rank = open.rank;
}

void find_open_directions(const Study& study, const StudyResult& result, std::size_t poses, UnseenPoses& unseen) {
  const ErrorSet& identified = result.identification.errors;
  const PoseList list = poses_not_measured(study, result, poses, !identified.reversals.empty());
  const ErrorMap map = error_map(study.machine, identified, nullptr, pose_source(list), unseen_map_options(study));
  std::vector<std::size_t> parameters(identified.parameter_count());
  std::iota(parameters.begin(), parameters.end(), std::size_t{0});
  tell_open_directions(result,
                       open_directions(study.machine, identified, parameters, unseen_directions(result.identification),
                                       list, map.covered),
                       unseen);
}

}  // namespace abbe
