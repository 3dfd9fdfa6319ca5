#pragma once

#include <map>
#include <string>
#include <vector>

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

/// Words of axes as a user gives them, "C1=C": the name of an axis and its word in the program: a letter, or a name
/// that ends in "=" ("C1="). F, G, M, N, O, P, S and T mean something else in a program.
/// @param option  how the user calls them, for the error: "--word"
/// @throws InputError for another text, an axis that the machine does not have or that is named twice, and if two axes
///                    would have the same word
std::map<std::string, std::string> axis_words(const Machine& machine, const std::vector<std::string>& texts,
                                              const std::string& option);

/// NC program of a tool path: G21 G90, rapid moves G0, moves at work G1 between M3 and M5, dwells G4 P, M30.
/// @param commands  [steps][axes] mm or rad, as the control is to have them
std::string path_program(const Machine& machine, const ToolPath& path, const std::vector<std::vector<double>>& commands,
                         const PathProgramOptions& options = {});

/// CSV: step, point, region, beam, one column per axis, length_mm, feed_mm_per_min, dwell_s; all digits.
std::string path_csv(const Machine& machine, const ToolPath& path, const std::vector<std::vector<double>>& commands);

}  // namespace abbe
