#include "abbe/machine/state_channel.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "abbe/machine/first_order_lag.h"

namespace abbe {
namespace {

// Times of two files may be written in different units.
constexpr double kSameTime = 1e-12;

constexpr double kUsualIntervals = 10;

constexpr std::size_t kNoGap = static_cast<std::size_t>(-1);

bool is_gap(const StateChannel& channel, std::size_t interval) {
  return interval < channel.gap_after.size() && channel.gap_after[interval] != 0;
}

/// A time within the samples.
struct TimeInChannel {
  ChannelValue outside;      ///< what there is to say if no value is known
  std::size_t interval = 0;  ///< from this sample to the next; the last sample: its own index
  double time = 0;
};

TimeInChannel find_time(const StateChannel& channel, double time) {
  TimeInChannel found;
  const std::vector<double>& times = channel.time_s;
  if (times.empty() || !std::isfinite(time)) return found;
  const double first = times.front(), last = times.back();
  const auto same = [&](double end) {
    return std::abs(time - end) <= kSameTime * std::max(std::abs(time), std::abs(end));
  };
  found.time = time < first && same(first) ? first : time > last && same(last) ? last : time;
  if (found.time < first || found.time > last) {
    found.outside = {found.time < first ? ChannelStatus::before : ChannelStatus::after, 0, first, last};
    return found;
  }
  const auto next = std::upper_bound(times.begin(), times.end(), found.time);
  found.interval = static_cast<std::size_t>(next - times.begin()) - 1;
  found.outside.status = ChannelStatus::known;
  // A sample itself is known, whatever lies beside it.
  if (is_gap(channel, found.interval) && found.time > times[found.interval]) {
    found.outside = {ChannelStatus::in_gap, 0, times[found.interval], times[found.interval + 1]};
  }
  return found;
}

double straight(const StateChannel& channel, std::size_t interval, double time) {
  const double before = channel.value[interval];
  if (time == channel.time_s[interval]) return before;
  const double share = (time - channel.time_s[interval]) / (channel.time_s[interval + 1] - channel.time_s[interval]);
  return std::lerp(before, channel.value[interval + 1], share);
}

}  // namespace

ChannelValue channel_value(const StateChannel& channel, double time_s) {
  const TimeInChannel found = find_time(channel, time_s);
  ChannelValue result = found.outside;
  if (result.status == ChannelStatus::known) result.value = straight(channel, found.interval, found.time);
  return result;
}

LaggedChannel::LaggedChannel(const StateChannel& channel, double time_constant_s, std::optional<double> start)
    : channel_(channel), time_constant_(time_constant_s) {
  assert(time_constant_s > 0 && channel.value.size() == channel.time_s.size());
  if (channel.value.empty()) return;
  FirstOrderLag lag(time_constant_s, channel.value.front(), start.value_or(channel.value.front()));
  at_sample_.push_back(lag.value());
  last_gap_.push_back(kNoGap);
  for (std::size_t k = 1; k < channel.value.size(); ++k) {
    at_sample_.push_back(lag.advance(channel.time_s[k] - channel.time_s[k - 1], channel.value[k]));
    last_gap_.push_back(is_gap(channel, k - 1) ? k - 1 : last_gap_.back());
  }
}

ChannelValue LaggedChannel::at(double time_s) const {
  const TimeInChannel found = find_time(channel_, time_s);
  ChannelValue result = found.outside;
  if (result.status != ChannelStatus::known) return result;
  // At the far end of a gap the sample is known, and the lag is not yet.
  const std::size_t gap = last_gap_[found.interval];
  if (gap != kNoGap && found.time - channel_.time_s[gap + 1] < kLagMemory * time_constant_) {
    return {ChannelStatus::after_gap, 0, channel_.time_s[gap], channel_.time_s[gap + 1]};
  }
  const FirstOrderLag lag(time_constant_, channel_.value[found.interval], at_sample_[found.interval]);
  result.value =
      lag.after(found.time - channel_.time_s[found.interval], straight(channel_, found.interval, found.time));
  return result;
}

double usual_largest_gap(const std::vector<double>& row_time_s) {
  if (row_time_s.size() < 3) return std::numeric_limits<double>::infinity();
  std::vector<double> steps;
  for (std::size_t k = 1; k < row_time_s.size(); ++k) steps.push_back(row_time_s[k] - row_time_s[k - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return kUsualIntervals * *middle;
}

StateChannel make_channel(std::string source, const std::vector<double>& row_time_s,
                          const std::vector<double>& row_value, std::optional<double> largest_gap_s) {
  assert(row_time_s.size() == row_value.size());
  StateChannel channel;
  channel.source = std::move(source);
  const double largest = largest_gap_s ? *largest_gap_s : usual_largest_gap(row_time_s);
  bool missing = false;
  for (std::size_t row = 0; row < row_time_s.size(); ++row) {
    if (std::isnan(row_value[row])) {
      missing = true;
      continue;
    }
    if (!channel.time_s.empty()) {
      const bool too_long = row_time_s[row] - channel.time_s.back() > largest;
      channel.gap_after.push_back(too_long || (missing && !largest_gap_s) ? 1 : 0);
    }
    channel.time_s.push_back(row_time_s[row]);
    channel.value.push_back(row_value[row]);
    missing = false;
  }
  return channel;
}

}  // namespace abbe
