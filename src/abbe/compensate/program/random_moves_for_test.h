#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "abbe/compensate/program/move_splitting.h"
#include "abbe/compensate/program/program_moves_for_test.h"

namespace abbe::test {

/// Random move in words of the wanted coordinates, a straight line or an arc, of any length.
inline ProgramMove random_move(const Machine& machine, const WordKinematics& kinematics, ProgramCoordinates coordinates,
                               std::mt19937_64& generator) {
  std::uniform_real_distribution<double> exponent(-4, 0);
  const WordAxes& words = kinematics.words();
  ProgramMove move;
  move.kind = MoveKind::straight;
  move.coordinates = coordinates;
  if (generator() % 3 == 0) move.tool_length = {0, 0, 60};
  const auto to_words = [&](const WordValues& axis_words) {
    if (coordinates == ProgramCoordinates::axes) return axis_words;
    const ControlledMachine control(machine, {}, words);
    ProgramMove on_axes = move;
    on_axes.coordinates = ProgramCoordinates::axes;
    WordValues result = axis_words;
    const Eigen::Vector3d point = control.pose(on_axes, axis_words, false).translation;
    for (std::size_t i = 0; i < 3; ++i) result[i] = point[static_cast<Eigen::Index>(i)];
    return result;
  };
  const WordValues a = random_axis_words(machine, words, generator);
  WordValues b = random_axis_words(machine, words, generator);
  if (generator() % 3 == 0) {
    for (std::size_t i = 3; i < 6; ++i) b[i] = a[i];  // three-axis motion
  }
  move.start = to_words(a);
  move.end = to_words(between(a, b, std::pow(10, exponent(generator))));
  if (generator() % 3 == 0) {
    move.kind = generator() % 2 == 0 ? MoveKind::arc_clockwise : MoveKind::arc_counterclockwise;
    move.plane = static_cast<ArcPlane>(generator() % 3);
    std::normal_distribution<double> normal;
    // A centre on the perpendicular bisector of the chord, in the plane.
    const std::size_t first = move.plane == ArcPlane::XY ? 0 : move.plane == ArcPlane::ZX ? 2 : 1;
    const std::size_t second = (first + 1) % 3;
    const double x = move.end[first] - move.start[first], y = move.end[second] - move.start[second];
    const double away = normal(generator);
    if (words.axis[first] == Machine::npos || words.axis[second] == Machine::npos) {
      move.kind = MoveKind::straight;
      return move;
    }
    move.arc_centre[first] = 0.5 * (move.start[first] + move.end[first]) - away * y;
    move.arc_centre[second] = 0.5 * (move.start[second] + move.end[second]) + away * x;
  }
  return move;
}

/// Largest |actual - commanded| between the ends of a piece, both at the same share.
inline void sample_piece(const ControlledMachine& control, const ProgramMove& move, const CorrectedNode& a,
                         const CorrectedNode& b, double s0, double s1, double& point, double& direction) {
  const MovePath path(move);
  constexpr int kSamples = 12;
  for (int j = 1; j < kSamples; ++j) {
    const double t = static_cast<double>(j) / kSamples;
    WordValues wanted;
    path.at(s0 + (s1 - s0) * t, wanted);
    const RigidTransform commanded = control.pose(move, wanted, false);
    const RigidTransform actual = control.pose(move, between(a.corrected, b.corrected, t), true);
    point = std::max(point, control.point_missed(actual, commanded));
    direction = std::max(direction, control.direction_missed(actual, commanded));
  }
}

/// A random move in one piece: its bound, and the largest that samples of it miss.
struct SampledMove {
  bool is_arc = false;
  PieceBound bound;
  double point = 0, direction = 0;  ///< mm, rad
  double ends = 0;                  ///< rad, by which the directions at the ends are missed
};

/// @returns nothing where the ends of the move are not reached
inline std::optional<SampledMove> sample_random_move(const Machine& machine, NodeCorrection& correction,
                                                     const PieceBounder& bounder, const ControlledMachine& control,
                                                     ProgramCoordinates coordinates, std::mt19937_64& generator) {
  const ProgramMove move = random_move(machine, correction.kinematics(), coordinates, generator);
  const std::size_t tool = correction.tool(move.tool_length);
  const MovePath path(move);
  std::array<CorrectedNode, 2> nodes;
  nodes[0].words = move.start;
  nodes[1].words = move.end;
  correction.correct(coordinates, tool, nodes);
  if (!nodes[0].point_reached() || !nodes[1].point_reached()) return std::nullopt;
  const MovePiece piece{&nodes[0], &nodes[1], path.is_arc() ? &path : nullptr, 1};
  SampledMove sampled;
  sampled.is_arc = path.is_arc();
  sampled.bound = bound_pieces(bounder, machine.axes.size(), coordinates, correction.tool_point(tool), {&piece, 1});
  sample_piece(control, move, nodes[0], nodes[1], 0, 1, sampled.point, sampled.direction);
  sampled.ends = std::max(nodes[0].orientation_left, nodes[1].orientation_left);
  return sampled;
}

}  // namespace abbe::test
