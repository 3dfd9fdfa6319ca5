#include "abbe/study/campaign.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/errors/random_errors.h"
#include "abbe/errors/random_stream.h"
#include "abbe/formats/errors_file.h"
#include "abbe/formats/input_error.h"
#include "abbe/study/instrument_campaign.h"
#include "abbe/study/tracker_campaign.h"

namespace abbe {
namespace {

// A stream of its own, apart from those of the other errors.
constexpr std::uint64_t kReversalStream = 1'000'000'009;

PoseList poses_once(const Machine& machine, const MeasurementPlan& plan, std::uint64_t seed) {
  const std::size_t points = static_cast<std::size_t>(std::max(plan.points, 0));
  if (plan.kind == PlanKind::line) return line_plan(machine, plan.axes, points);
  if (plan.kind == PlanKind::step_diagonal) return step_diagonal_plan(machine, plan.axes, plan.steps, plan.order);
  if (plan.kind == PlanKind::random) return random_plan(machine, plan.axes, points, seed);
  if (plan.kind != PlanKind::spiral) return grid_plan(machine, plan.axes);
  // The two axes of largest range carry the ellipse.
  std::vector<std::size_t> order(plan.axes.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto extent = [&](std::size_t i) {
    const Axis& axis = machine.axes[i];
    const double whole = axis.travel_max - axis.travel_min;
    return whole > 0 ? (plan.axes[i].to - plan.axes[i].from) / whole : plan.axes[i].to - plan.axes[i].from;
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return extent(a) > extent(b); });
  return spiral_plan(machine, plan.axes, points, plan.turns, order.at(0), order.at(1));
}

}  // namespace

std::size_t Campaign::reading_count() const {
  std::size_t count = 0;
  for (const std::shared_ptr<CampaignSetup>& setup : setups) count += setup->reading_count();
  return count;
}

ErrorSet true_errors(const Study& study) {
  const Simulation& simulation = *study.simulation;
  if (simulation.errors_file) return read_errors(*simulation.errors_file, study.machine).errors;
  const ErrorGenerator& generator = *simulation.generator;
  RandomErrorOptions options;
  options.seed = generator.seed;
  options.linear_order = generator.linear_order;
  options.rotary_harmonics = generator.rotary_order;
  options.rotary_order = generator.rotary_order;
  options.locations = generator.location_errors;
  ErrorSet errors = random_errors(study.machine, options);
  VolumetricTarget target;
  target.measure = generator.mean_volumetric ? VolumetricMeasure::mean : VolumetricMeasure::maximum;
  target.value_um = 1e3 * (generator.mean_volumetric ? *generator.mean_volumetric : *generator.maximum_volumetric);
  scale_errors(study.machine, errors, target);
  for (std::size_t axis = 0; axis < study.machine.axes.size(); ++axis) {
    const bool rotary = study.machine.axes[axis].kind == AxisKind::rotary;
    const double size = rotary ? generator.rotary_reversal : generator.reversal;
    // Lost motion: the axis stays behind.
    RandomStream random(generator.seed, kReversalStream + axis);
    if (size > 0) errors.reversals.push_back({axis, -size * random.uniform(0.5, 1.5), 0});
  }
  return errors;
}

bool approach_matters(const Study& study, const ErrorSet& truth) {
  return !truth.reversals.empty() || (study.identification && !study.identification->reversals.empty());
}

std::uint64_t plan_seed(const Study& study, std::size_t setup, std::size_t plan) {
  return study.seed * 1000003 + setup * 1009 + plan;
}

PoseList plan_poses(const Machine& machine, const MeasurementPlan& plan, std::uint64_t seed) {
  return repeated(poses_once(machine, plan, seed), plan.repeats, plan.there_and_back);
}

Campaign gather_readings(const Study& study, const ProgressCallback& progress) {
  Campaign campaign;
  if (study.simulation) campaign.truth = true_errors(study);
  const ErrorSet* truth = campaign.truth ? &*campaign.truth : nullptr;
  for (std::size_t i = 0; i < study.setups.size(); ++i) {
    const Setup& setup = study.setups[i];
    std::shared_ptr<CampaignSetup> result =
        setup.device ? gather_instrument(study, i, truth) : gather_tracker(study, i, truth, progress);
    result->name = setup.name;
    if (result->hidden > 0) {
      campaign.notes.push_back(
          fmt::format("{}: {} readings left out for lack of a line of sight", setup.name, result->hidden));
    }
    if (result->reading_count() == 0) {
      throw InputError({.file = setup.name}, "the set-up has no readings", "at least one reading");
    }
    campaign.setups.push_back(std::move(result));
  }
  return campaign;
}

void find_start_values(const Machine& machine, Campaign& campaign) {
  for (const std::shared_ptr<CampaignSetup>& setup : campaign.setups) {
    setup->find_start(machine, campaign.warnings, campaign.notes);
  }
}

}  // namespace abbe
