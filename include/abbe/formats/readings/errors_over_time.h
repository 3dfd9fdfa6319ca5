#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// The errors of a machine at one time of a record.
struct ErrorsAtTime {
  double time_s = 0;
  StateValues at_state{};
  ErrorSet errors;
};

/// Number of times at which a record is looked at: every ten minutes of a day.
inline constexpr std::size_t kTimesOfRecord = 145;

/// The errors of a file as they are over the time that all channels of a record cover, at evenly spaced times with both
/// ends; one time if the record has one. Lags start in equilibrium at its beginning.
/// @param states   texts of --state, for states that the record does not have
/// @param channel  CSV as StateChannels::add() takes it
/// @throws InputError as read_errors_at(), for a gap in the record and channels that have no time in common
std::vector<ErrorsAtTime> read_errors_over_time(const std::filesystem::path& errors, const Machine& machine,
                                                const std::vector<std::string>& states,
                                                const std::filesystem::path& channel);

}  // namespace abbe
