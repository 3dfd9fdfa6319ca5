#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "abbe/errors/chain_plan.h"
#include "abbe/formats/readings/channel_file.h"
#include "abbe/instruments/measurement_plan.h"

namespace abbe {

/// What a plan of readings makes small.
enum class PlanningGoal {
  volumetric,   ///< V: mean predicted volumetric uncertainty
  determinant,  ///< D: volume of the confidence ellipsoid
  parameters    ///< A: sum of the variances of named parameters, lengths in um and angles in urad
};

/// A box into which the functional point of the tool must not come.
struct ForbiddenBox {
  Body frame = Body::workpiece;                                                  ///< workpiece or bed
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();  ///< corners, mm
};

/// What one set-up of the study costs. Table [plan.setup.NAME].
struct PlannedSetup {
  std::string name;
  double set_up = 0;             ///< s, to bring the instrument there and align it, once
  std::optional<double> settle;  ///< s; else that of the plan
  std::optional<double> reading;
};

/// Values of a state at which readings can be taken. Table [plan.state.NAME].
struct PlannedState {
  std::size_t state = 0;              ///< measured or lag; index into Machine::states
  std::vector<double> values;         ///< increasing, in the unit of the state
  double used_from = 0, used_to = 0;  ///< between which the errors will be used
  double change = 0;  ///< s, to bring it to another of these values and to wait until the machine has settled
};

/// States as they are expected over the time in which readings can be taken. Table [plan.course].
struct PlannedCourse {
  ChannelPlan channels;
  double slot = 0;   ///< s, length of the parts from which the plan chooses
  double visit = 0;  ///< s, what it costs to begin with readings after a pause
};

/// What `abbe plan` is to choose from, and how much it may take. Table [plan] of a study.
struct PlanningStudy {
  int readings = 0;  ///< to be chosen; 0: as many as the time allows
  double time = 0;   ///< s, of the whole measurement; 0: no limit. At least one of the two is given
  PlanningGoal goal = PlanningGoal::volumetric;
  std::vector<std::string> parameters;  ///< patterns of names, for the goal of that name
  double target = 0;                    ///< mm, standard uncertainty that would be enough; 0: none
  bool grid = false;                    ///< candidates on a grid, else random
  int candidates = 0;                   ///< random: number of poses
  std::vector<AxisRange> axes;          ///< [axes], chain order; the travel by default
  std::vector<double> speed;            ///< [axes] mm/s or rad/s
  double settle = 0;                    ///< s, from standstill to the reading
  double reading = 0;                   ///< s, one reading
  std::vector<ForbiddenBox> forbidden;
  std::vector<PlannedSetup> setups;  ///< those that cost something else than the rest
  std::vector<PlannedState> states;  ///< at most one of `states` and `course` is given
  std::optional<PlannedCourse> course;
  std::size_t conditions = 0;  ///< combinations of values, or parts of the course, to be used at most; 0: any number

  const PlannedSetup* find(const std::string& setup) const;
  double settle_of(const std::string& setup) const;
  double reading_of(const std::string& setup) const;
  double set_up_of(const std::string& setup) const;
};

}  // namespace abbe
