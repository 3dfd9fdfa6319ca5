#include "abbe/formats/readings/errors_over_time.h"

#include <cmath>
#include <utility>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/formats/readings/channel_file.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {

std::vector<ErrorsAtTime> read_errors_over_time(const std::filesystem::path& errors, const Machine& machine,
                                                const std::vector<std::string>& states,
                                                const std::filesystem::path& channel) {
  const ErrorsFile file = read_errors(errors, machine, StatesOfErrors::allowed);
  const std::vector<double> fixed = state_options(machine, "--state", states);
  StateChannels channels;
  channels.add(MappedFile(channel).text(), channel.string(), machine, {});
  const auto [from, to] = channels.common_time();
  if (!(from <= to)) {
    throw InputError({.file = channel.string()}, "its columns have no time in common", "values in all columns");
  }
  const std::size_t count = from < to ? kTimesOfRecord : 1;
  std::vector<double> times;
  for (std::size_t k = 0; k < count; ++k) {
    times.push_back(count == 1 ? from : std::lerp(from, to, static_cast<double>(k) / static_cast<double>(count - 1)));
  }
  PoseList at_times;
  channels.give(machine, times, {channel.string(), "time"}, at_times);
  std::vector<ErrorsAtTime> result;
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double> values = fixed;
    for (std::size_t j = 0; j < values.size(); ++j) {
      if (!at_times.state[j].empty()) values[j] = at_times.state[j][k];
    }
    ErrorsFile there = at_given_states(machine, file, values, errors.string());
    result.push_back({times[k], std::move(there.at_state), std::move(there.errors)});
  }
  return result;
}

}  // namespace abbe
