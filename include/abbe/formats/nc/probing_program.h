#pragma once

#include <map>
#include <string>
#include <vector>

#include "abbe/machine/machine.h"

namespace abbe {

/// A move of a probing program: to a pose, or towards it until the probe touches.
struct ProbingMove {
  std::vector<double> pose;  ///< [axes] chain order, mm or rad
  bool touches = false;
};

/// Moves that belong together, with a comment.
struct ProbingStep {
  std::string words;
  std::vector<ProbingMove> moves;
};

struct ProbingProgramOptions {
  std::map<std::string, std::string> words;  ///< name of an axis -> its word, as axis_words() makes them
  int decimals = 6;                          ///< of mm and degrees
  double feed = 0;                           ///< mm/s, between touches; 0: rapid traverse
  double probing_feed = 1;                   ///< mm/s, towards the ball
  double dwell = 0;                          ///< s, standing still before every touch
  std::string log = "touches.txt";           ///< file that the control writes; letters, digits, '.', '-', '_'
  std::vector<std::string> comments;         ///< at the top, one line each
};

/// A probing program for LinuxCNC: G38.2 for touches, logged between PROBEOPEN and PROBECLOSE. The control stops with
/// an error where a touch does not come. Where the machine stands after a touch is not known, so the next move names
/// the axes that moved for it.
/// @throws InputError for an axis without a word, a feed of 0 after rounding to 0.001 mm/min, and a name of the log
///   with other characters than those above
std::string probing_program(const Machine& machine, const std::vector<ProbingStep>& steps,
                            const ProbingProgramOptions& options);

}  // namespace abbe
