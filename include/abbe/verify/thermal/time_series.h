#pragma once

#include <string>
#include <vector>

namespace abbe {

/// What one sensor read over time. Between two readings the value is taken to change in proportion to the time.
struct TimeSeries {
  std::string name;            ///< of the sensor: "X1", "air"
  std::vector<double> time;    ///< [n] s, increasing; one at least
  std::vector<double> values;  ///< [n] mm, rad or degC

  double from() const { return time.front(); }
  double to() const { return time.back(); }
  double duration() const { return time.back() - time.front(); }
};

/// Smallest and largest value over a time.
struct SeriesRange {
  double low = 0, high = 0;
  double low_at = 0, high_at = 0;  ///< s
  double value() const { return high - low; }
};

// In all of them a time is one within the readings, from() to to(), and a window is longer than 0 and not longer than
// the readings. All take O(n).

double value_at(const TimeSeries& series, double time);

/// Range from one time to a later one, with the values at both ends.
SeriesRange range_between(const TimeSeries& series, double from, double to);

/// Longest time between two readings that follow each other, of which a part lies between these times; 0: one reading.
double longest_gap(const TimeSeries& series, double from, double to);

/// Largest range within any window of that length. The range of a window is convex in the window's start between the
/// starts at which one of its ends meets a reading, so that it is largest at one of these starts.
double largest_range_within(const TimeSeries& series, double window);

/// Largest magnitude of the change from the beginning of any window of that length to its end.
double largest_change_over(const TimeSeries& series, double window);

/// Mean over the time from the first to the last reading; that of one reading is its value.
double mean_over_time(const TimeSeries& series);

/// a - b at the times at which both were read.
TimeSeries difference_of(const TimeSeries& a, const TimeSeries& b, const std::string& name);

}  // namespace abbe
