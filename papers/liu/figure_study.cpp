#include "liu/figure_study.h"

#include <algorithm>

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

LiuClampingStudy clamping_study(const Machine& machine, LiuUnit unit, std::size_t campaigns) {
  LiuClampingStudy study;
  study.unit = unit;
  const RigidTransform clamped = liu_clamping(unit);
  study.truth = liu_clamping_errors({clamped.translation, clamped.rotation * Eigen::Vector3d::UnitY()});
  const ErrorSet truth = liu_errors(machine, unit);
  study.exact = liu_campaign(machine, truth, study.truth, {"exact readings", {}, 0, 0});
  study.noisy = liu_campaign(machine, truth, study.truth, {"noise of Table 2", liu_table_2_noise(), 0, 1});
  study.tapered = liu_campaign(machine, truth, study.truth, {"exact, standard with taper", {}, kLiuTaper, 0});
  study.joint = liu_joint_clamping(machine, truth, study.truth, 1);
  study.spread = liu_clamping_spreads(machine, truth, study.truth, campaigns);
  return study;
}

std::vector<LiuProfile> clamped_sections(const Machine& machine) {
  const std::vector<LiuSectionCase> cases = {
      {"shift 0.1 mm", {}, {}, liu_clamped({0, 0, 0.1, 0}), {}},
      {"shift 0.5 mm, largest of 4.1", {}, {}, liu_clamped({0, 0, 0.5, 0}), {}},
      {"tilt 1 degree", {}, {}, liu_clamped({0, kDegree, 0, 0}), {}},
      {"tilt 5 degrees, largest of 4.1", {}, {}, liu_clamped({0, 5 * kDegree, 0, 0}), {}},
      {"Table 3, shifts in um", {}, {}, liu_clamping(LiuUnit::micrometre), {}},
      {"Table 3, shifts in mm", {}, {}, liu_clamping(LiuUnit::millimetre), {}}};
  std::vector<LiuProfile> profiles;
  for (const LiuSectionCase& one : cases) profiles.push_back(liu_profile(machine, one, {kLiuClampingHeight}));
  return profiles;
}

std::vector<LiuProfile> corrected_sections(const Machine& machine, const LiuClampingStudy& study) {
  const ErrorSet truth = liu_errors(machine, study.unit);
  const RigidTransform clamped = liu_clamped(study.truth);
  const auto compensated = [&](const std::string& words, const LiuCampaign& campaign) {
    return LiuSectionCase{words, truth, campaign.c.errors, clamped, liu_clamped(campaign.clamping.found)};
  };
  const std::vector<LiuSectionCase> cases = {
      {"static errors, cylinder on the true axis of C", truth, {}, liu_on_stage_axis(machine, truth), {}},
      {"static errors, cylinder along y", truth, {}, {}, {}},
      {"clamping errors only", {}, {}, clamped, {}},
      {"static and clamping errors", truth, {}, clamped, {}},
      compensated("compensated, exact calibration", study.exact),
      compensated("compensated, calibrated with noise of Table 2", study.noisy),
      compensated("compensated, calibrated with tapered standard", study.tapered)};
  std::vector<LiuProfile> profiles;
  const std::vector<double> heights = {-11.75, -8, -4, 0, 4, 8, 11.75};
  for (const LiuSectionCase& one : cases) profiles.push_back(liu_profile(machine, one, heights));
  return profiles;
}

}  // namespace

bool LiuFigureStudy::complete() const {
  const bool calibrated = std::all_of(clampings.begin(), clampings.end(), [](const LiuClampingStudy& s) {
    return s.exact.converged() && s.noisy.converged() && s.tapered.converged() && s.joint.converged;
  });
  return reference.converged && calibrated &&
         std::all_of(repeats.begin(), repeats.end(), [](const LiuRepeats& r) { return r.complete; });
}

LiuFigureStudy liu_figure_study(const Machine& machine, std::size_t campaigns) {
  LiuFigureStudy study;
  study.reference = liu_reference_clamping(machine);
  for (const LiuUnit unit : {LiuUnit::millimetre, LiuUnit::micrometre}) {
    study.clampings.push_back(clamping_study(machine, unit, campaigns));
  }
  if (!study.complete()) return study;
  study.clamped = clamped_sections(machine);
  study.corrected = corrected_sections(machine, study.micrometres());
  const ErrorSet truth = liu_errors(machine, LiuUnit::micrometre);
  const LiuNoise noise = liu_table_2_noise();
  const std::vector<std::pair<LiuCase, double>> standards = {
      {{"exact cylinder", noise, 0, 1}, 0},
      {{"14 um of taper over 23.5 mm", noise, kLiuTaper, 1}, 0},
      {{"three lobes, 14 um peak to valley", noise, 0, 1}, 0.007}};
  for (const auto& [how, lobes] : standards) {
    study.repeats.push_back(liu_repeats(machine, truth, study.micrometres().truth, how, lobes));
  }
  return study;
}

}  // namespace abbe
