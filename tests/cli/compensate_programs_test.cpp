// abbe compensate gcode on programs as posts and people write them: LinuxCNC reads the original and the corrected one,
// and the machine with errors follows.
#include "cli/gcode_for_test.h"

namespace abbe {
namespace {

const std::filesystem::path kPrograms = std::filesystem::path(ABBE_SOURCE_DIR) / "tests/cli/programs";

/// The points of a commanded move, of which others are looked for in their order.
class CommandedPath {
 public:
  CommandedPath(const test::ControlledMachine& control, const ProgramMove& move)
      : window_(kSteps / static_cast<std::size_t>(2 * std::max(move.arc_turns, 1))),
        fewest_(MovePath(move).is_arc() ? 4 * static_cast<std::size_t>(std::max(move.arc_turns, 1)) : 1) {
    const MovePath path(move);
    for (std::size_t k = 0; k <= kSteps; ++k) {
      WordValues words;
      path.at(static_cast<double>(k) / kSteps, words);
      points_.push_back(control.pose(move, words, false).translation);
    }
  }

  /// Whether so many pieces have come that the end is not the beginning of a circle.
  bool may_end() { return ++pieces_ >= fewest_; }

  double distance(const Eigen::Vector3d& point) {
    const std::size_t first = near_ > 20 ? near_ - 20 : 0;
    return distance_between(point, points_, first, std::min(near_ + window_, kSteps), near_);
  }

 private:
  static constexpr std::size_t kSteps = 6000;
  std::vector<Eigen::Vector3d> points_;
  std::size_t near_ = 0, window_, fewest_, pieces_ = 0;
};

class CompensatePrograms : public CompensateGcode, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    if (!test::has_gcode_module()) {
      GTEST_SKIP() << "LinuxCNC's Python module gcode (Debian package linuxcnc-uspace) is not installed";
    }
    // As LinuxCncFolder has them.
    write("parameters.var", "5161 0\n5162 0\n5163 0\n5164 0\n5166 0\n5181 0\n5182 0\n5183 0\n5184 0\n5186 0\n5220 1\n");
    write("tools.tbl", "T1 P1 Z50\nT2 P2 X1 Y2 Z30\n");
  }

  CommandResult correct(const std::filesystem::path& program) const {
    return abbe({"compensate", "gcode",   program.string(), "--machine",    machine,          "--errors",
                 errors,       "-o",      "out.ngc",        "--parameters", "parameters.var", "--tool-table",
                 "tools.tbl",  "--start", "X_mm=0",         "--start",      "Y_mm=0",         "--start",
                 "Z_mm=0",     "--start", "A_deg=0",        "--start",      "C_deg=0"});
  }

  /// Every move at work of the original against the pieces that it became, one after the other. Where rapid moves end
  /// they begin.
  void expect_moves_followed(std::vector<ProgramMove> original, std::vector<ProgramMove> corrected) const {
    for (std::vector<ProgramMove>* moves : {&original, &corrected}) {
      std::erase_if(*moves, [](const ProgramMove& move) { return move.kind == MoveKind::rapid; });
    }
    const test::ControlledMachine machine_and_control = control();
    ASSERT_GE(original.size(), 5U);
    std::size_t at = 0;
    double uncorrected = 0;
    for (std::size_t i = 0; i < original.size(); ++i) {
      SCOPED_TRACE(fmt::format("move {} of {}, piece {} of {}", i + 1, original.size(), at + 1, corrected.size()));
      const ProgramMove& move = original[i];
      CommandedPath path(machine_and_control, move);
      double largest = 0;
      for (bool ended = false; !ended; ++at) {
        ASSERT_LT(at, corrected.size());
        const ProgramMove& piece = corrected[at];
        const double missed = largest_difference(piece.end, move.end);
        // Small circles come near their end before it.
        ended = path.may_end() && missed < 0.08 &&
                (at + 1 == corrected.size() || largest_difference(corrected[at + 1].end, move.end) >= missed);
        for (int k = 0; k <= 4; ++k) {
          const WordValues words = test::between(piece.start, piece.end, k / 4.0);
          largest = std::max(largest, path.distance(machine_and_control.pose(piece, words, true).translation));
        }
      }
      const RigidTransform end = machine_and_control.pose(move, move.end, false);
      uncorrected =
          std::max(uncorrected, machine_and_control.point_missed(machine_and_control.pose(move, move.end, true), end));
      ASSERT_LE(largest, 1.15e-3);
      const RigidTransform reached = machine_and_control.pose(corrected[at - 1], corrected[at - 1].end, true);
      ASSERT_LE(machine_and_control.point_missed(reached, end), 4e-6);
    }
    EXPECT_EQ(at, corrected.size());
    EXPECT_GE(uncorrected, 0.005);
  }

 private:
  /// mm or degrees.
  static double largest_difference(const WordValues& a, const WordValues& b) {
    double largest = 0;
    for (std::size_t k = 0; k < kAxisWords; ++k) {
      largest = std::max(largest, std::abs(a[k] - b[k]) / (k >= 3 && k < 6 ? kDegree : 1));
    }
    return largest;
  }
};

TEST_P(CompensatePrograms, TheToolFollowsAsLinuxCncReadsBoth) {
  const std::filesystem::path program = kPrograms / (std::string(GetParam()) + ".ngc");
  const CommandResult result = correct(program);
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  expect_moves_followed(moves_of_linuxcnc(program), moves_of_linuxcnc(folder.path() / "out.ngc"));
}

/// LinuxCNC 2.9 knows G43.4 as G43 of a control whose kinematics take X, Y, Z for the point: a position is the point
/// and the tool length on top. Only the moves with the tool.
std::vector<ProgramMove> moves_of_the_point(const std::filesystem::path& program) {
  std::ifstream file(program);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t code = text.find("G43.4");
  EXPECT_NE(code, std::string::npos) << program;
  if (code != std::string::npos) text.erase(code + 3, 2);
  const test::Canon canon = test::run_gcode_module(text);
  EXPECT_EQ(canon.error, "");
  std::vector<ProgramMove> moves;
  for (ProgramMove move : test::program_moves(canon)) {
    if (move.tool_length[2] == 0) continue;
    move.coordinates = ProgramCoordinates::tool_centre;
    for (std::size_t k = 0; k < 3; ++k) {
      for (double* value : {&move.start[k], &move.end[k], &move.arc_centre[k]}) *value -= move.tool_length[k];
    }
    moves.push_back(move);
  }
  return moves;
}

class CompensateToolCentreProgram : public CompensatePrograms {};

TEST_P(CompensateToolCentreProgram, ThePointFollowsAsLinuxCncReadsBoth) {
  const std::filesystem::path program = kPrograms / (std::string(GetParam()) + ".ngc");
  const CommandResult result = correct(program);
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  expect_moves_followed(moves_of_the_point(program), moves_of_the_point(folder.path() / "out.ngc"));
}

INSTANTIATE_TEST_SUITE_P(Programs, CompensateToolCentreProgram, testing::Values("tool_centre"));

INSTANTIATE_TEST_SUITE_P(Programs, CompensatePrograms,
                         testing::Values("drilling", "inches", "inverse_time", "offsets", "planes", "pocket",
                                         "references", "spindle", "trochoids"),
                         [](const testing::TestParamInfo<const char*>& program) { return std::string(program.param); });

}  // namespace
}  // namespace abbe
