#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "abbe/compensate/tables/axis_table.h"
#include "abbe/formats/controls/table_axis_names.h"

namespace abbe {

/// Stored pitch error compensation of one axis: numbered points with a constant interval, whole numbers of a unit.
struct FanucPitch {
  std::size_t axis = 0;
  double interval = 0;              ///< between points, mm or rad
  std::size_t first_point = 0;      ///< number of the lowest point
  std::size_t reference_point = 0;  ///< number of the point at the reference position, where the correction is zero
  int magnification = 1;
  /// Change of the correction from the point below to this one, in magnification * unit; the first is 0.
  std::vector<int> steps;
  bool operator==(const FanucPitch&) const = default;
};

/// No step is larger: the magnification is raised instead.
inline constexpr int kFanucLargestStep = 7;
inline constexpr std::size_t kFanucPoints = 128;  ///< of one axis

/// Rounds a table to whole units, with the correction zero at the reference position of the control.
/// @param unit                detection unit, mm or rad
/// @param first_point         number of the lowest point
/// @param reference_position  a node of the table, mm or rad
FanucPitch fanuc_pitch(const AxisTable& table, double unit, std::size_t first_point, double reference_position);
/// What the control then adds, straight lines between points.
/// @param reference_position  of the control (its parameter 1240, which is not in the file); mm or rad
AxisTable fanuc_table(const FanucPitch& pitch, double unit, double reference_position);

/// Parameters of pitch error compensation and its data as a parameter file: "%", "N03624A1P50.0A2P20.0" with parameters
/// 3620 (reference point), 3621, 3622 (lowest and highest point), 3623 (magnification), 3624
/// (interval; mm or degrees), "N10000P-3" with 10000 + the number of the point, "%".
/// Source: FANUC Series 15i/150i-MODEL A Parameter Manual B-63330EN/03, "Inputting and outputting parameters", for the
/// form of the blocks.
/// @param axes  named by their numbers: "1", "2"
std::string fanuc_pitch_text(const std::vector<FanucPitch>& pitches, const std::vector<TableAxisName>& axes);
/// @throws InputError
std::vector<FanucPitch> parse_fanuc_pitch(std::string_view text, const std::string& file,
                                          const std::vector<TableAxisName>& axes);

}  // namespace abbe
