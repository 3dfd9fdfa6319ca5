#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/errors/basis.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/machine/machine.h"

namespace abbe {

struct Study;
struct StudyResult;

/// Positions of one axis, mm or rad.
struct PositionRange {
  double from = 0;
  double to = 0;
  bool operator==(const PositionRange&) const = default;
};

/// Over which positions the error motions of one axis are stated, and why. Mm or rad.
struct AxisCoverage {
  std::size_t axis = 0;    ///< index into Machine::axes
  PositionRange wanted;    ///< what the study asks for; without a word of it the travel
  PositionRange measured;  ///< from the first to the last reading
  PositionRange stated;    ///< where the error motions are valid

  /// True if the error motions are stated beyond the outermost readings.
  bool is_extended() const { return stated.from < measured.from || stated.to > measured.to; }
  /// True if part of what was asked for is not covered.
  bool is_part() const { return stated.from > wanted.from || stated.to < wanted.to; }
};

/// Range of an error motion of which readings are known at some positions only.
///
/// A function found from readings is stated up to the end that the study asks for where the gap to the outermost
/// reading is at most `margin` of the range of the readings; else it ends at that reading. At the end of a spline or a
/// table the gap may also be no more than half an interval, else no reading would say anything about its last function.
/// @param wanted    basis over the range that the study asks for
/// @param measured  from the first to the last reading, mm or rad
/// @param margin    fraction of the range of the readings, not below 0
PositionRange stated_range(const Basis& wanted, const PositionRange& measured, double margin);

/// What there is to say of the ranges, a sentence for each axis whose errors are stated beyond the readings or over a
/// part of what the study asks for. With the expanded uncertainty at an end beyond the readings if there is a result.
std::vector<std::string> coverage_sentences(const Study& study, const StudyResult& result);

/// That a map's positions of one axis were moved to where the errors are known.
std::string moved_range_sentence(const Axis& axis, const AxisRange& wanted, const AxisRange& known);

/// Ranges of all axes for programs: see docs/report-data.md, `ranges`.
nlohmann::ordered_json coverage_json(const Study& study, const StudyResult& result);

}  // namespace abbe
