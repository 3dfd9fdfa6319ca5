#include "abbe/compensate/program/chunk_correction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace abbe {
namespace {

constexpr std::size_t kGroup = 16;  // moves with a common bound
constexpr double kDeadBandShare = 0.125;

bool is_arc(const ProgramMove& move) {
  return move.kind == MoveKind::arc_clockwise || move.kind == MoveKind::arc_counterclockwise;
}

}  // namespace

ChunkCorrection::ChunkCorrection(const Machine& machine, const ErrorSet& errors, const WordAxes& words,
                                 const ProgramCorrectionOptions& options)
    : machine_(machine),
      words_(words),
      options_(options),
      correction_(machine, errors, words, options.rest, options.inverse, options.tool_length_share),
      problem_(correction_.problem()) {
  if (problem_.empty() && errors.composition != Composition{}) {
    problem_ = "errors are composed differently from ISO 230, and programs cannot be corrected for that";
  }
  if (!problem_.empty()) return;
  bounder_.emplace(machine_, errors, std::array<std::size_t, 3>{words_.axis[0], words_.axis[1], words_.axis[2]});
  bounder_->set_tool_length_share(options_.tool_length_share);
  bool turns = false;
  for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
    turns = turns || (machine_.axes[i].kind == AxisKind::rotary && words_.moves(i));
  }
  if (!turns) options_.tolerance.orientation = std::numeric_limits<double>::infinity();
  const bool part = !(options_.reversal_dead_band > 0);
  const double dead_band = part ? kDeadBandShare * options_.tolerance.position : options_.reversal_dead_band;
  reversals_ = ProgramReversals(machine_, errors, words_, *bounder_, dead_band,
                                (part ? kDeadBandShare : 1) * options_.tolerance.orientation);
  bounder_->set_play(reversals_.play(part));
}

bool ChunkCorrection::can_be_made(const ProgramMove& move) const {
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    if (words_.axis[i] == Machine::npos && (move.start[i] != 0 || move.end[i] != 0) &&
        !(i < 3 && move.coordinates == ProgramCoordinates::tool_centre)) {
      return false;
    }
  }
  return move.coordinates == ProgramCoordinates::axes || correction_.kinematics().has_tool_centre();
}

PathTolerance ChunkCorrection::tolerance_of(const ProgramMove& move) const {
  if (move.kind != MoveKind::rapid) return options_.tolerance;
  return {options_.rapid_tolerance, std::numeric_limits<double>::infinity()};
}

void ChunkCorrection::place_nodes(std::span<const ProgramMove> moves, const ProgramMove* before,
                                  ProgramChunk& chunk) const {
  chunk.nodes.clear();
  const std::size_t n = moves.size();
  chunk.start.resize(n);
  chunk.end.resize(n);
  chunk.from_before.assign(n, 0);
  chunk.proven.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const ProgramMove& move = moves[i];
    const ProgramMove* earlier = i > 0 ? &moves[i - 1] : before;
    chunk.from_before[i] = earlier != nullptr && earlier->end == move.start ? 1 : 0;
    const bool shared = i > 0 && chunk.from_before[i] != 0 && chunk.tool[i] == chunk.tool[i - 1] &&
                        earlier->coordinates == move.coordinates;
    if (shared) {
      chunk.start[i] = chunk.end[i - 1];
    } else {
      chunk.start[i] = chunk.nodes.size();
      chunk.nodes.emplace_back().words = move.start;
    }
    chunk.end[i] = chunk.nodes.size();
    chunk.nodes.emplace_back().words = move.end;
  }
}

void ChunkCorrection::correct_nodes(std::span<const ProgramMove> moves, ProgramChunk& chunk) const {
  std::size_t i = 0;
  while (i < moves.size()) {
    std::size_t last = i;
    while (last + 1 < moves.size() && chunk.tool[last + 1] == chunk.tool[i] &&
           moves[last + 1].coordinates == moves[i].coordinates) {
      ++last;
    }
    if (chunk.tool[i] != kNoTool) {
      const std::size_t first_node = chunk.start[i];
      correction_.correct(moves[i].coordinates, chunk.tool[i],
                          {chunk.nodes.data() + first_node, chunk.end[last] + 1 - first_node});
    }
    i = last + 1;
  }
}

void ChunkCorrection::prove_groups(std::span<const ProgramMove> moves, ProgramChunk& chunk) const {
  std::array<MovePiece, kGroup> pieces;
  std::size_t i = 0;
  while (i < moves.size()) {
    const ProgramMove& first = moves[i];
    std::size_t count = 0;
    while (count < kGroup && i + count < moves.size()) {
      const std::size_t k = i + count;
      const ProgramMove& move = moves[k];
      const bool alike = chunk.tool[k] == chunk.tool[i] && move.coordinates == first.coordinates &&
                         (move.kind == MoveKind::rapid) == (first.kind == MoveKind::rapid);
      if (!alike || chunk.tool[k] == kNoTool || is_arc(move)) break;
      const CorrectedNode &from = chunk.nodes[chunk.start[k]], &to = chunk.nodes[chunk.end[k]];
      if (!from.point_reached() || !to.point_reached()) break;
      pieces[count++] = {&from, &to, nullptr, 1};
    }
    if (count < 2) {
      i += std::max(count, std::size_t{1});
      continue;
    }
    const PathTolerance tolerance = tolerance_of(first);
    const PieceBound bound = bound_pieces(*bounder_, machine_.axes.size(), first.coordinates,
                                          correction_.tool_point(chunk.tool[i]), {pieces.data(), count});
    if (bound_excess(*bounder_, tolerance, bound, nullptr) <= 1) {
      std::fill_n(chunk.proven.begin() + static_cast<std::ptrdiff_t>(i), count, char{1});
    }
    i += count;
  }
}

bool ChunkCorrection::is_held(const CorrectedNode& node) const {
  if (node.status != CorrectionStatus::outside_travel) return false;
  constexpr double kSpare = 1e-9;
  for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
    const Axis& axis = machine_.axes[i];
    const double position = node.position[i];
    if (!axis.endless && (position < axis.travel_min - kSpare || position > axis.travel_max + kSpare)) return false;
  }
  return node.point_known();
}

ProgramPlace ChunkCorrection::place_of(double value, const ProgramMove& move, const CorrectedNode& node,
                                       const AxisApproach& approach) {
  return {value, move.line, node.position, node.corrected_position, move.tool_length, node.status, approach};
}

void ChunkCorrection::state(const ProgramMove& move, const CorrectedNode& node, ProgramReport& report,
                            const AxisApproach& approach) const {
  const auto place = [&](double value) { return place_of(value, move, node, approach); };
  // A rapid move does not cut.
  if (move.kind == MoveKind::rapid && is_held(node)) {
    report.held_at_travel.add(move.line);
    report.largest_held.take(place(node.position_left));
  } else {
    const auto status = static_cast<std::size_t>(node.status);
    report.status[status].add(move.line);
    if (report.first_place[status].line == 0 && !node.point_reached()) {
      report.first_place[status] = place(node.position_left);
    }
  }
  const double shift =
      std::sqrt(node.shift[0] * node.shift[0] + node.shift[1] * node.shift[1] + node.shift[2] * node.shift[2]);
  if (report.largest_shift.line == 0 || shift > report.largest_shift.value) report.largest_shift.take(place(shift));
  for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
    const double value = std::abs(node.corrected_position[i] - node.position[i]);
    if (report.by_axis[i].line == 0 || value > report.by_axis[i].value) report.by_axis[i].take(place(value));
  }
  const bool known = node.point_reached();
  if (known && node.orientation_left > report.largest_orientation_left.value)
    report.largest_orientation_left.take(place(node.orientation_left));
  if (options_.limit > 0 && shift > options_.limit) report.above_limit.add(move.line);
}

void ChunkCorrection::give_piece(const ProgramMove& move, double duration, double share, const WordValues& from,
                                 const CorrectedNode& to, ProgramChunk& chunk, const AxisApproach& approach) const {
  CorrectedPiece piece{to.corrected, move.feed, move.feed_mode};
  set_piece_feed(move, duration, share, from, piece);
  if (move.spindle == SpindleMove::thread || move.spindle == SpindleMove::rigid_tapping) {
    // The pitch is along the actual path, which is as long as the commanded one.
    const double length = feed_length(move.start, move.end);
    if (length > 0) piece.feed *= feed_length(from, to.corrected) / length;
  }
  if (piece.feed_mode != move.feed_mode) chunk.report.inverse_time.add(move.line);
  chunk.pieces.pieces.push_back(piece);
  state(move, to, chunk.report, approach);
}

void ChunkCorrection::give_nodes(const ProgramMove& move, std::span<const CorrectedNode> nodes,
                                 std::span<const double> shares, ProgramChunk& chunk) const {
  if (reversals_.act()) {
    chunk.way.nodes.insert(chunk.way.nodes.end(), nodes.begin(), nodes.end());
    chunk.way.shares.insert(chunk.way.shares.end(), shares.begin(), shares.end());
    return;
  }
  const double duration = move_duration(move);
  for (std::size_t k = 1; k < nodes.size(); ++k)
    give_piece(move, duration, shares[k] - shares[k - 1], nodes[k - 1].corrected, nodes[k], chunk);
}

void ChunkCorrection::bound_single(const ProgramMove& move, std::size_t i, const CorrectedNode& start,
                                   const CorrectedNode& end, ProgramChunk& chunk) const {
  const MovePiece piece{&start, &end, nullptr, 1};
  const PieceBound bound = bound_pieces(*bounder_, machine_.axes.size(), move.coordinates,
                                        correction_.tool_point(chunk.tool[i]), {&piece, 1});
  if (bound_excess(*bounder_, options_.tolerance, bound, nullptr) <= 1) return;
  chunk.report.bent_with_spindle.add(move.line);
  chunk.report.largest_bend.take(place_of(bound.position, move, end));
}

bool ChunkCorrection::goes_from_or_to_held(const ProgramMove& move, const ProgramMove* earlier,
                                           const CorrectedNode& start, const CorrectedNode& end,
                                           ProgramChunk& chunk) const {
  if (move.kind == MoveKind::rapid || move.spindle != SpindleMove::none) return false;
  if ((!start.point_reached() && !is_held(start)) || (!end.point_reached() && !is_held(end))) return false;
  // What work leaves at its end is counted there.
  const bool after_work = earlier != nullptr && earlier->kind != MoveKind::rapid && earlier->end == move.start;
  if (!start.point_reached() && !after_work) {
    chunk.report.held_starts.add(move.line);
    chunk.report.largest_held_start.take(place_of(start.position_left, move, start));
  }
  return true;
}

bool ChunkCorrection::is_spent() const {
  return options_.budget != nullptr && options_.budget->spent(pieces_of_batch_) != ProgramBudget::Spent::nothing;
}

void ChunkCorrection::give_move(const ProgramMove& move, const ProgramMove* earlier, std::size_t i,
                                ProgramChunk& chunk) const {
  if (chunk.tool[i] == kNoTool) {
    chunk.report.impossible.add(move.line);
    if (!reversals_.act()) chunk.pieces.pieces.push_back({move.end, move.feed, move.feed_mode});
    return;
  }
  const CorrectedNode &start = chunk.nodes[chunk.start[i]], &end = chunk.nodes[chunk.end[i]];
  bool whole = chunk.proven[i] != 0 || is_spent();
  if (!whole && (!start.point_reached() || !end.point_reached()) &&
      !goes_from_or_to_held(move, earlier, start, end, chunk)) {
    // Nothing is proven about it. Where a rapid move comes from a place unknown to the errors, as at the start of a
    // program, nothing needs to be; all else is said by its status.
    whole = true;
    if (move.kind != MoveKind::rapid && !start.point_reached()) chunk.report.not_proven.add(move.line);
  }
  if (move.spindle != SpindleMove::none) {
    if (!whole) bound_single(move, i, start, end, chunk);
    whole = true;
  }
  pieces_of_batch_ += whole ? 1 : 0;
  if (whole) {
    const std::array<CorrectedNode, 2> both = {start, end};
    const std::array<double, 2> shares = {0, 1};
    give_nodes(move, both, shares, chunk);
    return;
  }
  MoveSplitter& splitter = *chunk.splitter;
  if (!splitter.split(move, chunk.tool[i], tolerance_of(move), start, end)) {
    chunk.report.not_proven.add(move.line);
  }
  if (splitter.nodes().size() > 2) ++chunk.report.split_moves;
  pieces_of_batch_ += splitter.nodes().size() - 1;
  give_nodes(move, splitter.nodes(), splitter.shares(), chunk);
}

void ChunkCorrection::work(std::span<const ProgramMove> moves, const ProgramMove* before, ProgramChunk& chunk) const {
  chunk.report = ProgramReport{};
  chunk.pieces.pieces.clear();
  chunk.pieces.first.clear();
  chunk.way.clear();
  if (!chunk.splitter) chunk.splitter.emplace(correction_, *bounder_, machine_.axes.size(), options_.largest_pieces);
  place_nodes(moves, before, chunk);
  correct_nodes(moves, chunk);
  prove_groups(moves, chunk);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    (reversals_.act() ? chunk.way.first : chunk.pieces.first)
        .push_back(reversals_.act() ? chunk.way.nodes.size() : chunk.pieces.pieces.size());
    const ProgramMove* earlier = i > 0 ? &moves[i - 1] : before;
    if (chunk.from_before[i] != 0 && earlier->tool_length != moves[i].tool_length)
      chunk.report.tool_changes.add(moves[i].line);
    give_move(moves[i], earlier, i, chunk);
  }
  chunk.way.first.push_back(chunk.way.nodes.size());
  chunk.report.moves = moves.size();
  chunk.report.pieces = chunk.pieces.pieces.size();
}

void ChunkCorrection::find_tools(std::span<const ProgramMove> moves, ProgramChunk& chunk) {
  chunk.tool.resize(moves.size());
  for (std::size_t i = 0; i < moves.size(); ++i) {
    // Programs keep a tool for long: the search is for new ones.
    if (i > 0 && chunk.tool[i - 1] != kNoTool && moves[i].tool_length == moves[i - 1].tool_length &&
        can_be_made(moves[i])) {
      chunk.tool[i] = chunk.tool[i - 1];
    } else {
      chunk.tool[i] = can_be_made(moves[i]) ? correction_.tool(moves[i].tool_length) : kNoTool;
    }
  }
}

bool ChunkCorrection::turns_with_spindle(const ProgramMove& move, std::size_t i, const ProgramWay& way) const {
  if (move.spindle == SpindleMove::none) return false;
  const std::size_t first = way.first[i], last = way.first[i + 1] - 1;
  return std::any_of(reversals_.axes().begin(), reversals_.axes().end(), [&](const ReversalAxis& axis) {
    const std::size_t a = axis.axis;
    const double moved = std::abs(way.nodes[last].corrected_position[a] - way.nodes[first].corrected_position[a]);
    return way.approach[last][a] != way.approach[first][a] ||
           (move.spindle == SpindleMove::rigid_tapping && moved > axis.dead_band);
  });
}

ProgramWay ChunkCorrection::way_after_approaches(const ProgramMove& move, std::size_t i, ProgramChunk& chunk) const {
  const ProgramWay& mean = chunk.way;
  const std::size_t first = mean.first[i], last = mean.first[i + 1], tool = chunk.tool[i];
  ProgramWay way;
  way.nodes = {mean.nodes[first]};
  way.shares = {mean.shares[first]};
  way.approach = {mean.approach[first]};
  bool proven = true;
  for (std::size_t k = first + 1; k < last; ++k) {
    const AxisApproach& approach = mean.approach[k];
    const CorrectedNode from = correction_.after(move.coordinates, tool, mean.nodes[k - 1], approach);
    const CorrectedNode to = correction_.after(move.coordinates, tool, mean.nodes[k], approach);
    // Moves with the spindle are not split, and what is not reached is not proven.
    if (move.spindle == SpindleMove::none && proven && from.point_reached() && to.point_reached()) {
      MoveSplitter& splitter = *chunk.splitter;
      proven =
          splitter.split_part(move, tool, tolerance_of(move), approach, from, mean.shares[k - 1], to, mean.shares[k]);
      for (std::size_t n = 1; n + 1 < splitter.nodes().size(); ++n) {
        way.nodes.push_back(splitter.nodes()[n]);
        way.shares.push_back(splitter.shares()[n]);
        way.approach.push_back(approach);
      }
    }
    way.nodes.push_back(mean.nodes[k]);
    way.shares.push_back(mean.shares[k]);
    way.approach.push_back(approach);
  }
  if (!proven) chunk.report.not_proven.add(move.line);
  way.first = {0, way.nodes.size()};
  return way;
}

void ChunkCorrection::give_steps(const ProgramMove& move, std::size_t index, ProgramChunk& chunk) const {
  if (chunk.way.first[index] == chunk.way.first[index + 1]) {
    chunk.pieces.pieces.push_back({move.end, move.feed, move.feed_mode});
    return;
  }
  ProgramWay after;
  if (correction_.has_approaches()) after = way_after_approaches(move, index, chunk);
  const ProgramWay& way = correction_.has_approaches() ? after : chunk.way;
  const std::size_t i = correction_.has_approaches() ? 0 : index;
  if (turns_with_spindle(move, i, way)) chunk.report.play_with_spindle.add(move.line);
  const double duration = move_duration(move);
  reversals_.steps(correction_, move, chunk.tool[index], way, i, chunk.steps);
  WordValues at =
      reversals_.commanded(correction_, move, chunk.tool[index], way.nodes[way.first[i]], way.approach[way.first[i]])
          .corrected;
  for (const ProgramStep& step : chunk.steps) {
    const double share = way.shares[step.to] - way.shares[step.to - 1];
    if (step.taken_up == ProgramStep::npos) {
      give_piece(move, duration, share, at, step.node, chunk, step.approach);
      for (const ReversalAxis& axis : reversals_.axes()) {
        if (step.approach[axis.axis] == 0) chunk.report.direction_unknown[axis.axis].add(move.line);
      }
    } else {
      CorrectedPiece piece{step.node.corrected, move.feed, move.feed_mode};
      set_take_up_feed(move, step.rotary, step.way, duration * share,
                       reversals_.moved(way.nodes[step.to - 1], way.nodes[step.to]), piece);
      if (piece.feed_mode != move.feed_mode) chunk.report.inverse_time.add(move.line);
      // Between moves of a cycle or two, LinuxCNC 2.9 loses its way where it may round corners (docs/programs.md).
      piece.exact = move.kind == MoveKind::rapid;
      chunk.pieces.pieces.push_back(piece);
      chunk.report.take_ups[step.taken_up].add(move.line);
    }
    at = step.node.corrected;
  }
}

void ChunkCorrection::give_all_steps(std::span<const ProgramMove> moves, ProgramChunk& chunk) const {
  for (std::size_t i = 0; i < moves.size(); ++i) {
    chunk.pieces.first.push_back(chunk.pieces.pieces.size());
    give_steps(moves[i], i, chunk);
  }
  chunk.report.pieces = chunk.pieces.pieces.size();
}

}  // namespace abbe
