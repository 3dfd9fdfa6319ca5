#include "abbe/runtime/freeze.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "abbe/errors/calibrated_machine.h"
#include "abbe/machine/coupling.h"
#include "abbe/machine/inverse_plan.h"
#include "abbe/machine/machine_check.h"
#include "abbe/runtime/abbe_runtime.h"
#include "abbe/runtime/freeze_check.h"
#include "abbe/runtime/freeze_states.h"
#include "abbe/runtime/freeze_uncertainty.h"
#include "abbe/runtime/frozen_functions.h"
#include "abbe/runtime/frozen_layout.h"

namespace abbe {
namespace {

struct Chosen {
  std::vector<std::size_t> solved, turning, reaching;
};

/// Which axes work: as in CompensatedInverse for a wanted point and direction.
Chosen choose_axes(const Machine& machine) {
  const std::vector<double> reference(machine.axes.size(), 0.0);
  InversePlan plan = make_inverse_plan(machine, TargetKind::point_and_direction, {}, reference);
  if (plan.rotary_count == 0) plan = make_inverse_plan(machine, TargetKind::point, {}, reference);
  Chosen chosen;
  chosen.turning.assign(plan.rotary.begin(), plan.rotary.begin() + static_cast<std::ptrdiff_t>(plan.rotary_count));
  chosen.reaching.assign(plan.linear.begin(), plan.linear.begin() + static_cast<std::ptrdiff_t>(plan.linear_count));
  if (chosen.reaching.size() == 3) chosen.solved = chosen.reaching;
  if (chosen.reaching.size() < 3 && plan.polar_count > 0) chosen.reaching.push_back(plan.polar[0]);
  return chosen;
}

class Writer {
 public:
  void value(double v) { values_.push_back(v); }
  void flag(bool v) { value(v ? 1 : 0); }
  void vector(const Eigen::Vector3d& v) {
    for (int k = 0; k < 3; ++k) value(v[k]);
  }
  void axes(const std::vector<std::size_t>& list) {
    value(static_cast<double>(list.size()));
    for (std::size_t k = 0; k < 3; ++k) value(k < list.size() ? static_cast<double>(list[k]) : 0);
  }
  void all(const std::vector<double>& values) { values_.insert(values_.end(), values.begin(), values.end()); }
  const std::vector<double>& values() const { return values_; }

 private:
  std::vector<double> values_;
};

double limited(double value) { return std::clamp(value, -frozen::kLongest, frozen::kLongest); }

void write_machine(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options, std::size_t groups,
                   Writer& out) {
  const Chosen chosen = choose_axes(machine);
  out.value(static_cast<double>(machine.axes.size()));
  out.axes(chosen.solved);
  out.axes(chosen.turning);
  out.axes(chosen.reaching);
  out.value(options.largest_turn);
  out.value(options.largest_shift);
  out.vector(machine.tool_reference);
  out.vector(options.tool);
  out.vector(errors.tool_offset_error);
  out.vector(machine.tool_direction);
  out.value(options.tool_length_min);
  out.value(options.tool_length_max);
  Machine bare = machine;
  bare.tool_offset.setZero();
  const std::vector<double> zeros(machine.axes.size(), 0.0);
  const bool at_joints = options.world_zero_at_joints && !chosen.solved.empty();
  out.vector(at_joints ? nominal_workpiece_from_tool(bare, zeros).translation : Eigen::Vector3d(0, 0, 0));
  const RigidTransform workpiece_from_bed = machine.bed_from_workpiece.inverse();
  for (int i = 0; i < 9; ++i) out.value(workpiece_from_bed.rotation(i / 3, i % 3));
  out.vector(workpiece_from_bed.translation);
  for (int i = 0; i < 5; ++i) out.value(0);  // of freeze_check()
  out.value(static_cast<double>(groups));
}

void write_axis(const Machine& machine, const ErrorSet& errors, const CalibratedMachine& calibrated, std::size_t i,
                Writer& out) {
  const Axis& axis = machine.axes[i];
  const bool rotary = axis.kind == AxisKind::rotary;
  out.flag(rotary);
  out.flag(axis.side == ChainSide::tool);
  out.flag(axis.primed);
  const ErrorOrder order = errors.composition.order;
  out.flag(order == ErrorOrder::iso ? rotary : order == ErrorOrder::before_motion);
  out.flag(axis.endless);
  out.value(static_cast<double>(axis.name.empty() ? 'X' : axis.name[0]));
  out.value(axis.name.size() > 1 ? std::strtod(axis.name.c_str() + 1, nullptr) : 0);
  out.vector(axis.direction);
  out.vector(axis.point);
  out.vector(calibrated.machine.axes[i].direction);
  out.vector(calibrated.machine.axes[i].point);
  out.value(calibrated.zero[i]);
  const std::array<double, 2> map = map_of(errors, i);
  out.value(map[0]);
  out.value(map[1]);
  out.value(limited(axis.travel_min));
  out.value(limited(axis.travel_max));
}

void write_couplings(const Machine& machine, Writer& out) {
  std::vector<AxisCoupling> couplings = machine.couplings;
  const CouplingOrder order = coupling_order(machine);
  const auto place = [&](std::size_t axis) { return std::find(order.axis.begin(), order.axis.end(), axis); };
  std::stable_sort(couplings.begin(), couplings.end(),
                   [&](const AxisCoupling& a, const AxisCoupling& b) { return place(a.axis) < place(b.axis); });
  out.value(static_cast<double>(couplings.size()));
  for (const AxisCoupling& coupling : couplings) {
    out.value(static_cast<double>(coupling.axis));
    out.value(static_cast<double>(coupling.of));
    out.value(coupling.ratio);
  }
}

void write_uncertainty(const UncertaintyLattice& lattice, Writer& out) {
  out.value(static_cast<double>(lattice.dimensions.size()));
  out.value(lattice.largest);
  out.value(lattice.mean);
  out.value(lattice.interpolation);
  for (const FrozenUncertainty::Dimension& d : lattice.dimensions) {
    out.value(static_cast<double>(d.axis));
    out.value(static_cast<double>(d.nodes));
    out.value(d.from);
    out.value(d.to);
    out.flag(d.is_periodic);
  }
  for (const double value : lattice.values) out.value(value);
}

template <typename T>
void put(std::vector<unsigned char>& bytes, std::size_t place, const T& value) {
  std::memcpy(bytes.data() + place, &value, sizeof value);
}

void put_text(std::vector<unsigned char>& bytes, std::size_t place, std::size_t room, const std::string& text) {
  std::memcpy(bytes.data() + place, text.data(), std::min(room - 1, text.size()));
}

std::vector<unsigned char> file_of(const Machine& machine, const FreezeOptions& options,
                                   const std::vector<double>& values, int format) {
  using namespace frozen;
  std::vector<unsigned char> bytes(kHeaderBytes + 8 * values.size(), 0);
  std::memcpy(bytes.data(), kMagic, sizeof kMagic);
  put(bytes, kByteOrderAt, kByteOrder);
  put(bytes, kFormatAt, static_cast<std::uint32_t>(format));
  put(bytes, kCountAt, std::uint64_t{values.size()});
  put(bytes, kSourceAt, crc(reinterpret_cast<const unsigned char*>(options.source.data()), options.source.size()));
  put_text(bytes, kVersionAt, kVersionBytes, options.version);
  put_text(bytes, kNameAt, kNameBytes, machine.name);
  std::memcpy(bytes.data() + kHeaderBytes, values.data(), 8 * values.size());
  put(bytes, kChecksumAt, checksum(bytes.data(), bytes.size()));
  return bytes;
}

/// Channels, and what each does to the tool point at the far end of its range, by itself and by its lags: the sum over
/// all factors that it is part of, others at the far end of theirs.
void state_channels(const Machine& machine, const FrozenStatePlan& plan, const std::vector<double>& largest,
                    FrozenCompensation& result) {
  const auto farthest = [&](std::size_t state) {
    if (state == kNoState) return 1.0;
    const StateRange& range = plan.ranges[state];
    const double reference = machine.states[state].reference;
    return std::max(std::abs(range.from - reference), std::abs(range.to - reference));
  };
  const auto channel_of = [&](std::size_t state) {
    return state != kNoState && machine.states[state].kind == StateKind::lag ? machine.states[state].first : state;
  };
  for (const std::size_t state : plan.states) {
    if (machine.states[state].kind != StateKind::measured) continue;
    FrozenCompensation::Channel channel{state, plan.ranges[state], 0};
    for (std::size_t j = 0; j < plan.factors.size(); ++j) {
      const FrozenStatePlan::Product& factor = plan.factors[j];
      if (channel_of(factor.first) != state && channel_of(factor.second) != state) continue;
      channel.largest += largest[j] * farthest(factor.first) * farthest(factor.second);
    }
    result.channels.push_back(channel);
  }
}

/// Couplings with which the calls cannot find the commands: turns come before shifts, and what takes no correction has
/// to keep its command.
std::string problem_of_couplings(const Machine& machine) {
  if (machine.couplings.empty()) return {};
  if (machine.couplings.size() > frozen::kMostCouplings) return "more than 32 couplings";
  const Chosen chosen = choose_axes(machine);
  const auto is_in = [](const std::vector<std::size_t>& list, std::size_t axis) {
    return std::find(list.begin(), list.end(), axis) != list.end();
  };
  for (const AxisCoupling& coupling : machine.couplings) {
    const bool reaches = is_in(chosen.reaching, coupling.axis), of_reaches = is_in(chosen.reaching, coupling.of);
    const bool turns = is_in(chosen.turning, coupling.axis), of_turns = is_in(chosen.turning, coupling.of);
    const std::string &axis = machine.axes[coupling.axis].name, &of = machine.axes[coupling.of].name;
    if (of_reaches && !reaches) {
      return axis + " is coupled to " + of +
             ", which corrects the point and is computed last: a frozen compensation cannot use that";
    }
    if (!reaches && !turns && of_turns) {
      return axis + " is coupled to " + of + ", which corrects the orientation, but is not corrected itself";
    }
    if (std::abs(coupling.ratio) > frozen::kLargestRatio) return "the ratio of " + axis + " to " + of + " is too large";
  }
  return {};
}

std::string problem_of(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options) {
  const std::vector<MachineProblem> problems = find_problems(machine);
  if (!problems.empty()) return problems.front().text();
  if (machine.axes.size() > ABBE_RUNTIME_AXES) return "more than 16 axes";
  if (errors.composition.first_order) return "the errors are composed to first order only, to reproduce a paper";
  const auto parameters = static_cast<Eigen::Index>(errors.parameter_count());
  if (options.covariance.rows() != 0 &&
      (options.covariance.rows() != parameters || options.covariance.cols() != parameters)) {
    return "the covariance is not that of the parameters of the errors";
  }
  if (!(options.tool_length_min <= options.tool_length_max)) return "the range of tool lengths is empty";
  return problem_of_couplings(machine);
}

}  // namespace

FrozenCompensation freeze(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options) {
  FrozenCompensation result;
  result.problem = problem_of(machine, errors, options);
  if (!result.problem.empty()) return result;
  const FrozenStatePlan plan = plan_states(machine, errors, options, result.problem);
  if (!result.problem.empty()) return result;
  constexpr std::size_t kNone = FrozenStatePlan::kNone;
  const std::vector<FrozenFunctions> functions =
      frozen_functions(machine, motions_of(plan, errors, kNone, kNone), result.problem);
  if (!result.problem.empty()) return result;
  Writer out;
  write_machine(machine, errors, options, functions.size(), out);
  const CalibratedMachine calibrated = calibrated_machine(machine, constant_locations(errors));
  for (std::size_t i = 0; i < machine.axes.size(); ++i) write_axis(machine, errors, calibrated, i, out);
  if (!machine.couplings.empty()) write_couplings(machine, out);
  for (const FrozenFunctions& group : functions) out.all(group_values(group));
  if (plan.any()) {
    const std::vector<double> largest = largest_per_unit(machine, errors, plan, options);
    out.all(state_values(machine, errors, plan, functions, largest, result.problem));
    if (!result.problem.empty()) return result;
    state_channels(machine, plan, largest, result);
  }
  result.format = static_cast<int>(plan.any() ? frozen::kFormatWithStates : frozen::kFormatWithoutStates);
  if (!machine.couplings.empty()) result.format += static_cast<int>(frozen::kFormatsForCouplings);
  const std::vector<std::vector<double>> ends = corners(machine, plan);
  result.too_many_states = ends.empty() && options.covariance.size() > 0 && !options.covariance.isZero(0);
  const UncertaintyLattice uncertainty = uncertainty_lattice(machine, errors, options, ends);
  write_uncertainty(uncertainty, out);
  result.largest_uncertainty = uncertainty.largest;
  result.mean_uncertainty = uncertainty.mean;
  result.uncertainty_lattice = uncertainty.interpolation;
  std::vector<double> values = out.values();
  result.bytes = file_of(machine, options, values, result.format);
  survey_corrections(machine, errors, options, plan, result);
  // Before the file is tried: near singularities the calls go by them.
  values[frozen::kLargestCorrection] = result.largest_correction;
  values[frozen::kLargestCorrection + 1] = result.largest_correction_turn;
  if (result.problem.empty()) {
    result.bytes = file_of(machine, options, values, result.format);
    freeze_check(machine, errors, options, plan, result);
  }
  if (!result.problem.empty()) {
    result.bytes.clear();
    return result;
  }
  values[frozen::kAccuracy] = result.accuracy;
  values[frozen::kAccuracy + 1] = result.accuracy_turn;
  values[frozen::kWorstIterations] = result.worst_iterations;
  result.bytes = file_of(machine, options, values, result.format);
  std::memcpy(&result.checksum, result.bytes.data() + frozen::kChecksumAt, sizeof result.checksum);
  std::memcpy(&result.source_checksum, result.bytes.data() + frozen::kSourceAt, sizeof result.source_checksum);
  return result;
}

}  // namespace abbe
