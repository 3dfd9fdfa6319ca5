#include "abbe/compensate/program/move_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace abbe {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
// rad; a smaller arc is a full circle, as in LinuxCNC: start and end are the same but for rounding.
constexpr double kSmallestArc = 1e-6;
// mm or rad; less is no motion to a control.
constexpr double kNoMotion = kNoMotion_mm;

double length(const WordValues& a, const WordValues& b, std::size_t first) {
  double sum = 0;
  for (std::size_t i = first; i < first + 3; ++i) {
    const double d = b[i] - a[i];
    if (std::abs(d) > kNoMotion) sum += d * d;
  }
  return std::sqrt(sum);
}

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// X, Y, Z of words from a point.
std::array<double, 3> difference(const WordValues& words, const std::array<double, 3>& from) {
  return {words[0] - from[0], words[1] - from[1], words[2] - from[2]};
}

/// What of a vector is at right angles to a normal of length one.
std::array<double, 3> across(const std::array<double, 3>& vector, const std::array<double, 3>& normal) {
  const double along = dot(vector, normal);
  return {vector[0] - along * normal[0], vector[1] - along * normal[1], vector[2] - along * normal[2]};
}

}  // namespace

MovePath::MovePath(const ProgramMove& move) : move_(&move) {
  if (move.kind != MoveKind::arc_clockwise && move.kind != MoveKind::arc_counterclockwise) return;
  arc_ = true;
  tilted_ = move.plane == ArcPlane::tilted;
  double along = 0;  // the normal
  std::array<double, 3> normal{};
  if (tilted_) {
    normal = move.arc_normal;
    const std::array<double, 3> start = across(difference(move.start, move.arc_centre), normal);
    const std::array<double, 3> end = across(difference(move.end, move.arc_centre), normal);
    radius_ = std::sqrt(dot(start, start));
    radius_end_ = std::sqrt(dot(end, end));
    for (std::size_t k = 0; k < 3; ++k) outwards_[k] = radius_ > 0 ? start[k] / radius_ : 0;
    onwards_ = {normal[1] * outwards_[2] - normal[2] * outwards_[1],
                normal[2] * outwards_[0] - normal[0] * outwards_[2],
                normal[0] * outwards_[1] - normal[1] * outwards_[0]};
    set_turn(0, std::atan2(dot(end, onwards_), dot(end, outwards_)));
    along = dot(difference(move.end, {move.start[0], move.start[1], move.start[2]}), normal);
  } else {
    first_ = move.plane == ArcPlane::XY ? 0 : move.plane == ArcPlane::ZX ? 2 : 1;
    second_ = (first_ + 1) % 3;
    const double x = move.start[first_] - move.arc_centre[first_], y = move.start[second_] - move.arc_centre[second_];
    const double u = move.end[first_] - move.arc_centre[first_], v = move.end[second_] - move.arc_centre[second_];
    radius_ = std::hypot(x, y);
    radius_end_ = std::hypot(u, v);
    set_turn(std::atan2(y, x), std::atan2(v, u));
    const std::size_t third = 3 - first_ - second_;
    normal[third] = 1;
    along = move.end[third] - move.start[third];
  }
  const double radius = std::max(radius_, radius_end_), drift = radius_end_ - radius_;
  bend_ = std::hypot(radius * turn_ * turn_, 2 * drift * turn_);
  const double in_plane = std::hypot(radius * turn_, drift);
  arc_length_ = std::hypot(in_plane, along);
  for (std::size_t k = 0; k < 3; ++k) {
    // A direction lies in the plane by the sine of its angle to the normal.
    speed_[k] = in_plane * std::sqrt(std::max(0.0, 1 - normal[k] * normal[k])) + std::abs(along * normal[k]);
  }
}

void MovePath::set_turn(double from, double to) {
  angle_ = from;
  const double sense = move_->kind == MoveKind::arc_counterclockwise ? 1 : -1;
  double turn = std::remainder(sense * (to - from), kTwoPi);
  if (turn < kSmallestArc) turn += kTwoPi;
  turn_ = sense * (turn + kTwoPi * std::max(move_->arc_turns - 1, 0));
}

void MovePath::at(double s, WordValues& words) const {
  if (s <= 0) {
    words = move_->start;
    return;
  }
  if (s >= 1) {
    words = move_->end;
    return;
  }
  for (std::size_t i = 0; i < kAxisWords; ++i) words[i] = move_->start[i] + s * (move_->end[i] - move_->start[i]);
  if (!arc_) return;
  const double radius = radius_ + s * (radius_end_ - radius_), angle = angle_ + s * turn_;
  const double x = radius * std::cos(angle), y = radius * std::sin(angle);
  if (!tilted_) {
    words[first_] = move_->arc_centre[first_] + x;
    words[second_] = move_->arc_centre[second_] + y;
    return;
  }
  const std::array<double, 3>& normal = move_->arc_normal;
  const double along = dot(difference(words, move_->arc_centre), normal);
  for (std::size_t k = 0; k < 3; ++k) {
    words[k] = move_->arc_centre[k] + along * normal[k] + x * outwards_[k] + y * onwards_[k];
  }
}

double feed_length(const WordValues& start, const WordValues& end) {
  constexpr std::size_t kX = 0, kA = 3, kU = 6;
  const double linear = length(start, end, kX);
  if (linear > 0) return linear;
  const double second = length(start, end, kU);
  return second > 0 ? second : length(start, end, kA);
}

double move_duration(const ProgramMove& move) {
  if (move.kind == MoveKind::rapid || !(move.feed > 0)) return -1;
  if (move.feed_mode == FeedMode::per_revolution) return -1;
  if (move.feed_mode == FeedMode::inverse_time) return 1 / move.feed;
  const MovePath path(move);
  if (!path.is_arc()) return feed_length(move.start, move.end) / move.feed;
  return path.arc_length() / move.feed;
}

void set_piece_feed(const ProgramMove& move, double duration, double share, const WordValues& start,
                    CorrectedPiece& piece) {
  constexpr double kChange = 0.01;
  piece.feed = move.feed;
  piece.feed_mode = move.feed_mode;
  if (!(duration > 0) || !(share > 0)) return;
  const double wanted = duration * share;
  if (move.feed_mode == FeedMode::inverse_time) {
    piece.feed = share == 1 ? move.feed : 1 / wanted;
    return;
  }
  const double taken = feed_length(start, piece.end) / move.feed;
  if (taken == 0 || std::abs(taken - wanted) <= kChange * wanted) return;
  piece.feed_mode = FeedMode::inverse_time;
  piece.feed = 1 / wanted;
}

void set_take_up_feed(const ProgramMove& move, bool rotary, double way, double duration, double moved,
                      CorrectedPiece& piece) {
  constexpr double kFastest_per_min = 1e8;
  piece.feed = move.feed;
  piece.feed_mode = move.feed_mode;
  if (move.kind == MoveKind::rapid || move.feed_mode == FeedMode::per_revolution || !(duration > 0)) return;
  if (move.feed_mode == FeedMode::per_minute) {
    if (rotary == moves_only_rotary_axes(move)) return;
  }
  piece.feed_mode = FeedMode::inverse_time;
  const double taken = moved > 0 ? std::min(std::abs(way) / moved, 1.0) * duration : duration;
  piece.feed = 1 / std::max(taken, 1 / kFastest_per_min);
}

}  // namespace abbe
