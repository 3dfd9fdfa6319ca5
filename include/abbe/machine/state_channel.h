#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

// Values of measured states that were recorded over time, at times of their own, and lags behind them.

namespace abbe {

/// After so many time constants a lag has forgotten what was before but for 5 % of it (exp(-3)).
inline constexpr double kLagMemory = 3;

/// What was recorded of one state. Between two samples it is taken to change in proportion to the time.
struct StateChannel {
  std::string source;          ///< where it was recorded, for messages: "temperatures.csv"
  std::vector<double> time_s;  ///< [n] increasing
  std::vector<double> value;   ///< [n] finite, in the unit of the state
  /// [n - 1] 1: too little is known between this sample and the next to take a straight line; empty: nowhere.
  std::vector<std::uint8_t> gap_after{};
};

/// Why a channel has no value at a time.
enum class ChannelStatus {
  no_samples,  ///< nothing was recorded, or the time is not finite: no value has been looked for
  known,
  before,    ///< the time is before the first sample
  after,     ///< behind the last sample
  in_gap,    ///< between two samples that must not be joined
  after_gap  ///< lags: within kLagMemory time constants behind such a gap
};

struct ChannelValue {
  ChannelStatus status = ChannelStatus::no_samples;
  double value = 0;         ///< in the unit of the state; only if it is known
  double from = 0, to = 0;  ///< s; in_gap, after_gap: the gap; before, after: what the samples cover
};

/// Value of a channel at a time, O(log n). Nothing is extrapolated; a time that differs from that of the first or last
/// sample only by rounding (1e-12 of the larger of both) counts as it.
ChannelValue channel_value(const StateChannel& channel, double time_s);

/// A channel behind a first-order lag (FirstOrderLag), at any time: exact for the straight lines between the samples.
class LaggedChannel {
 public:
  /// @param channel  must outlive this object
  /// @param start    value of the lag at the first sample; not given: in equilibrium there
  LaggedChannel(const StateChannel& channel, double time_constant_s, std::optional<double> start = std::nullopt);

  /// O(log n). Lags over a gap as if it were a straight line, and gives no value in it or shortly behind it.
  ChannelValue at(double time_s) const;

 private:
  const StateChannel& channel_;
  double time_constant_;
  std::vector<double> at_sample_;      ///< [n] value of the lag
  std::vector<std::size_t> last_gap_;  ///< [n] interval of the last gap before the sample, or -1
};

/// Marks as gaps what is longer than `largest_gap_s`.
///
/// @param largest_gap_s  s, above 0; not given: 10 times the median time between rows, and no value may be missing
/// @param row_time_s  [rows] increasing: the times of all rows of the record
/// @param row_value   [rows] NaN where a row has no value of this channel
StateChannel make_channel(std::string source, const std::vector<double>& row_time_s,
                          const std::vector<double>& row_value, std::optional<double> largest_gap_s);

/// Largest gap where none is stated: 10 times the median time between rows, s; infinite for fewer than three rows.
double usual_largest_gap(const std::vector<double>& row_time_s);

}  // namespace abbe
