#include "abbe/study/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/errors/error_states.h"
#include "abbe/errors/random_stream.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/study/identification/identified_expansions.h"
#include "abbe/study/identification/setup_drifts.h"
#include "abbe/study/identification/time_blocks.h"
#include "abbe/study/identification/turn_coverage.h"

namespace abbe {
namespace {

/// Positions of one axis in all readings.
struct MeasuredPositions {
  std::vector<double> values;
  PositionRange range;

  MeasuredPositions() = default;
  MeasuredPositions(const Machine& machine, const Campaign& campaign, std::size_t axis) {
    for (const CampaignSetup& setup : campaign.setups) {
      const std::vector<double> more = positions_of_axis(machine, setup.poses(), axis);
      values.insert(values.end(), more.begin(), more.end());
    }
    if (values.empty()) return;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    range = {*low, *high};
  }

  bool move() const { return !values.empty() && range.from < range.to; }
};

/// Keeps one entry for each axis: where all of its error motions are stated.
void note_coverage(const AxisCoverage& coverage, std::vector<AxisCoverage>& list) {
  for (AxisCoverage& other : list) {
    if (other.axis != coverage.axis) continue;
    other.wanted = {std::max(other.wanted.from, coverage.wanted.from), std::min(other.wanted.to, coverage.wanted.to)};
    other.stated = {std::max(other.stated.from, coverage.stated.from), std::min(other.stated.to, coverage.stated.to)};
    return;
  }
  list.push_back(coverage);
}

/// Nodes of a table to be identified: evenly over its range, or around the period.
void place_nodes(Basis& basis) {
  const int count = basis.periodic ? basis.order : basis.order + 1;
  const double step = (basis.periodic ? basis.period : basis.to - basis.from) / basis.order;
  for (int k = 0; k < count; ++k) basis.nodes.push_back(basis.from + k * step);
  if (!basis.periodic) basis.nodes.back() = basis.to;
  basis.to = basis.nodes.back();
  basis.order = 0;
}

void mark_held_out(const Study& study, const Campaign& campaign, Problem& problem) {
  const double fraction = study.identification->held_out_fraction;
  if (fraction <= 0 || study.identification->held_out_file) return;
  for (std::size_t s = 0; s < problem.observations.size(); ++s) {
    SelectedObservations& selected = problem.observations[s];
    const std::size_t count = selected.observations->reading_count();
    selected.use.assign(count, 1);
    if (is_time_series(study.machine, problem.errors, campaign.setups[s])) {
      hold_out_blocks(campaign.setups[s].readings.time_s, fraction, RandomStream(study.seed, 7000 + s), selected.use);
      continue;
    }
    // All readings of one pose are held out together: another reflector at the same pose is no unseen pose.
    std::vector<double> previous;
    RandomStream random(study.seed, 7000 + s);
    bool out = false;
    for (std::size_t k = 0; k < count; ++k) {
      std::vector<double> positions = selected.observations->positions(k);
      if (k == 0 || positions != previous) out = random.uniform() < fraction;
      previous = std::move(positions);
      if (out) selected.use[k] = 0;
    }
  }
}

/// @throws InputError where the readings of a set-up do not give a state that the errors use
void require_read_states(const Machine& machine, const ErrorSet& errors, const CampaignSetup& setup) {
  const std::size_t missing = missing_state(machine, errors, setup.poses());
  if (missing == kNoState) return;
  const MachineState& state = machine.states[missing];
  throw InputError({.field = setup.name},
                   fmt::format("errors to be identified depend on {}, which is not given at all readings", state.name),
                   fmt::format("a column {} in the readings", state_column(state)));
}

/// @param all_found  every prior of the study has a parameter; lower orders than the study's may not have them all
void add_priors(const Study& study, const Campaign& campaign, bool all_found, Problem& problem) {
  const std::vector<EstimatedParameter> parameters = estimated_parameters(problem);
  const std::vector<std::uint8_t> of_expansion = are_of_expansions(*study.identification, problem.errors);
  for (const ParameterPrior& prior : study.identification->priors) {
    std::size_t found = 0;
    for (const EstimatedParameter& parameter : parameters) {
      if (!matches_pattern(parameter.name, prior.parameters)) continue;
      if (parameter.id.is_machine() && of_expansion[parameter.id.index] != 0) continue;
      ++found;
      if (parameter.is_angle != prior.is_angle) {
        throw InputError(
            {.field = "identify.prior"},
            fmt::format("'{}' matches {}, which is {}", prior.parameters, parameter.name,
                        parameter.is_angle ? "an angle" : "a length"),
            parameter.is_angle ? "value_urad and standard_uncertainty_urad" : "value_um and standard_uncertainty_um");
      }
      problem.priors.push_back({parameter.id, prior.value, prior.standard_uncertainty});
    }
    if (found == 0 && all_found) {
      throw InputError({.field = "identify.prior"},
                       fmt::format("no estimated parameter matches '{}'", prior.parameters),
                       "a name such as " + (parameters.empty() ? std::string("EXX[P1]") : parameters.front().name));
    }
  }
  add_expansion_priors(*study.identification, problem);
  for (std::size_t s = 0; s < campaign.setups.size(); ++s) {
    for (const KnownUnknown& known : campaign.setups[s].known_unknowns()) {
      problem.priors.push_back({{s, known.unknown}, known.value, known.standard_uncertainty});
    }
    add_walk_priors(campaign.setups[s], s, problem);
  }
}

}  // namespace

ErrorSet model_errors(const Study& study, const Campaign& campaign, StudyModel& model) {
  const IdentificationPlan& plan = *study.identification;
  ErrorSet errors;
  std::optional<ErrorSet> initial;
  if (plan.initial_errors) initial = read_errors(*plan.initial_errors, study.machine, StatesOfErrors::allowed).errors;
  std::vector<MeasuredPositions> positions_of(study.machine.axes.size());  // of axes that were asked for
  for (const IdentifiedMotion& identified : plan.motions) {
    if (identified.expansion) {
      // Known over the whole length of the scale, whatever was measured.
      errors.motions.push_back({identified.axis,
                                identified.component,
                                identified.basis,
                                {0, identified.expansion->coefficient.value},
                                {},
                                identified.state});
      continue;
    }
    const Axis& axis = study.machine.axes[identified.axis];
    MeasuredPositions& positions = positions_of[identified.axis];
    if (positions.values.empty()) positions = MeasuredPositions(study.machine, campaign, identified.axis);
    ErrorMotion motion{identified.axis, identified.component, identified.basis, {}, {}, identified.state};
    Basis& basis = motion.basis;
    if (!positions.move()) {
      model.impossible =
          fmt::format("axis {} does not move in any reading: its error motions cannot be identified", axis.name);
    } else if (basis.kind == BasisKind::fourier ? !covers_turn(positions.values, basis)
                                                : basis.nodes.empty() && !basis.periodic) {
      const PositionRange measured = positions.range, wanted = {basis.from, basis.to};
      const PositionRange stated = stated_range(basis, measured, 0.01 * plan.coverage_margin_percent);
      if (stated.from < stated.to) {
        basis.from = stated.from;
        basis.to = stated.to;
        note_coverage({identified.axis, wanted, measured, stated}, model.coverage);
      }
    }
    if (basis.kind == BasisKind::table_linear) place_nodes(basis);
    motion.coefficients.assign(basis.size(), 0.0);
    if (initial) {
      for (const ErrorMotion& start : initial->motions) {
        if (start.axis == motion.axis && start.component == motion.component && start.basis == motion.basis &&
            start.state == motion.state) {
          motion.coefficients = start.coefficients;
        }
      }
    }
    errors.motions.push_back(motion);
  }
  for (const IdentifiedLocation& identified : plan.locations) {
    LocationError location{identified.axis, identified.component, 0, 0, identified.state};
    if (initial) {
      for (const LocationError& start : initial->locations) {
        if (start.axis != location.axis || start.component != location.component) continue;
        if (start.state == location.state) location.value = start.value;
      }
    }
    errors.locations.push_back(location);
  }
  for (const std::size_t axis : plan.reversals) {
    Reversal reversal{axis, 0, 0};
    if (initial) {
      for (const Reversal& start : initial->reversals) {
        if (start.axis == axis) reversal.value = start.value;
      }
    }
    errors.reversals.push_back(reversal);
  }
  if (initial) errors.tool_offset_error = initial->tool_offset_error;
  return errors;
}

namespace {

StudyModel model_of(const Study& study, const Campaign& campaign, bool all_priors) {
  StudyModel model;
  const IdentificationPlan& plan = *study.identification;
  const ErrorSet errors = model_errors(study, campaign, model);
  if (!model.impossible.empty()) return model;
  std::vector<std::shared_ptr<Observations>> observations;
  for (const CampaignSetup& setup : campaign.setups) {
    require_read_states(study.machine, errors, setup);
    observations.push_back(setup.observations(study.machine, errors));
  }
  model.problem = estimate_everything(study.machine, errors, observations);
  if (!plan.tool_offset) {
    std::vector<std::size_t>& parameters = model.problem.machine_parameters;
    const std::size_t first_tool = errors.parameter_count() - 3;
    parameters.erase(
        std::remove_if(parameters.begin(), parameters.end(), [&](std::size_t p) { return p >= first_tool; }),
        parameters.end());
  }
  keep_expansion_estimates(plan, model.problem);
  mark_held_out(study, campaign, model.problem);
  if (plan.estimate_block_noise) mark_noise_blocks(plan.noise_block_s, campaign, model.problem);
  add_priors(study, campaign, all_priors, model.problem);
  return model;
}

}  // namespace

StudyModel build_model(const Study& study, const Campaign& campaign) {
  StudyModel model = model_of(study, campaign, true);
  const IdentificationPlan& plan = *study.identification;
  if (plan.select_order && model.impossible.empty()) {
    for (OrderGroup group : order_groups_by_axis(study.machine, model.problem.errors)) {
      int smallest = 1 << 20;
      for (std::size_t motion : group.motions) smallest = std::min(smallest, plan.motions[motion].smallest_order);
      group.start_order = smallest;
      model.order_groups.push_back(group);
    }
  }
  return model;
}

StudyModel build_model_at(const Study& study, const Campaign& campaign, const std::vector<OrderGroup>& groups,
                          const std::vector<int>& orders) {
  Study lower = study;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (groups[g].nested) continue;
    for (const std::size_t m : groups[g].motions) {
      IdentifiedMotion& motion = lower.identification->motions[m];
      motion.basis.order = std::clamp(orders[g], motion.smallest_order, motion.basis.order);
    }
  }
  StudyModel model = model_of(lower, campaign, false);
  if (model.impossible.empty()) model.problem = at_nested_orders(model.problem, groups, orders);
  model.order_groups = groups;
  return model;
}

OrderSelection select_model(const Study& study, const Campaign& campaign, const OrderSelectionOptions& options,
                            StudyModel& model) {
  const std::vector<OrderGroup> groups = model.order_groups;
  if (std::all_of(groups.begin(), groups.end(), [](const OrderGroup& group) { return group.nested; })) {
    OrderSelection selection = select_orders(model.problem, groups, options);
    if (selection.done) model.problem.machine_parameters = selection.machine_parameters;
    return selection;
  }
  StudyModel trial;
  OrderSelection selection = select_orders(
      [&](const std::vector<int>& orders) {
        trial = build_model_at(study, campaign, groups, orders);
        return trial.problem;
      },
      groups, options);
  if (selection.done) model = build_model_at(study, campaign, groups, selection.orders);
  return selection;
}

}  // namespace abbe
