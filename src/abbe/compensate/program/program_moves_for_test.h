#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "abbe/compensate/program/move_path.h"
#include "abbe/compensate/program/word_axes.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_errors.h"
#include "abbe/machine/machine.h"

namespace abbe::test {

/// Axis commands of a control's own kinematics for words.
/// @param machine  with the tool length that is in force
inline std::vector<double> commanded_axes(const Machine& machine, const WordAxes& word_axes,
                                          ProgramCoordinates coordinates, const WordValues& words) {
  std::vector<double> axes(machine.axes.size(), 0.0);
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    if (word_axes.axis[i] != Machine::npos) axes[word_axes.axis[i]] = words[i];
  }
  if (coordinates == ProgramCoordinates::axes) return axes;
  // The nominal point is linear in X, Y, Z.
  for (std::size_t i = 0; i < 3; ++i) axes[word_axes.axis[i]] = 0;
  const Eigen::Vector3d zero = nominal_workpiece_from_tool(machine, axes).translation;
  Eigen::Matrix3d by_axis;
  for (std::size_t i = 0; i < 3; ++i) {
    axes[word_axes.axis[i]] = 1;
    by_axis.col(static_cast<Eigen::Index>(i)) = nominal_workpiece_from_tool(machine, axes).translation - zero;
    axes[word_axes.axis[i]] = 0;
  }
  const Eigen::Vector3d solved = by_axis.inverse() * (Eigen::Vector3d(words[0], words[1], words[2]) - zero);
  for (std::size_t i = 0; i < 3; ++i) axes[word_axes.axis[i]] = solved[static_cast<Eigen::Index>(i)];
  return axes;
}

/// A machine with errors behind a control that interpolates words: an independent route to where the tool goes.
class ControlledMachine {
 public:
  ControlledMachine(const Machine& machine, const ErrorSet& errors, const WordAxes& words)
      : machine_(machine), errors_(errors), words_(words) {}

  /// Pose of the nominal (errors: actual) tool where the control commands those words.
  RigidTransform pose(const ProgramMove& move, const WordValues& words, bool with_errors) const {
    Machine machine = machine_;
    machine.tool_offset -= Eigen::Vector3d(move.tool_length[0], move.tool_length[1], move.tool_length[2]);
    const std::vector<double> axes = commanded_axes(machine, words_, move.coordinates, words);
    return with_errors ? actual_workpiece_from_tool(machine, errors_, axes)
                       : nominal_workpiece_from_tool(machine, axes);
  }

  double point_missed(const RigidTransform& a, const RigidTransform& b) const {
    return (a.translation - b.translation).norm();
  }
  double direction_missed(const RigidTransform& a, const RigidTransform& b) const {
    const Eigen::Vector3d one = a.rotation * machine_.tool_direction, other = b.rotation * machine_.tool_direction;
    return (one - other).norm();
  }

 private:
  Machine machine_;
  ErrorSet errors_;
  WordAxes words_;
};

/// Words and feeds of all pieces of moves that are given in batches, one after the other.
inline std::vector<double> numbers_in_batches(MoveCorrector& correction, const std::vector<ProgramMove>& moves,
                                              std::size_t batch) {
  std::vector<double> numbers;
  CorrectedPieces corrected;
  for (std::size_t i = 0; i < moves.size(); i += batch) {
    correction.correct({moves.data() + i, std::min(batch, moves.size() - i)}, corrected);
    for (const CorrectedPiece& piece : corrected.pieces) {
      numbers.insert(numbers.end(), piece.end.begin(), piece.end.end());
      numbers.push_back(piece.feed);
    }
    EXPECT_EQ(corrected.first.back(), corrected.pieces.size());
  }
  return numbers;
}

inline WordValues between(const WordValues& a, const WordValues& b, double s) {
  WordValues words;
  for (std::size_t i = 0; i < kAxisWords; ++i) words[i] = a[i] + s * (b[i] - a[i]);
  return words;
}

/// Words by name; axes with a number get their letter or another free word of their kind.
inline WordAxes words_of(const Machine& machine) {
  WordAxes words = word_axes_by_name(machine);
  for (std::size_t axis = machine.axes.size(); axis-- > 0;) {
    if (words.moves(axis)) continue;
    const bool rotary = machine.axes[axis].kind == AxisKind::rotary;
    std::size_t chosen = kAxisWords;
    for (std::size_t i = kAxisWords; i-- > 0;) {
      if ((i >= 3 && i < 6) != rotary || words.axis[i] != Machine::npos) continue;
      if (chosen == kAxisWords || machine.axes[axis].name[0] == axis_word_text(static_cast<AxisWord>(i))[0]) chosen = i;
    }
    if (chosen < kAxisWords) words.axis[chosen] = axis;
  }
  return words;
}

/// Errors of tens of micrometres and microradians in every error motion, in bases of all kinds.
inline ErrorSet mixed_errors(const Machine& machine, std::uint64_t seed) {
  RandomErrorOptions options;
  options.seed = seed;
  options.translation_um = 20;
  options.rotation_urad = 40;
  options.location_um = 30;
  options.location_urad = 60;
  ErrorSet errors = random_errors(machine, options);
  std::mt19937_64 generator(seed + 1);
  std::normal_distribution<double> normal;
  for (ErrorMotion& motion : errors.motions) {
    const Axis& axis = machine.axes[motion.axis];
    const double size = is_rotation(motion.component) ? 20e-6 : 0.01;
    double from = axis.travel_min, to = axis.travel_max;
    if (axis.endless || !(to > from)) {
      from = -7;
      to = 7;
    }
    Basis basis;
    basis.from = from;
    basis.to = to;
    std::size_t smooth = 1;
    switch (generator() % 7) {
      case 0:
        continue;  // as random_errors() has it
      case 1:
        basis.kind = BasisKind::chebyshev;
        basis.order = 7;
        break;
      case 2:
        basis.kind = BasisKind::monomial;
        basis.order = 4;
        break;
      case 3:
        basis.kind = BasisKind::fourier;
        basis.order = 3;
        basis.period = axis.kind == AxisKind::rotary ? 2 * 3.14159265358979323846 : (to - from) / 2.5;
        break;
      case 4:
        basis.kind = BasisKind::bspline;
        basis.order = 9;
        basis.periodic = axis.endless;
        if (axis.endless) basis.period = 2 * 3.14159265358979323846;
        break;
      default:
        basis.kind = generator() % 2 == 0 ? BasisKind::table_linear : BasisKind::table_monotone;
        for (int k = 0; k <= 12; ++k) basis.nodes.push_back(from + (to - from) * k / 12);
        basis.nodes.back() = to;
        if (axis.endless) {
          basis.kind = BasisKind::table_linear;
          basis.periodic = true;
          basis.period = 2 * 3.14159265358979323846;
          basis.nodes = {-3, -1.7, -0.2, 0.4, 1.9, 2.5};
          basis.from = basis.nodes.front();
          basis.to = basis.nodes.back();
        }
        smooth = 3;
        break;
    }
    std::vector<double> values(basis.size());
    for (double& value : values) value = size * normal(generator) / static_cast<double>(smooth);
    if (basis.kind == BasisKind::chebyshev || basis.kind == BasisKind::monomial) {
      for (std::size_t k = 0; k < values.size(); ++k) values[k] /= 1 + static_cast<double>(k);
    }
    motion.basis = basis;
    motion.coefficients = values;
    motion.standard_uncertainty.clear();
  }
  errors.tool_offset_error = {0.01, -0.02, 0.015};
  return errors;
}

/// Words that are axis positions within the travel, all axes in the middle part of it.
inline WordValues random_axis_words(const Machine& machine, const WordAxes& words, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform(-0.8, 0.8);
  WordValues values{};
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    if (words.axis[i] == Machine::npos) continue;
    const Axis& axis = machine.axes[words.axis[i]];
    const bool turns = axis.endless || !(axis.travel_max > axis.travel_min);
    const double middle = turns ? 0 : 0.5 * (axis.travel_min + axis.travel_max);
    const double half = turns ? 6 : 0.5 * (axis.travel_max - axis.travel_min);
    values[i] = middle + half * uniform(generator);
  }
  return values;
}

}  // namespace abbe::test
