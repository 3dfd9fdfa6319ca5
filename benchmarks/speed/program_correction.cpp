// Moves of a dense five-axis program per second: correction and proof, without reading and writing text.
#include "abbe/compensate/program/program_correction.h"

#include <chrono>
#include <cmath>
#include <cstdio>

#include "abbe/geometry/parallel_blocks.h"
#include "five_axis_case.h"

namespace abbe::benchmarks {
namespace {

constexpr std::size_t kMoves = 1 << 18;
constexpr std::size_t kBatch = 1 << 14;

/// A path over a curved surface in steps of about half a millimetre, all five axes moving. Around the tool centre it is
/// smaller: the head's levers would take the linear axes out of the range in which the errors are known.
std::vector<ProgramMove> dense_program(ProgramCoordinates coordinates) {
  std::vector<ProgramMove> moves(kMoves);
  const double size = coordinates == ProgramCoordinates::axes ? 150 : 40;
  const auto at = [size](std::size_t i) {
    const double t = static_cast<double>(i) * 1e-4;
    WordValues words{};
    words[0] = size * std::sin(37 * t);
    words[1] = size * std::cos(29 * t);
    words[2] = -40 + 0.2 * size * std::sin(11 * t);
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
  ProgramReport report;
  for (int repeat = 0; repeat < 5; ++repeat) {
    ProgramCorrection correction(five_axis.machine, five_axis.errors, word_axes_by_name(five_axis.machine), options);
    CorrectedPieces corrected;
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < kMoves; i += kBatch) correction.correct({moves.data() + i, kBatch}, corrected);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    fastest = std::min(fastest, taken.count());
    report = correction.report();
  }
  std::printf("%-22s %d threads: %8.0f moves/s, %5.0f ns per move, %zu pieces; poses:", name, threads, kMoves / fastest,
              1e9 * fastest / kMoves, report.pieces);
  for (std::size_t s = 0; s < kCorrectionStatuses; ++s) {
    if (report.status[s].count == 0) continue;
    std::printf(" %zu %s,", report.status[s].count, correction_status_text(static_cast<CorrectionStatus>(s)));
  }
  std::printf(" largest orientation error that stays %.3f urad\n", 1e6 * report.largest_orientation_left.value);
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
