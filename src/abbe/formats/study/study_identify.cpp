#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/machine/error_fields.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/study/study_parts.h"

namespace abbe {
namespace {

// Beyond that an error motion would be an extrapolation and not the end of a range.
constexpr double kLargestCoverageMargin = 10;

constexpr Component kComponents[] = {Component::X, Component::Y, Component::Z,
                                     Component::A, Component::B, Component::C};

std::string pattern_hint(const Machine& machine) {
  return fmt::format("names like EXX or patterns like \"E?{}\" (* any text, ? one character); axes {}",
                     machine.axes.front().name, axis_names(machine));
}

bool is_pattern(const std::string& text) { return text.find_first_of("*?") != std::string::npos; }

/// Error motions whose names match, in the order of the chain and of ISO 230-1.
std::vector<std::pair<std::size_t, Component>> find_motions(const TomlTable& table, const Machine& machine,
                                                            const std::string& pattern) {
  std::vector<std::pair<std::size_t, Component>> found;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    for (const Component component : kComponents) {
      if (matches_pattern(error_motion_name(machine, axis, component), pattern)) found.emplace_back(axis, component);
    }
  }
  if (found.empty()) {
    table.fail("errors", fmt::format("\"{}\" is not an error motion of this machine", pattern), pattern_hint(machine));
  }
  return found;
}

/// Key `state`: the error motions or location errors of the table are proportional to its factor.
std::size_t read_identified_state(TomlTable& table, const Machine& machine) {
  if (!table.has("state")) return kNoState;
  const std::string name = table.text("state");
  const std::size_t state = find_state(machine, name);
  if (state != kNoState) return state;
  std::string known;
  for (const MachineState& one : machine.states) known += (known.empty() ? "" : ", ") + one.name;
  table.fail("state", fmt::format("\"{}\" is not a state of this machine", name),
             known.empty() ? "a table [state." + name + "] in the machine file" : known);
}

bool is_nested_basis(BasisKind kind) {
  return kind == BasisKind::monomial || kind == BasisKind::legendre || kind == BasisKind::chebyshev ||
         kind == BasisKind::fourier;
}

/// Key `optional` of terms with a state.
bool read_optional(TomlTable& table, std::size_t state) {
  const bool optional = table.boolean_or("optional", false);
  if (optional && state == kNoState) table.fail("optional", "is given without a state", "terms with a `state`");
  return optional;
}

std::vector<IdentifiedMotion> read_motions(TomlTable& table, const Machine& machine) {
  Basis basis = read_basis_kind(table);
  if (basis.kind == BasisKind::table_monotone) {
    table.fail("basis", "the functions of a monotone table depend on its values, so that these cannot be identified",
               "\"table-linear\", \"bspline\" or a polynomial");
  }
  const int smallest = smallest_order(basis);
  int smallest_tried = 0;
  if (table.has("orders")) {
    if (table.has("order")) table.fail("orders", "is given together with `order`", "only one of them");
    const std::vector<std::int64_t> orders = table.integers("orders", smallest, kLargestOrder);
    if (orders.size() != 2 || orders[0] > orders[1]) table.fail("orders", "is not a range", "[smallest, largest]");
    smallest_tried = static_cast<int>(orders[0]);
    basis.order = static_cast<int>(orders[1]);
  } else {
    basis.order = static_cast<int>(table.integer("order", smallest, kLargestOrder));
    smallest_tried = basis.order;
  }
  const std::size_t state = read_identified_state(table, machine);
  const bool optional = read_optional(table, state);
  if (state != kNoState && smallest_tried < basis.order && !is_nested_basis(basis.kind)) {
    table.fail("orders", "is given together with `state`", "order, or polynomials or a Fourier series");
  }
  const std::vector<std::string> patterns = table.texts("errors");
  if (patterns.empty()) table.fail("errors", "is empty", pattern_hint(machine));
  std::vector<IdentifiedMotion> motions;
  AxisKind kind = AxisKind::linear;
  for (const std::string& pattern : patterns) {
    for (const auto& [axis, component] : find_motions(table, machine, pattern)) {
      if (motions.empty()) kind = machine.axes[axis].kind;
      if (machine.axes[axis].kind != kind) {
        table.fail("errors", "linear and rotary axes in one table: their positions have different units",
                   "one [[identify.motion]] for each kind of axis");
      }
      IdentifiedMotion motion{axis, component, basis, smallest_tried, state, optional};
      // A table to be identified has no nodes yet, but a range like a spline, over which they will stand evenly.
      motion.basis.kind = is_table(basis.kind) ? BasisKind::bspline : basis.kind;
      read_basis_range(table, machine, axis, motion.basis);
      motion.basis.kind = basis.kind;
      motions.push_back(std::move(motion));
    }
  }
  table.finish();
  return motions;
}

/// @param key    of the patterns
/// @param state  of the location errors
void read_locations(TomlTable& table, const Machine& machine, const char* key, std::size_t state, bool optional,
                    IdentificationPlan& plan) {
  for (const std::string& pattern : table.texts_or_none(key)) {
    bool found = false;
    for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
      for (const Component component : kComponents) {
        if (!matches_pattern(location_error_name(machine, axis, component), pattern)) continue;
        const bool valid = location_error_is_valid(machine.axes[axis], component);
        if (!valid && is_pattern(pattern)) continue;
        if (!valid) {
          table.fail(key, fmt::format("\"{}\" has no effect on the axis", pattern),
                     "a location error that displaces the axis line");
        }
        // The zero of an axis is rarely meant by "all location errors", and rarely separable from other constants.
        if (is_pattern(pattern) && is_zero_position_error(machine.axes[axis], component)) continue;
        found = true;
        const bool known =
            std::any_of(plan.locations.begin(), plan.locations.end(), [&](const IdentifiedLocation& other) {
              return other.axis == axis && other.component == component && other.state == state;
            });
        if (!known) plan.locations.push_back({axis, component, state, optional});
      }
    }
    if (!found) {
      table.fail(key, fmt::format("\"{}\" is not a location error of this machine", pattern),
                 fmt::format("names like EC0X or patterns like \"E?0{}\"; axes {}", machine.axes.front().name,
                             axis_names(machine)));
    }
  }
}

void read_reversals(TomlTable& table, const Machine& machine, IdentificationPlan& plan) {
  for (const std::string& name : table.texts_or_none("reversals")) {
    bool found = false;
    for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
      if (!matches_pattern(machine.axes[axis].name, name)) continue;
      found = true;
      if (std::find(plan.reversals.begin(), plan.reversals.end(), axis) == plan.reversals.end()) {
        plan.reversals.push_back(axis);
      }
    }
    if (!found) {
      table.fail("reversals", fmt::format("\"{}\" is not an axis of this machine", name),
                 "names of axes or \"*\"; axes " + axis_names(machine));
    }
  }
}

/// The same knowledge of every pattern that `parameters` lists.
void read_prior(TomlTable& table, std::vector<ParameterPrior>& priors) {
  ParameterPrior prior;
  const std::vector<std::string> patterns = table.texts("parameters");
  if (patterns.empty()) table.fail("parameters", "are missing", "a parameter name or pattern, or a list of them");
  const auto length = table.optional_number("standard_uncertainty", Quantity::length);
  const auto angle = table.optional_number("standard_uncertainty", Quantity::angle);
  prior.is_angle = angle.has_value();
  const Quantity quantity = prior.is_angle ? Quantity::angle : Quantity::length;
  const Quantity other = prior.is_angle ? Quantity::length : Quantity::angle;
  if (table.has("value", other)) table.fail_quantity("value", other, "has another unit than the uncertainty");
  prior.value = table.number_or("value", quantity, 0);
  table.finish();
  if (length.has_value() == angle.has_value()) {
    table.fail("", "the standard uncertainty is missing or given twice",
               "standard_uncertainty_um for lengths or standard_uncertainty_urad for angles");
  }
  prior.standard_uncertainty = prior.is_angle ? *angle : *length;
  if (prior.standard_uncertainty <= 0) {
    table.fail_quantity("standard_uncertainty", quantity, "is not above zero", "a standard uncertainty");
  }
  for (const std::string& pattern : patterns) {
    prior.parameters = pattern;
    priors.push_back(prior);
  }
}

/// Whether a state is measured, or computed from one that is.
bool is_measured(const Machine& machine, std::size_t state) {
  if (state == kNoState) return false;
  const MachineState& one = machine.states[state];
  return is_input(one.kind) ||
         (one.kind == StateKind::product && (is_measured(machine, one.first) || is_measured(machine, one.second)));
}

bool has_sensor(const IdentificationPlan& plan, const Machine& machine) {
  const auto measured = [&machine](const auto& term) { return is_measured(machine, term.state); };
  return std::any_of(plan.motions.begin(), plan.motions.end(), measured) ||
         std::any_of(plan.locations.begin(), plan.locations.end(), measured);
}

/// How terms with states are chosen, and sensors ranked.
void read_time_blocks(TomlTable& table, const Machine& machine, IdentificationPlan& plan) {
  const char* const expected = "optional = true or orders in a table with a state";
  const char* const problem = "is given, and no term with a state is chosen";
  plan.rank_sensors = table.boolean_or("rank_sensors", false);
  if (plan.rank_sensors && !has_sensor(plan, machine)) {
    table.fail("rank_sensors", "is given, and no error depends on a measured state", "terms with a `state`");
  }
  const bool divides = plan.select_terms || plan.rank_sensors;
  if (!divides && table.has("time_blocks")) table.fail("time_blocks", problem, expected);
  if (!divides && table.has("time_gap", Quantity::time)) {
    table.fail_quantity("time_gap", Quantity::time, problem, expected);
  }
  plan.time_blocks = static_cast<std::size_t>(table.integer_or("time_blocks", 20, 4, 1000));
  plan.time_gap_s = table.size_or("time_gap", Quantity::time, 0);
}

/// Table `ageing`: how the errors wander after their measurement.
void read_ageing_plan(TomlTable& table, IdentificationPlan& plan) {
  auto ageing = table.optional_table("ageing");
  if (!ageing) return;
  const double per_root = 1 / std::sqrt(86400.0);
  plan.ageing_length = 1e-3 * per_root * ageing->size_or("um_per_sqrt_day", Quantity::dimensionless, 0);
  plan.ageing_angle = 1e-6 * per_root * ageing->size_or("urad_per_sqrt_day", Quantity::dimensionless, 0);
  ageing->finish();
}

/// Which variances of the readings are estimated from their residuals.
void read_variances(TomlTable& table, IdentificationPlan& plan) {
  plan.estimate_variance_factor = table.word_or("variance_factor", 0, {"stated", "estimated"}) == 1;
  plan.estimate_pose_noise = table.word_or("pose_noise", 0, {"none", "estimated"}) == 1;
  plan.estimate_block_noise = table.word_or("block_noise", 0, {"none", "estimated"}) == 1;
  if (const auto length = table.optional_number("noise_block", Quantity::time)) {
    plan.noise_block_s = *length;
    if (!plan.estimate_block_noise) {
      table.fail_quantity("noise_block", Quantity::time, "is given without a noise", "block_noise = \"estimated\"");
    }
    if (!(*length > 0)) table.fail_quantity("noise_block", Quantity::time, "is not above zero", "the time of a block");
  } else if (plan.estimate_block_noise) {
    table.fail("block_noise", "needs the time of a block", "noise_block_s, noise_block_min or noise_block_h");
  }
  if (plan.estimate_block_noise && plan.estimate_pose_noise) {
    table.fail("block_noise", "is estimated beside pose_noise", "only one of them");
  }
  const char* field = plan.estimate_variance_factor ? "variance_factor"
                      : plan.estimate_pose_noise    ? "pose_noise"
                                                    : "block_noise";
  if (!plan.estimate_variance_factor && !plan.estimate_pose_noise && !plan.estimate_block_noise) return;
  if (plan.loss != LossKind::none) {
    table.fail(field, "is estimated from sums of squares, which a robust loss does not have", "loss = \"none\"");
  }
  if (plan.strategy != Strategy::joint) {
    table.fail(field, "is estimated together with all parameters", "strategy = \"joint\"");
  }
}

}  // namespace

bool matches_pattern(std::string_view text, std::string_view pattern) {
  // Greedy with one place to return to: linear in practice, and never worse than the product of the lengths.
  std::size_t at = 0, in = 0, star = std::string_view::npos, resume = 0;
  while (at < text.size()) {
    if (in < pattern.size() && pattern[in] == '*') {
      star = in++;
      resume = at;
    } else if (in < pattern.size() && (pattern[in] == '?' || pattern[in] == text[at])) {
      ++in;
      ++at;
    } else if (star != std::string_view::npos) {
      in = star + 1;
      at = ++resume;
    } else {
      return false;
    }
  }
  while (in < pattern.size() && pattern[in] == '*') ++in;
  return in == pattern.size();
}

IdentificationPlan read_identification(TomlTable& table, const std::filesystem::path& folder, const Machine& machine,
                                       const Simulation* simulation) {
  IdentificationPlan plan;
  for (TomlTable& motion : table.tables("motion")) {
    for (IdentifiedMotion& identified : read_motions(motion, machine)) {
      for (const IdentifiedMotion& other : plan.motions) {
        if (other.axis != identified.axis || other.component != identified.component) continue;
        if (other.basis.kind != identified.basis.kind || other.state != identified.state) continue;
        motion.fail("errors",
                    fmt::format("{} is given twice in the same basis",
                                error_motion_name(machine, identified.axis, identified.component)),
                    "each error motion once per basis");
      }
      const bool several = identified.smallest_order < identified.basis.order;
      plan.select_order = plan.select_order || (several && identified.state == kNoState);
      plan.select_terms = plan.select_terms || identified.optional || (several && identified.state != kNoState);
      plan.motions.push_back(std::move(identified));
    }
  }
  read_identified_expansions(table, machine, simulation, plan);
  read_locations(table, machine, "locations", kNoState, false, plan);
  for (TomlTable& location : table.tables("location")) {
    const std::size_t state = read_identified_state(location, machine);
    if (state == kNoState) location.fail("state", "is missing", "a state; location errors without one in `locations`");
    read_locations(location, machine, "errors", state, read_optional(location, state), plan);
    location.finish();
  }
  for (const IdentifiedLocation& one : plan.locations) plan.select_terms = plan.select_terms || one.optional;
  read_time_blocks(table, machine, plan);
  read_ageing_plan(table, plan);
  read_reversals(table, machine, plan);
  plan.tool_offset = table.boolean_or("tool_offset", false);
  if (table.has("initial")) plan.initial_errors = folder / table.text("initial");
  table.text_or("initial", "");
  for (TomlTable& prior : table.tables("prior")) read_prior(prior, plan.priors);
  plan.strategy = static_cast<Strategy>(table.word_or("strategy", 0, {"joint", "independent", "combined"}));
  plan.loss = static_cast<LossKind>(table.word_or("loss", 0, {"none", "huber", "cauchy", "tukey"}));
  plan.loss_scale = table.size_or("loss_scale", Quantity::dimensionless, 0);
  read_variances(table, plan);
  if (plan.rank_sensors && (plan.loss != LossKind::none || plan.strategy != Strategy::joint)) {
    table.fail("rank_sensors", "compares sums of squares, which need one identification by least squares",
               "loss = \"none\" and strategy = \"joint\"");
  }
  if (plan.select_terms && (plan.loss != LossKind::none || plan.strategy != Strategy::joint)) {
    table.fail(plan.loss != LossKind::none ? "loss" : "strategy",
               "is given together with terms that are chosen, which are compared by joint least squares",
               "loss = \"none\" and strategy = \"joint\"");
  }
  plan.max_iterations = static_cast<int>(table.integer_or("max_iterations", 50, 1, 100000));
  plan.tolerance = table.size_or("tolerance", Quantity::dimensionless, 1e-10);
  plan.held_out_fraction = table.size_or("held_out_fraction", Quantity::dimensionless, 0.1);
  if (plan.held_out_fraction > 0.9) table.fail("held_out_fraction", "is too large", "a fraction from 0 to 0.9");
  plan.coverage_margin_percent = table.size_or("coverage_margin_percent", Quantity::dimensionless, 2);
  if (plan.coverage_margin_percent > kLargestCoverageMargin) {
    table.fail("coverage_margin_percent", "is too large", "a percentage of the measured range from 0 to 10");
  }
  if (table.has("held_out_file")) plan.held_out_file = folder / table.text("held_out_file");
  table.text_or("held_out_file", "");
  plan.monte_carlo = static_cast<int>(table.integer_or("monte_carlo", 0, 0, 10'000'000));
  plan.readings_in_memory = static_cast<std::size_t>(table.integer_or("readings_in_memory", 0, 0, 1'000'000'000));
  table.finish();
  const bool no_motion = std::all_of(plan.motions.begin(), plan.motions.end(), [](const IdentifiedMotion& motion) {
    return motion.expansion && motion.expansion->coefficient.knowledge == Knowledge::exact;
  });
  if (no_motion && plan.locations.empty() && !plan.tool_offset) {
    table.fail("", "nothing is to be identified", "[[identify.motion]], locations or tool_offset = true");
  }
  return plan;
}

}  // namespace abbe
