#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "abbe/instruments/measurement_plan.h"
#include "abbe/machine/inverse_plan.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Numbers of an option such as "X_mm=0:1400:9", as they stand there.
struct AxisNumbers {
  std::size_t axis = 0;
  double unit = 1;              ///< of a position, in mm or rad
  std::vector<double> numbers;  ///< at least one
};

/// "AXIS_unit=a:b:..." with mm or deg.
/// @param option    how the user calls it, for the error: "--grid"
/// @param expected  what he should have written
/// @throws InputError
AxisNumbers axis_numbers_option(const Machine& machine, const std::string& option, const std::string& text,
                                const std::string& expected);

/// "C2_deg=30": an axis and its command, mm or rad. Whether it lies within the travel is not looked at.
/// @param option  how the user calls it, for the error: "--hold"
/// @throws InputError
HeldAxis axis_option(const Machine& machine, const std::string& option, const std::string& text);

/// The same for an option that may be given several times.
std::vector<HeldAxis> axis_options(const Machine& machine, const std::string& option,
                                   const std::vector<std::string>& texts);

/// Axes by their names, as an option that may be given several times has them.
/// @param option  how the user calls it, for the error: "--hold"
/// @throws InputError for a name that the machine does not have
std::vector<std::size_t> axes_named(const Machine& machine, const std::string& option,
                                    const std::vector<std::string>& names);

/// "X_mm=-100:100" or "C_deg=30": a range of --range, or a position, within the travel.
/// @param ranges  [axes] mm or rad; that of the axis is set
/// @throws InputError
void take_range_option(const Machine& machine, const std::string& text, std::vector<std::optional<AxisRange>>& ranges);

/// "X_mm=0:1400:9" or "C_deg=30": from, to and count of --grid, or a position. Whether they lie within the travel is
/// not looked at.
/// @param grid  [axes] mm or rad; that of the axis is set
/// @throws InputError also for an axis that has a range already
void take_grid_option(const Machine& machine, const std::string& text, std::vector<std::optional<AxisRange>>& grid);

}  // namespace abbe
