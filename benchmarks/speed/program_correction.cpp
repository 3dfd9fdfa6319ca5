// Moves of a dense five-axis program per second: correction and proof, without reading and writing text.
#include "abbe/compensate/program_correction.h"

#include <chrono>
#include <cmath>
#include <cstdio>

#include "abbe/geometry/parallel_blocks.h"
#include "five_axis_case.h"

namespace abbe::benchmarks {
namespace {

constexpr std::size_t kMoves = 1 << 18;
constexpr std::size_t kBatch = 1 << 14;

/// A path over a curved surface in steps of about half a millimetre, all five axes moving.
std::vector<ProgramMove> dense_program(ProgramCoordinates coordinates) {
  std::vector<ProgramMove> moves(kMoves);
  const auto at = [](std::size_t i) {
    const double t = static_cast<double>(i) * 1e-4;
    WordValues words{};
    words[0] = 150 * std::sin(37 * t);
    words[1] = 150 * std::cos(29 * t);
    words[2] = -40 + 30 * std::sin(11 * t);
    words[3] = 0.7 + 0.4 * std::sin(5 * t);
    words[5] = 2.5 * std::sin(7 * t);
    return words;
  };
  for (std::size_t i = 0; i < kMoves; ++i) {
    moves[i].line = i + 1;
    moves[i].kind = MoveKind::straight;
    moves[i].coordinates = coordinates;
    moves[i].feed = 2000;
    moves[i].start = at(i);
    moves[i].end = at(i + 1);
  }
  return moves;
}

void run(const char* name, ProgramCoordinates coordinates, int threads) {
  const FiveAxisCase five_axis;
  const std::vector<ProgramMove> moves = dense_program(coordinates);
  ProgramCorrectionOptions options;
  options.threads = threads;
  double fastest = 1e300;
  std::size_t pieces = 0, reached = 0;
  for (int repeat = 0; repeat < 5; ++repeat) {
    ProgramCorrection correction(five_axis.machine, five_axis.errors, word_axes_by_name(five_axis.machine), options);
    CorrectedPieces corrected;
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < kMoves; i += kBatch) correction.correct({moves.data() + i, kBatch}, corrected);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    fastest = std::min(fastest, taken.count());
    pieces = correction.report().pieces;
    reached = correction.report().status[static_cast<std::size_t>(CorrectionStatus::reached)].count;
  }
  std::printf("%-22s %d threads: %8.0f moves/s, %5.0f ns per move, %zu pieces, %zu reached\n", name, threads,
              kMoves / fastest, 1e9 * fastest / kMoves, pieces, reached);
}

}  // namespace
}  // namespace abbe::benchmarks

int main() {
  using namespace abbe;
  for (const int threads : {1, default_thread_count()}) {
    benchmarks::run("on axes", ProgramCoordinates::axes, threads);
    benchmarks::run("tool centre", ProgramCoordinates::tool_centre, threads);
  }
}
