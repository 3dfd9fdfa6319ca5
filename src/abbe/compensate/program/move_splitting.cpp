#include "abbe/compensate/program/move_splitting.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace abbe {
namespace {

// Where the ends of a piece are reached, they are to 1e-9 mm.
constexpr double kEndResidual = 2e-9;
constexpr std::size_t kMostParts = 8;  // per round: later rounds see what is local
constexpr double kShortestShare = 1e-9;
constexpr int kHalvings = 26;  // 100 mm to 2 nm

void raise(double& bound, double value) { bound = std::max(bound, value); }

}  // namespace

PieceBound bound_pieces(const PieceBounder& bounder, std::size_t axes, ProgramCoordinates coordinates,
                        const Eigen::Vector3d& tool, std::span<const MovePiece> pieces) {
  PieceMotion motion;
  motion.tool_centre = coordinates == ProgramCoordinates::tool_centre;
  std::array<double, kMaxAxes> low, high;
  std::array<double, 3> point_low, point_high;
  const CorrectedNode& reference = *pieces.back().to;
  const auto& reference_position = motion.tool_centre ? reference.corrected_position : reference.position;
  for (std::size_t i = 0; i < axes; ++i) {
    motion.lowest[i] = motion.highest[i] = reference.corrected_position[i];
    low[i] = high[i] = reference_position[i];
  }
  for (std::size_t i = 0; i < 3; ++i) point_low[i] = point_high[i] = reference.corrected[i];

  for (const MovePiece& piece : pieces) {
    const CorrectedNode &a = *piece.from, &b = *piece.to;
    const double bend = piece.path == nullptr ? 0 : piece.path->bend() * piece.share * piece.share;
    raise(motion.arc_bend, bend);
    for (std::size_t i = 0; i < axes; ++i) {
      const double from = a.corrected_position[i], to = b.corrected_position[i];
      motion.lowest[i] = std::min(motion.lowest[i], from);
      motion.highest[i] = std::max(motion.highest[i], from);
      raise(motion.actual_speed[i], std::abs(to - from));
      motion.lowest[i] = std::min(motion.lowest[i], to);
      motion.highest[i] = std::max(motion.highest[i], to);
      const double first = a.position[i], last = b.position[i];
      low[i] = std::min({low[i], motion.tool_centre ? from : first, motion.tool_centre ? to : last});
      high[i] = std::max({high[i], motion.tool_centre ? from : first, motion.tool_centre ? to : last});
      raise(motion.speed[i], std::abs(last - first));
      raise(motion.offset[i], std::max(std::abs(from - first), std::abs(to - last)));
      raise(motion.offset_speed[i], std::abs((to - last) - (from - first)));
    }
    double square = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      point_low[i] = std::min({point_low[i], a.corrected[i], b.corrected[i]});
      point_high[i] = std::max({point_high[i], a.corrected[i], b.corrected[i]});
      square += (b.corrected[i] - a.corrected[i]) * (b.corrected[i] - a.corrected[i]);
    }
    raise(motion.point_speed, std::sqrt(square));
  }
  double square = 0;
  for (std::size_t i = 0; i < axes; ++i) motion.width[i] = high[i] - low[i];
  for (std::size_t i = 0; i < 3; ++i) square += (point_high[i] - point_low[i]) * (point_high[i] - point_low[i]);
  motion.point_width = std::sqrt(square);

  ChainLevers levers;
  bounder.levers(reference_position.data(), tool, levers);
  return bounder.bound(levers, motion);
}

double bound_excess(const PieceBounder& bounder, const PathTolerance& tolerance, const PieceBound& bound,
                    const MovePiece* piece) {
  // What lags does so however short a piece is.
  const bool counts = bounder.play().lags_count;
  const double position = tolerance.position - kEndResidual - (counts ? bound.lag : 0);
  const double orientation = tolerance.orientation - (counts ? bound.lag_turn : 0);
  if (!(position > 0) || !(orientation > 0)) return std::numeric_limits<double>::infinity();
  double excess = std::max(bound.position / position, bound.orientation / orientation);
  const PlayBounds& play = bounder.play();
  if (!play.any || !(bound.axis_bend > 0)) return excess;
  for (std::size_t i = 0; i < kMaxAxes; ++i) {
    if (!(play.lag[i] > 0) || !bounder.is_point_axis(i)) continue;
    // A curve with |l''| <= b that goes from 0 to d leaves this interval by at most (b / 2 - d)^2 / (2 b).
    const double way =
        piece == nullptr ? 0 : std::abs(piece->to->corrected_position[i] - piece->from->corrected_position[i]);
    const double beyond = std::max(0.0, 0.5 * bound.axis_bend - way);
    raise(excess, beyond * beyond / (2 * bound.axis_bend) / (kOvershootShare * play.lag[i]));
  }
  return excess;
}

void MoveSplitter::part_at_travel(const MovePath& path, ProgramCoordinates coordinates, std::size_t tool) {
  const bool reached_first = nodes_.front().point_reached();
  double reached = reached_first ? 0 : 1, missed = 1 - reached;
  CorrectedNode best = reached_first ? nodes_.front() : nodes_.back();
  for (int i = 0; i < kHalvings; ++i) {
    const double s = 0.5 * (reached + missed);
    fresh_.assign(1, CorrectedNode{});
    path.at(s, fresh_[0].words);
    correction_->correct(coordinates, tool, fresh_);
    (fresh_[0].point_reached() ? reached : missed) = s;
    if (fresh_[0].point_reached()) best = fresh_[0];
  }
  if (reached == 0 || reached == 1) return;
  nodes_.insert(nodes_.begin() + 1, best);
  at_.insert(at_.begin() + 1, reached);
  proven_.push_back(0);
}

bool MoveSplitter::split(const ProgramMove& move, std::size_t tool, const PathTolerance& tolerance,
                         const CorrectedNode& start, const CorrectedNode& end) {
  const MovePath path(move);
  nodes_.assign({start, end});
  at_.assign({0.0, 1.0});
  proven_.assign(1, 0);
  if (start.point_reached() != end.point_reached()) part_at_travel(path, move.coordinates, tool);
  return refine(path, move, tool, tolerance, {});
}

bool MoveSplitter::split_part(const ProgramMove& move, std::size_t tool, const PathTolerance& tolerance,
                              const AxisApproach& approach, const CorrectedNode& start, double from,
                              const CorrectedNode& end, double to) {
  nodes_.assign({start, end});
  at_.assign({from, to});
  proven_.assign(1, 0);
  return refine(MovePath(move), move, tool, tolerance, approach);
}

bool MoveSplitter::refine(const MovePath& path, const ProgramMove& move, std::size_t tool,
                          const PathTolerance& tolerance, const AxisApproach& approach) {
  const Eigen::Vector3d& tool_point = correction_->tool_point(tool);
  for (;;) {
    parts_.assign(proven_.size(), 1);
    fresh_.clear();
    for (std::size_t k = 0; k < proven_.size(); ++k) {
      const MovePiece piece{&nodes_[k], &nodes_[k + 1], path.is_arc() ? &path : nullptr, at_[k + 1] - at_[k]};
      // What has no correction has no bound either; its status is said.
      if (proven_[k] != 0 || !piece.from->point_known() || !piece.to->point_known()) continue;
      const PieceBound bound = bound_pieces(*bounder_, axes_, move.coordinates, tool_point, {&piece, 1});
      const double excess = bound_excess(*bounder_, tolerance, bound, &piece);
      if (excess <= 1) {
        proven_[k] = 1;
        continue;
      }
      if (!(excess < 1e12) || piece.share < kShortestShare) return false;
      parts_[k] = std::clamp(static_cast<std::size_t>(std::ceil(std::sqrt(excess))), std::size_t{2}, kMostParts);
      for (std::size_t j = 1; j < parts_[k]; ++j) {
        const double s = at_[k] + piece.share * static_cast<double>(j) / static_cast<double>(parts_[k]);
        path.at(s, fresh_.emplace_back().words);
      }
    }
    if (fresh_.empty()) return true;
    if (nodes_.size() + fresh_.size() > largest_pieces_) return false;
    correction_->correct(move.coordinates, tool, fresh_, approach);

    next_.assign(1, nodes_[0]);
    next_at_.assign(1, at_[0]);
    next_proven_.clear();
    std::size_t used = 0;
    for (std::size_t k = 0; k < proven_.size(); ++k) {
      for (std::size_t j = 1; j < parts_[k]; ++j) {
        next_.push_back(fresh_[used++]);
        next_at_.push_back(at_[k] + (at_[k + 1] - at_[k]) * static_cast<double>(j) / static_cast<double>(parts_[k]));
        next_proven_.push_back(0);
      }
      next_.push_back(nodes_[k + 1]);
      next_at_.push_back(at_[k + 1]);
      next_proven_.push_back(parts_[k] == 1 ? proven_[k] : char{0});
    }
    nodes_.swap(next_);
    at_.swap(next_at_);
    proven_.swap(next_proven_);
  }
}

}  // namespace abbe
