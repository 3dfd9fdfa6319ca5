#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/machine/machine.h"

namespace abbe {

/// A touch of a ball by a touch-trigger probe.
struct PlannedTouch {
  std::vector<double> pose;  ///< [axes] mm or rad, where the probe should touch
  Eigen::Vector3d approach;  ///< unit vector, from the probe towards the ball, frame of the tool
  double within = 0;         ///< mm: by how much linear axes may stand elsewhere when it touches
  std::string item, point;   ///< name of the ball, or empty; of the touch
};

/// The touches of a probing program, in their order, as CSV.
std::string planned_touches_csv(const Machine& machine, const std::vector<PlannedTouch>& touches);

/// What planned_touches_csv() writes. @throws InputError
std::vector<PlannedTouch> parse_planned_touches(std::string_view text, const std::string& file, const Machine& machine);
std::vector<PlannedTouch> read_planned_touches(const std::filesystem::path& path, const Machine& machine);

/// Readings of a touch probe (`measure = "touch"`) from a log of LinuxCNC and the touches that its program planned:
/// the commands at which the probe touched, the approach, and a travel of zero. As CSV, in the form of readings.
///
/// Each line of the log has to belong to the touch of its place: the same positions of all axes that do not move for a
/// touch, to 1e-4 mm or degrees, and the linear axes no farther from where it should touch than `within`.
/// @param log    nine numbers in each line, X Y Z A B C U V W in mm and degrees
/// @param words  name of an axis -> its word in the program, where it is not its name
/// @throws InputError with the line of the log
std::string probed_touches_csv(const Machine& machine, const std::vector<PlannedTouch>& touches,
                               const std::string& touches_file, std::string_view log, const std::string& log_file,
                               const std::map<std::string, std::string>& words = {});

}  // namespace abbe
