#include "abbe/formats/readings/channel_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/readings/axis_columns.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/state.h"

namespace abbe {
namespace {

/// "state_degC, ..." of all states that a file may have.
std::string recordable_columns(const Machine& machine) {
  std::string names;
  for (const MachineState& state : machine.states) {
    if (is_input(state.kind)) names += (names.empty() ? "" : ", ") + state_column(state);
  }
  return names;
}

void require_increasing(const CsvValues& time, std::string_view text, const std::string& file) {
  for (std::size_t row = 1; row < time.numbers.size(); ++row) {
    const double before = time.numbers[row - 1], at = time.numbers[row];
    if (at > before) continue;
    throw InputError(
        {file, csv_line(text, row), 0, time.header},
        at == before ? fmt::format("{:.9g} s occurs twice", at) : fmt::format("{:.9g} s follows {:.9g} s", at, before),
        "times that increase; they must not restart at midnight");
  }
}

/// Why a reading gets no value, and what would help.
struct NoValue {
  std::string problem, expected;
};

NoValue no_value(const MachineState& state, const StateChannel& channel, const ChannelValue& value, double time) {
  const std::string gap = fmt::format("a gap of {} from {:.9g} s to {:.9g} s", channel.source, value.from, value.to);
  const std::string wider =
      fmt::format("largest_gap_s of at least {:.9g} for this file if a straight line across the gap is acceptable",
                  value.to - value.from);
  switch (value.status) {
    case ChannelStatus::in_gap:
      return {fmt::format("{} is not known at {:.9g} s, in {}", state.name, time, gap), wider};
    case ChannelStatus::after_gap:
      return {fmt::format("{} is not known at {:.9g} s, too soon after {}", state.name, time, gap),
              fmt::format("readings {:.9g} s behind the gap ({:g} time constants), or {}",
                          kLagMemory * state.time_constant, kLagMemory, wider)};
    case ChannelStatus::no_samples:
      if (!std::isfinite(time)) return {"is not a finite number", "the time of the reading"};
      return {fmt::format("{} is not known: {} has no value of it", state.name, channel.source), "values of it"};
    default:
      return {fmt::format("{} is not known at {:.9g} s: {} covers {:.9g} s to {:.9g} s", state.name, time,
                          channel.source, value.from, value.to),
              "a channel that covers all readings; nothing is extrapolated"};
  }
}

template <class ValueAt>
std::vector<double> values_over(const MachineState& state, const StateChannel& channel,
                                const std::vector<double>& time_s, const ReadingRows& rows, const ValueAt& value_at) {
  std::vector<double> values;
  values.reserve(time_s.size());
  for (std::size_t row = 0; row < time_s.size(); ++row) {
    const ChannelValue value = value_at(time_s[row]);
    if (value.status == ChannelStatus::known) {
      values.push_back(value.value);
      continue;
    }
    const NoValue why = no_value(state, channel, value, time_s[row]);
    const std::string of_reading = rows.counted.empty() ? "" : fmt::format("{} {}: ", rows.counted, row);
    throw InputError({rows.file, rows.line ? rows.line(row) : 0, 0, rows.time_column}, of_reading + why.problem,
                     why.expected);
  }
  return values;
}

}  // namespace

std::string uncertain_start_words(const Machine& machine, const UncertainStart& start) {
  const MachineState& lag = machine.states.at(start.state);
  const double passed = start.first_reading_s - start.first_sample_s;
  return fmt::format(
      "{} is taken to be in equilibrium with {} at {:.9g} s, where {} begins; the first reading is {:.6g} s later, at "
      "which {:.0f} % of a wrong start remain (time constant {:.6g} s); expected a record that begins {:.6g} s before "
      "the readings, or lag_start.{}",
      lag.name, machine.states.at(lag.first).name, start.first_sample_s, start.source, passed,
      100 * std::exp(-passed / lag.time_constant), lag.time_constant, kLagMemory * lag.time_constant,
      state_column(lag));
}

const StateChannel* StateChannels::of(std::size_t state) const {
  const auto found = channels_.find(state);
  return found == channels_.end() ? nullptr : &found->second;
}

std::pair<double, double> StateChannels::common_time() const {
  constexpr double kEver = std::numeric_limits<double>::infinity();
  std::pair<double, double> common = {-kEver, kEver};
  for (const auto& [state, channel] : channels_) {
    common.first = std::max(common.first, channel.time_s.empty() ? kEver : channel.time_s.front());
    common.second = std::min(common.second, channel.time_s.empty() ? -kEver : channel.time_s.back());
  }
  return common;
}

void StateChannels::add(std::string_view text, const std::string& file, const Machine& machine,
                        const ChannelFile& description) {
  std::vector<CsvColumn> wanted = {{"time", Quantity::time, false, true, CsvColumn::Range::any}};
  std::size_t column = add_state_columns(machine, wanted);
  for (std::size_t i = column; i < wanted.size(); ++i) wanted[i].may_be_empty = true;
  const CsvTable table = read_csv(text, file, wanted, description.mapping);
  require_increasing(table.columns.front(), text, file);
  bool any = false;
  for (std::size_t j = 0; j < machine.states.size(); ++j) {
    if (!is_input(machine.states[j].kind)) continue;
    const CsvValues& values = table.columns[column++];
    if (!values.present) continue;
    any = true;
    if (const StateChannel* other = of(j)) {
      throw InputError({file, 0, 0, values.header}, fmt::format("{} has a column of it too", other->source),
                       "one file for each state");
    }
    channels_.emplace(j, make_channel(file, table.columns.front().numbers, values.numbers, description.largest_gap_s));
  }
  if (!any) {
    const std::string known = recordable_columns(machine);
    throw InputError({.file = file}, "has no column of a state",
                     known.empty() ? "states of kind \"measured\" in the machine file" : known);
  }
}

void StateChannels::start_lags(const Machine& machine, const std::map<std::size_t, double>& lag_start) {
  for (const auto& [state, value] : lag_start) {
    const MachineState& lag = machine.states.at(state);
    if (lag.kind != StateKind::lag || of(state) != nullptr || of(lag.first) == nullptr) {
      throw InputError({.field = "lag_start." + state_column(lag)}, "is not computed from a channel",
                       lag.kind == StateKind::lag
                           ? fmt::format("a file with a column {} and none of {}",
                                         state_column(machine.states.at(lag.first)), state_column(lag))
                           : "a state of kind \"lag\"");
    }
    lag_start_[state] = value;
  }
}

void StateChannels::give(const Machine& machine, const std::vector<double>& time_s, const ReadingRows& rows,
                         PoseList& poses, std::vector<UncertainStart>* starts) const {
  if (empty()) return;
  std::vector<std::vector<double>>& states = poses.state;
  states.resize(machine.states.size());
  for (const auto& [state, channel] : channels_) {
    if (states[state].empty()) continue;
    throw InputError({rows.file, 0, 0, state_column(machine.states[state])},
                     fmt::format("is given here and in {}", channel.source), "only one of them");
  }
  if (time_s.empty()) {
    throw InputError({rows.file, 0, 0, "time"}, "missing column",
                     fmt::format("time_s, time_min or time_h, at which {} is to be taken from {}",
                                 machine.states[channels_.begin()->first].name, channels_.begin()->second.source));
  }
  for (std::size_t j = 0; j < machine.states.size(); ++j) {
    const MachineState& state = machine.states[j];
    const StateChannel* own = of(j);
    if (own != nullptr) {
      states[j] = values_over(state, *own, time_s, rows, [own](double time) { return channel_value(*own, time); });
      continue;
    }
    const StateChannel* input = state.kind == StateKind::lag && states[j].empty() ? of(state.first) : nullptr;
    if (input == nullptr) continue;
    const auto start = lag_start_.find(j);
    const bool stated = start != lag_start_.end();
    const LaggedChannel lag(*input, state.time_constant, stated ? std::optional(start->second) : std::nullopt);
    states[j] = values_over(state, *input, time_s, rows, [&lag](double time) { return lag.at(time); });
    if (stated || starts == nullptr || time_s.empty()) continue;
    const UncertainStart begins{j, input->source, input->time_s.front(),
                                *std::min_element(time_s.begin(), time_s.end())};
    if (begins.first_reading_s - begins.first_sample_s < kLagMemory * state.time_constant) starts->push_back(begins);
  }
}

StateChannels read_channels(const Machine& machine, const ChannelPlan& of_study, const ChannelPlan& of_setup) {
  StateChannels channels;
  for (const ChannelPlan* plan : {&of_study, &of_setup}) {
    for (const ChannelFile& description : plan->files) {
      const MappedFile file(description.file);
      channels.add(file.text(), description.file.string(), machine, description);
    }
  }
  std::map<std::size_t, double> lag_start = of_study.lag_start;
  for (const auto& [state, value] : of_setup.lag_start) lag_start[state] = value;
  channels.start_lags(machine, lag_start);
  return channels;
}

}  // namespace abbe
