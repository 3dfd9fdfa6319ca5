#pragma once

// The result of a study as values: what every step of it has computed (study_steps.h).
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/identify/order_selection.h"
#include "abbe/identify/strategies.h"
#include "abbe/identify/trust/monte_carlo.h"
#include "abbe/identify/trust/trust.h"
#include "abbe/identify/trust/unseen.h"
#include "abbe/identify/variance_components.h"
#include "abbe/identify/walk_intensity.h"
#include "abbe/study/campaign.h"
#include "abbe/study/identification/chosen_terms.h"
#include "abbe/study/identification/not_identified.h"
#include "abbe/study/identification/ranked_sensors.h"
#include "abbe/study/model.h"
#include "abbe/study/report/unseen.h"
#include "abbe/verify/error_map.h"
#include "abbe/verify/left_out_poses.h"
#include "abbe/verify/volumetric_figures.h"

namespace abbe {

/// Volumetric error over a grid or at given poses, in the workpiece frame after the best fit of the workpiece datum.
struct StudyMap {
  PoseList poses;
  std::vector<std::size_t> grid;  ///< positions per axis in chain order; empty: no grid
  std::string description;
  std::vector<std::string> moved;  ///< ranges that were asked for and are not known throughout, a sentence each
  bool against_truth = false;  ///< before and after are true; else before is the identified error and after is absent
  ErrorMap before;
  std::optional<ErrorMap> after;
  ErrorMap predicted;  ///< of the identified errors, with their uncertainty

  LeftOutPoses left_out() const { return {.all = poses.count(), .not_covered = before.statistics.excluded}; }
};

/// What was identified of the same machine before a correction, for its customer report.
struct EarlierResult {
  std::string name;  ///< of its folder or file
  ErrorsFile errors;
  bool is_simulated = false;
};

/// Everything that a study has computed.
struct StudyResult {
  Campaign campaign;
  StudyModel model;
  std::optional<ChosenTerms> terms;  ///< with states, where the study leaves a choice
  std::optional<OrderSelection> order_selection;
  std::vector<Identification> stages;
  Identification identification;
  std::optional<WeighedIdentification> weighed;  ///< variances of the readings, if estimated; its result is moved out
  std::vector<EstimatedWalk> walks;              ///< intensities of random walks, where they are estimated
  std::optional<MonteCarloResult> monte_carlo;
  std::optional<UnseenPoses> unseen;
  std::optional<VolumetricFigures> volumetric;  ///< over the grid of all commands; usable results only
  std::optional<StudyMap> map;
  std::vector<std::string> warnings;
  std::vector<Advice> advice;            ///< what the readings do not see, and what would show it
  NotIdentified not_identified;          ///< errors of the machine that are not in the model; empty unless usable
  std::vector<Distrust> distrusted;      ///< why a usable result must not be used as it is, see judge_trust()
  bool misfit_accepted = false;          ///< the user wants to use it nevertheless
  std::optional<EarlierResult> before;   ///< where the study names one
  std::optional<RankedSensors> sensors;  ///< where the study wants them ranked

  /// True if the result may be used: converged and nothing impossible.
  bool usable() const { return identification.status == IdentifyStatus::converged; }
};

}  // namespace abbe
