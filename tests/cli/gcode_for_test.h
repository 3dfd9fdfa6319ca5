#pragma once

// For tests of `abbe compensate gcode`: where the tool of a machine with errors goes.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "abbe/compensate/program/program_moves_for_test.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/nc/linuxcnc_for_test.h"
#include "abbe/formats/nc/nc_program.h"
#include "abbe/geometry/angle_units.h"
#include "cli/command_test.h"

namespace abbe {

inline const std::filesystem::path kExamples = std::filesystem::path(ABBE_SOURCE_DIR) / "examples";

/// Notes moves and leaves them as they are.
class Recorder final : public MoveCorrector {
 public:
  void correct(std::span<const ProgramMove> given, CorrectedPieces& corrected) override {
    corrected.pieces.clear();
    corrected.first.assign(1, 0);
    for (const ProgramMove& move : given) {
      moves.push_back(move);
      corrected.pieces.push_back({move.end, move.feed, move.feed_mode});
      corrected.first.push_back(corrected.pieces.size());
    }
  }
  std::vector<ProgramMove> moves;
};

/// @param from_zero  all axes stand at zero when the program begins; else that is not known
inline std::vector<ProgramMove> moves_of(const std::filesystem::path& program, bool from_zero = false,
                                         const PlaneKinematics* planes = nullptr) {
  std::ifstream file(program);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  NcProgramOptions options;
  options.words[4] = false;  // no B
  options.planes = planes;
  for (std::size_t i = 0; from_zero && i < 6; ++i) options.start[i] = 0.0;
  Recorder recorder;
  correct_nc_program(text, program.string(), options, recorder, [](std::string_view) {});
  return recorder.moves;
}

struct Distance {
  double largest = 0;
  std::size_t samples = 0;
};

/// Distance of a point from the straight lines [first, last) of a chain; the nearest one is written to `near`.
inline double distance_between(const Eigen::Vector3d& point, const std::vector<Eigen::Vector3d>& chain,
                               std::size_t first, std::size_t last, std::size_t& near) {
  double least = 1e300;
  for (std::size_t k = first; k < last; ++k) {
    const Eigen::Vector3d along = chain[k + 1] - chain[k];
    const double length = along.squaredNorm();
    const double s = length > 0 ? std::clamp((point - chain[k]).dot(along) / length, 0.0, 1.0) : 0.0;
    const double d = (point - chain[k] - s * along).norm();
    if (d < least) {
      least = d;
      near = k;
    }
  }
  return least;
}

/// Largest distance of points, in their order, from a chain of straight lines.
inline Distance distance_from(const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector3d>& chain) {
  Distance distance;
  std::size_t near = 0;
  for (const Eigen::Vector3d& point : points) {
    const std::size_t first = near > 60 ? near - 60 : 0, last = std::min(chain.size() - 1, near + 600);
    distance.largest = std::max(distance.largest, distance_between(point, chain, first, last, near));
    ++distance.samples;
  }
  return distance;
}

inline int samples_along(const ProgramMove& move, int fewest) {
  const MovePath path(move);
  const std::array<double, 3> speed = path.speed();
  double length = std::hypot(speed[0], speed[1], speed[2]);
  if (!path.is_arc()) length = feed_length(move.start, move.end);
  return std::clamp(static_cast<int>(length / 0.1), fewest, 4000);
}

/// Functional points at work along moves; every move with its share of samples.
inline std::vector<Eigen::Vector3d> points_along(const test::ControlledMachine& control,
                                                 const std::vector<ProgramMove>& moves, bool with_errors, int fewest) {
  std::vector<Eigen::Vector3d> points;
  for (const ProgramMove& move : moves) {
    if (move.kind == MoveKind::rapid) continue;
    const MovePath path(move);
    const int count = samples_along(move, fewest);
    for (int k = 0; k <= count; ++k) {
      WordValues words;
      path.at(static_cast<double>(k) / count, words);
      points.push_back(control.pose(move, words, with_errors).translation);
    }
  }
  return points;
}

class CompensateGcode : public CommandTest {
 protected:
  CommandResult run(const std::string& program, std::vector<std::string> more) const {
    std::vector<std::string> arguments = {
        "compensate", "gcode", (kExamples / "compensate" / program).string(), "--machine", machine, "--errors", errors};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return abbe(arguments);
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder.path() / name) << text; }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder.path() / name); }

  test::ControlledMachine control() const {
    const Machine read = read_machine(machine);
    return {read, read_errors(errors, read).errors, word_axes_by_name(read)};
  }

  /// The tool at work, from moves as programmed and from those of the corrected program.
  void expect_followed(const std::vector<ProgramMove>& original, const std::vector<ProgramMove>& corrected,
                       double tolerance) const {
    const test::ControlledMachine machine_and_control = control();
    const std::vector<Eigen::Vector3d> commanded = points_along(machine_and_control, original, false, 20);
    const std::vector<Eigen::Vector3d> driven = points_along(machine_and_control, corrected, true, 4);
    const Distance there = distance_from(driven, commanded), back = distance_from(commanded, driven);
    EXPECT_LE(there.largest, tolerance);
    EXPECT_LE(back.largest, tolerance);  // nothing of the path is missing
    EXPECT_GE(there.samples, 500U);
    const std::vector<Eigen::Vector3d> uncorrected = points_along(machine_and_control, original, true, 4);
    EXPECT_GE(distance_from(uncorrected, commanded).largest, 0.02);
  }

  const std::string machine = (kExamples / "machines/trunnion-mill.machine.toml").string();
  const std::string errors = (kExamples / "compensate/trunnion.errors.toml").string();
};

/// The program through LinuxCNC's module `gcode`; fails the test if that does not read it to its end.
inline std::vector<ProgramMove> moves_of_linuxcnc(const std::filesystem::path& program) {
  std::ifstream file(program);
  const test::Canon canon = test::run_gcode_module({std::istreambuf_iterator<char>(file), {}});
  EXPECT_EQ(canon.error, "");
  return test::program_moves(canon);
}

inline void expect_same_moves(const std::vector<ProgramMove>& linuxcnc, const std::vector<ProgramMove>& here) {
  const std::vector<test::CanonMove> expected = test::canon_moves(linuxcnc), found = test::canon_moves(here);
  ASSERT_EQ(expected.size(), found.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    SCOPED_TRACE(fmt::format("move {}", i + 1));
    ASSERT_EQ(expected[i].kind, found[i].kind);
    ASSERT_EQ(expected[i].turns, found[i].turns);
    for (std::size_t k = 0; k < 6; ++k) ASSERT_NEAR(expected[i].end[k], found[i].end[k], 1e-9) << "XYZABC"[k];
    for (std::size_t k = 0; k < 2; ++k) ASSERT_NEAR(expected[i].centre[k], found[i].centre[k], 1e-9);
  }
}

}  // namespace abbe
