#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/machine/machine.h"

namespace abbe {

/// One move of all axes, and where the tool is behind it.
struct DrawnMove {
  std::array<double, kMaxAxes> command{};  ///< chain order, mm or rad, as the control has them
  Eigen::Vector3d point, direction;        ///< functional point (mm) and unit vector to the spindle, workpiece frame
  bool working = false;
  double time = 0;    ///< s, from the start
  double feed = 0;    ///< mm/min, 0: none
  double length = 0;  ///< mm at work, from the start
};

/// A tool path as a page plays it.
struct PathPicture {
  std::string title = "Path";
  std::string tool = "tool";                                      ///< "beam", "probe" or "tool"
  double tool_radius = 0, tool_length = 0, working_distance = 0;  ///< mm; 0: not stated
  std::vector<DrawnMove> moves;
  std::string note;
};

/// Block "path" of the data of a page; of more moves than `most` those are kept at which work begins or ends, and
/// evenly chosen ones.
nlohmann::json path_data(const Machine& machine, const PathPicture& path, std::size_t most = 4000);

}  // namespace abbe
