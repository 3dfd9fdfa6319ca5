#pragma once

#include <map>
#include <string>

#include "abbe/machine/tool_path.h"

namespace abbe {

struct PathProgramOptions {
  int decimals = 6;                          ///< of mm and degrees
  std::map<std::string, std::string> words;  ///< name of an axis -> its word in the program: {"C1", "C"}
  bool inverse_time =
      true;  ///< G93: one F per block, so that the feed along the curve is kept; else G94 and F as given
  std::vector<std::string> comments;  ///< at the top, one line each
};

/// The word of an axis: its letter; "C1=" where the name has a number and no other word is given.
std::string axis_word(const std::string& name, const PathProgramOptions& options);

/// NC program of a tool path: G21 G90, rapid moves G0, moves at work G1 between M3 and M5, dwells G4 P, M30.
/// @param commands  [steps][axes] mm or rad, as the control is to have them
std::string path_program(const Machine& machine, const ToolPath& path, const std::vector<std::vector<double>>& commands,
                         const PathProgramOptions& options = {});

/// CSV: step, point, region, beam, one column per axis, length_mm, feed_mm_per_min, dwell_s; all digits.
std::string path_csv(const Machine& machine, const ToolPath& path, const std::vector<std::vector<double>>& commands);

}  // namespace abbe
