#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>

#include "abbe/compensate/program/program_move.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Which axis of a machine each word of a program moves; Machine::npos: none.
struct WordAxes {
  std::array<std::size_t, kAxisWords> axis;

  WordAxes() { axis.fill(Machine::npos); }
  std::size_t of(AxisWord word) const { return axis[static_cast<std::size_t>(word)]; }
  /// True if a word moves that axis.
  bool moves(std::size_t index) const;
};

/// "X", "A", ...
const char* axis_word_text(AxisWord word);

/// Axes by the words' names, X Y Z A B C U V W.
WordAxes word_axes_by_name(const Machine& machine);

/// Words of a program to axis commands of the nominal machine. Thread-safe.
class WordKinematics {
 public:
  /// @param rest  [axes] commands of axes that no word moves, mm or rad; empty: zero
  WordKinematics(const Machine& machine, const WordAxes& words, std::vector<double> rest);

  /// False if X, Y, Z do not move three independent linear axes without a rotary one between them.
  bool has_tool_centre() const { return has_tool_centre_; }

  /// @param tool    functional point from the gauge point with the tool length in force, mm
  /// @param result  [axes] commands, mm or rad
  void axes(ProgramCoordinates coordinates, const Eigen::Vector3d& tool, const WordValues& words, double* result) const;

  const WordAxes& words() const { return words_; }

 private:
  void solve_point(const Eigen::Vector3d& tool, const WordValues& words, double* result) const;

  Machine machine_;
  WordAxes words_;
  std::vector<double> rest_;
  bool has_tool_centre_ = false;
  std::size_t first_ = 0;  ///< of the axes of X, Y, Z, the one nearest the workpiece
  Eigen::Matrix3d inverse_;
};

}  // namespace abbe
