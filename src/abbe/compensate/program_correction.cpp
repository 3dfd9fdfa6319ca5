#include "abbe/compensate/program_correction.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include "abbe/compensate/program_reversals.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

constexpr std::size_t kChunk = 256;  // moves worked on together
constexpr std::size_t kGroup = 16;   // moves with a common bound
constexpr double kDeadBandShare = 0.125;
constexpr std::size_t kChunksWithWay = 8;
constexpr std::size_t kNoTool = static_cast<std::size_t>(-1);

bool is_arc(const ProgramMove& move) {
  return move.kind == MoveKind::arc_clockwise || move.kind == MoveKind::arc_counterclockwise;
}

/// Moves that follow each other and what becomes of them.
struct Chunk {
  std::vector<CorrectedNode> nodes;
  std::vector<std::size_t> start, end;  ///< nodes of each move
  std::vector<std::size_t> tool;        ///< of each move; kNoTool: it cannot be made
  std::vector<char> from_before;        ///< the start is where the move before ended
  std::vector<char> proven;             ///< one piece will do
  CorrectedPieces pieces;
  ProgramReport report;
  std::optional<MoveSplitter> splitter;
  ProgramWay way;  ///< with reversal values only: the poses before directions are known
  std::vector<ProgramStep> steps;
};

}  // namespace

struct ProgramCorrection::Implementation {
  Implementation(const Machine& given, const ErrorSet& errors, const WordAxes& given_words,
                 const ProgramCorrectionOptions& wanted)
      : machine(given),
        words(given_words),
        options(wanted),
        correction(given, errors, given_words, wanted.rest, wanted.inverse),
        problem(correction.problem()) {
    if (problem.empty() && errors.composition != Composition{}) {
      problem = "errors are composed in another way than that of ISO 230, which programs are not corrected for";
    }
    if (!problem.empty()) return;
    bounder.emplace(machine, errors, std::array<std::size_t, 3>{words.axis[0], words.axis[1], words.axis[2]});
    bool turns = false;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      turns = turns || (machine.axes[i].kind == AxisKind::rotary && words.moves(i));
    }
    if (!turns) options.tolerance.orientation = std::numeric_limits<double>::infinity();
    const bool part = !(options.reversal_dead_band > 0);
    const double dead_band = part ? kDeadBandShare * options.tolerance.position : options.reversal_dead_band;
    reversals = ProgramReversals(machine, errors, words, *bounder, dead_band,
                                 (part ? kDeadBandShare : 1) * options.tolerance.orientation);
    bounder->set_play(reversals.play(part));
  }

  bool can_be_made(const ProgramMove& move) const {
    for (std::size_t i = 0; i < kAxisWords; ++i) {
      if (words.axis[i] == Machine::npos && (move.start[i] != 0 || move.end[i] != 0) &&
          !(i < 3 && move.coordinates == ProgramCoordinates::tool_centre)) {
        return false;
      }
    }
    return move.coordinates == ProgramCoordinates::axes || correction.kinematics().has_tool_centre();
  }

  PathTolerance tolerance_of(const ProgramMove& move) const {
    if (move.kind != MoveKind::rapid) return options.tolerance;
    return {options.rapid_tolerance, std::numeric_limits<double>::infinity()};
  }

  void place_nodes(std::span<const ProgramMove> moves, const ProgramMove* before, Chunk& chunk) const {
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

  void correct_nodes(std::span<const ProgramMove> moves, Chunk& chunk) const {
    std::size_t i = 0;
    while (i < moves.size()) {
      std::size_t last = i;
      while (last + 1 < moves.size() && chunk.tool[last + 1] == chunk.tool[i] &&
             moves[last + 1].coordinates == moves[i].coordinates) {
        ++last;
      }
      if (chunk.tool[i] != kNoTool) {
        const std::size_t first_node = chunk.start[i];
        correction.correct(moves[i].coordinates, chunk.tool[i],
                           {chunk.nodes.data() + first_node, chunk.end[last] + 1 - first_node});
      }
      i = last + 1;
    }
  }

  /// One bound for several moves in a row, where they are alike; it proves each of them.
  void prove_groups(std::span<const ProgramMove> moves, Chunk& chunk) const {
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
      const PieceBound bound = bound_pieces(*bounder, machine.axes.size(), first.coordinates,
                                            correction.tool_point(chunk.tool[i]), {pieces.data(), count});
      if (bound_excess(*bounder, tolerance, bound, nullptr) <= 1) {
        std::fill_n(chunk.proven.begin() + static_cast<std::ptrdiff_t>(i), count, char{1});
      }
      i += count;
    }
  }

  /// A place within the travel whose correction points outwards at its end, where the axes stay.
  bool is_held(const CorrectedNode& node) const {
    if (node.status != CorrectionStatus::outside_travel) return false;
    constexpr double kSpare = 1e-9;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      const Axis& axis = machine.axes[i];
      const double position = node.position[i];
      if (!axis.endless && (position < axis.travel_min - kSpare || position > axis.travel_max + kSpare)) return false;
    }
    return node.point_known();
  }

  static ProgramPlace place_of(double value, const ProgramMove& move, const CorrectedNode& node,
                               const AxisApproach& approach = {}) {
    return {value, move.line, node.position, node.corrected_position, move.tool_length, node.status, approach};
  }

  void state(const ProgramMove& move, const CorrectedNode& node, ProgramReport& report,
             const AxisApproach& approach = {}) const {
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
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      const double value = std::abs(node.corrected_position[i] - node.position[i]);
      if (report.by_axis[i].line == 0 || value > report.by_axis[i].value) report.by_axis[i].take(place(value));
    }
    const bool known = node.point_reached();
    if (known && node.orientation_left > report.largest_orientation_left.value)
      report.largest_orientation_left.take(place(node.orientation_left));
    if (options.limit > 0 && shift > options.limit) report.above_limit.add(move.line);
  }

  void give_piece(const ProgramMove& move, double duration, double share, const WordValues& from,
                  const CorrectedNode& to, Chunk& chunk, const AxisApproach& approach = {}) const {
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

  /// Poses of a move: pieces of the program, or with reversal values nodes of its way, which become pieces when the
  /// directions are known.
  void give_nodes(const ProgramMove& move, std::span<const CorrectedNode> nodes, std::span<const double> shares,
                  Chunk& chunk) const {
    if (reversals.act()) {
      chunk.way.nodes.insert(chunk.way.nodes.end(), nodes.begin(), nodes.end());
      chunk.way.shares.insert(chunk.way.shares.end(), shares.begin(), shares.end());
      return;
    }
    const double duration = move_duration(move);
    for (std::size_t k = 1; k < nodes.size(); ++k)
      give_piece(move, duration, shares[k] - shares[k - 1], nodes[k - 1].corrected, nodes[k], chunk);
  }

  /// A move that is not split: how far its path may be from the commanded one.
  void bound_single(const ProgramMove& move, std::size_t i, const CorrectedNode& start, const CorrectedNode& end,
                    Chunk& chunk) const {
    const MovePiece piece{&start, &end, nullptr, 1};
    const PieceBound bound = bound_pieces(*bounder, machine.axes.size(), move.coordinates,
                                          correction.tool_point(chunk.tool[i]), {&piece, 1});
    if (bound_excess(*bounder, options.tolerance, bound, nullptr) <= 1) return;
    chunk.report.bent_with_spindle.add(move.line);
    chunk.report.largest_bend.take(place_of(bound.position, move, end));
  }

  /// Whether what of a move can be proven is: one at work with ends within the travel.
  /// @param earlier  the move before; null: none
  bool goes_from_or_to_held(const ProgramMove& move, const ProgramMove* earlier, const CorrectedNode& start,
                            const CorrectedNode& end, Chunk& chunk) const {
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

  bool is_spent() const {
    return options.budget != nullptr && options.budget->spent(pieces_of_batch) != ProgramBudget::Spent::nothing;
  }

  void give_move(const ProgramMove& move, const ProgramMove* earlier, std::size_t i, Chunk& chunk) const {
    if (chunk.tool[i] == kNoTool) {
      chunk.report.impossible.add(move.line);
      if (!reversals.act()) chunk.pieces.pieces.push_back({move.end, move.feed, move.feed_mode});
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
    pieces_of_batch += whole ? 1 : 0;
    if (whole) {
      const std::array<CorrectedNode, 2> both = {start, end};
      const std::array<double, 2> shares = {0, 1};
      give_nodes(move, both, shares, chunk);
      return;
    }
    MoveSplitter& splitter = *chunk.splitter;
    if (!splitter.split(move, chunk.tool[i], tolerance_of(move), start, end)) chunk.report.not_proven.add(move.line);
    if (splitter.nodes().size() > 2) ++chunk.report.split_moves;
    pieces_of_batch += splitter.nodes().size() - 1;
    give_nodes(move, splitter.nodes(), splitter.shares(), chunk);
  }

  /// Whether an axis with a reversal value turns round in a move with the spindle: where it begins, or where a tap
  /// does.
  bool turns_with_spindle(const ProgramMove& move, std::size_t i, const ProgramWay& way) const {
    if (move.spindle == SpindleMove::none) return false;
    const std::size_t first = way.first[i], last = way.first[i + 1] - 1;
    return std::any_of(reversals.axes().begin(), reversals.axes().end(), [&](const ReversalAxis& axis) {
      const std::size_t a = axis.axis;
      const double moved = std::abs(way.nodes[last].corrected_position[a] - way.nodes[first].corrected_position[a]);
      return way.approach[last][a] != way.approach[first][a] ||
             (move.spindle == SpindleMove::rigid_tapping && moved > axis.dead_band);
    });
  }

  void give_steps(const ProgramMove& move, std::size_t i, Chunk& chunk) const {
    const ProgramWay& way = chunk.way;
    if (way.first[i] == way.first[i + 1]) {
      chunk.pieces.pieces.push_back({move.end, move.feed, move.feed_mode});
      return;
    }
    if (turns_with_spindle(move, i, way)) chunk.report.play_with_spindle.add(move.line);
    const double duration = move_duration(move);
    reversals.steps(correction, move, chunk.tool[i], way, i, chunk.steps);
    WordValues at =
        reversals.commanded(correction, move, chunk.tool[i], way.nodes[way.first[i]], way.approach[way.first[i]])
            .corrected;
    for (const ProgramStep& step : chunk.steps) {
      const double share = way.shares[step.to] - way.shares[step.to - 1];
      if (step.taken_up == ProgramStep::npos) {
        give_piece(move, duration, share, at, step.node, chunk, step.approach);
        for (const ReversalAxis& axis : reversals.axes()) {
          if (step.approach[axis.axis] == 0) chunk.report.direction_unknown[axis.axis].add(move.line);
        }
      } else {
        const bool rotary = machine.axes[step.taken_up].kind == AxisKind::rotary;
        CorrectedPiece piece{step.node.corrected, move.feed, move.feed_mode};
        set_take_up_feed(move, rotary, step.way, duration * share,
                         reversals.moved(way.nodes[step.to - 1], way.nodes[step.to]), piece);
        if (piece.feed_mode != move.feed_mode) chunk.report.inverse_time.add(move.line);
        // Between moves of a cycle or two, LinuxCNC 2.9 loses its way where it may round corners (docs/programs.md).
        piece.exact = move.kind == MoveKind::rapid;
        chunk.pieces.pieces.push_back(piece);
        chunk.report.take_ups[step.taken_up].add(move.line);
      }
      at = step.node.corrected;
    }
  }

  /// What is left to do when the directions are known.
  void give_all_steps(std::span<const ProgramMove> moves, Chunk& chunk) const {
    for (std::size_t i = 0; i < moves.size(); ++i) {
      chunk.pieces.first.push_back(chunk.pieces.pieces.size());
      give_steps(moves[i], i, chunk);
    }
    chunk.report.pieces = chunk.pieces.pieces.size();
  }

  void work(std::span<const ProgramMove> moves, const ProgramMove* before, Chunk& chunk) const {
    chunk.report = ProgramReport{};
    chunk.pieces.pieces.clear();
    chunk.pieces.first.clear();
    chunk.way.clear();
    if (!chunk.splitter) chunk.splitter.emplace(correction, *bounder, machine.axes.size(), options.largest_pieces);
    place_nodes(moves, before, chunk);
    correct_nodes(moves, chunk);
    prove_groups(moves, chunk);
    for (std::size_t i = 0; i < moves.size(); ++i) {
      (reversals.act() ? chunk.way.first : chunk.pieces.first)
          .push_back(reversals.act() ? chunk.way.nodes.size() : chunk.pieces.pieces.size());
      const ProgramMove* earlier = i > 0 ? &moves[i - 1] : before;
      if (chunk.from_before[i] != 0 && earlier->tool_length != moves[i].tool_length)
        chunk.report.tool_changes.add(moves[i].line);
      give_move(moves[i], earlier, i, chunk);
    }
    chunk.way.first.push_back(chunk.way.nodes.size());
    chunk.report.moves = moves.size();
    chunk.report.pieces = chunk.pieces.pieces.size();
  }

  void correct_batch(std::span<const ProgramMove> moves, CorrectedPieces& corrected) {
    const std::size_t count = (moves.size() + kChunk - 1) / kChunk;
    while (chunks.size() < count) chunks.push_back(std::make_unique<Chunk>());
    const auto moves_of = [&](std::size_t c) {
      return moves.subspan(c * kChunk, std::min(kChunk, moves.size() - c * kChunk));
    };
    for (std::size_t c = 0; c < count; ++c) find_tools(moves_of(c), *chunks[c]);
    for_each_block(count, options.threads, [&](std::size_t c) {
      const ProgramMove* before = c > 0 ? &moves[c * kChunk - 1] : last_move ? &*last_move : nullptr;
      work(moves_of(c), before, *chunks[c]);
    });
    if (reversals.act()) {
      for (std::size_t c = 0; c < count; ++c) reversals.follow(moves_of(c), chunks[c]->way);
      for_each_block(count, options.threads, [&](std::size_t c) { give_all_steps(moves_of(c), *chunks[c]); });
    }
    std::size_t pieces = corrected.pieces.size();
    for (std::size_t c = 0; c < count; ++c) pieces += chunks[c]->pieces.pieces.size();
    corrected.pieces.reserve(pieces);
    for (std::size_t c = 0; c < count; ++c) {
      const Chunk& chunk = *chunks[c];
      const std::size_t before = corrected.pieces.size();
      for (const std::size_t first : chunk.pieces.first) corrected.first.push_back(before + first);
      corrected.pieces.insert(corrected.pieces.end(), chunk.pieces.pieces.begin(), chunk.pieces.pieces.end());
      total.add(chunk.report);
    }
    last_move = moves.back();
  }

  void find_tools(std::span<const ProgramMove> moves, Chunk& chunk) {
    chunk.tool.resize(moves.size());
    for (std::size_t i = 0; i < moves.size(); ++i) {
      // Programs keep a tool for long: the search is for new ones.
      if (i > 0 && chunk.tool[i - 1] != kNoTool && moves[i].tool_length == moves[i - 1].tool_length &&
          can_be_made(moves[i])) {
        chunk.tool[i] = chunk.tool[i - 1];
      } else {
        chunk.tool[i] = can_be_made(moves[i]) ? correction.tool(moves[i].tool_length) : kNoTool;
      }
    }
  }

  Machine machine;
  WordAxes words;
  ProgramCorrectionOptions options;
  NodeCorrection correction;
  std::string problem;
  std::optional<PieceBounder> bounder;
  ProgramReversals reversals;
  std::vector<std::unique_ptr<Chunk>> chunks;
  std::optional<ProgramMove> last_move;
  mutable std::atomic<std::size_t> pieces_of_batch = 0;
  ProgramReport total;
};

ProgramCorrection::ProgramCorrection(const Machine& machine, const ErrorSet& errors, const WordAxes& words,
                                     const ProgramCorrectionOptions& options)
    : implementation_(std::make_unique<Implementation>(machine, errors, words, options)) {}
ProgramCorrection::~ProgramCorrection() = default;
ProgramCorrection::ProgramCorrection(ProgramCorrection&&) noexcept = default;
ProgramCorrection& ProgramCorrection::operator=(ProgramCorrection&&) noexcept = default;

void ProgramCorrection::correct(std::span<const ProgramMove> moves, CorrectedPieces& corrected) {
  Implementation& self = *implementation_;
  corrected.pieces.clear();
  corrected.first.clear();
  self.pieces_of_batch = 0;
  if (!self.problem.empty()) {
    for (const ProgramMove& move : moves) {
      corrected.first.push_back(corrected.pieces.size());
      corrected.pieces.push_back({move.end, move.feed, move.feed_mode});
    }
    corrected.first.push_back(corrected.pieces.size());
    return;
  }
  // With reversal values the poses of moves are kept until the directions are known: of few moves at a time.
  const std::size_t batch = self.reversals.act() ? kChunksWithWay * kChunk : moves.size();
  for (std::size_t first = 0; first < moves.size(); first += batch) {
    self.correct_batch(moves.subspan(first, std::min(batch, moves.size() - first)), corrected);
  }
  corrected.first.push_back(corrected.pieces.size());
}

const ProgramReport& ProgramCorrection::report() const { return implementation_->total; }
const std::string& ProgramCorrection::problem() const { return implementation_->problem; }
const std::vector<ReversalAxis>& ProgramCorrection::reversals() const { return implementation_->reversals.axes(); }

}  // namespace abbe
