// abbe compensate gcode on the example programs: where the tool of a machine with errors goes.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "abbe/compensate/machine_with_play_for_test.h"
#include "abbe/compensate/program/machine_planes.h"
#include "abbe/compensate/program/program_moves_for_test.h"
#include "abbe/compensate/program/program_uncertainty.h"
#include "abbe/errors/reversal.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/nc/linuxcnc_for_test.h"
#include "abbe/formats/nc/nc_program.h"
#include "cli/gcode_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

TEST_F(CompensateGcode, TheToolOfTheMachineWithErrorsFollowsBothPrograms) {
  for (const std::string program : {"cone.ngc", "plate.ngc"}) {
    SCOPED_TRACE(program);
    const CommandResult result = run(program, {"-o", program});
    ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
    EXPECT_THAT(result.out, HasSubstr("written"));
    expect_followed(moves_of(kExamples / "compensate" / program), moves_of(folder.path() / program), 1.1e-3);
  }
}

TEST_F(CompensateGcode, TheToolFollowsATiltedPlane) {
  write(
      "tilted.ngc",
      "G21 G90 G17\nG10 L2 P1 X0 Y0 Z-410\nG54\nG53 G0 Z-5\nG0 X0 Y0 A0 C0\nG68.2 X20 Y10 Z60 I40 J-35 K0\nG53.1\n"
      "G0 X0 Y0 Z60\nG1 Z0 F800\nX50\nG3 X60 Y10 R10\nG1 Y40\nG0 Z60\nG81 X5 Y20 Z-10 R3\nG80\nG69\nG53 G0 Z-5\nM2\n");
  const CommandResult result =
      abbe({"compensate", "gcode", "tilted.ngc", "--machine", machine, "--errors", errors, "-o", "out.ngc"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const Machine read = read_machine(machine);
  const MachinePlanes planes(read, word_axes_by_name(read));
  expect_followed(moves_of(folder.path() / "tilted.ngc", false, &planes), moves_of(folder.path() / "out.ngc"), 1.1e-3);
}

TEST_F(CompensateGcode, ARotaryMoveKeepsItsTime) {
  ASSERT_EQ(run("plate.ngc", {"-o", "out.ngc"}).exit_code, ExitCode::done);
  // N290 turns C by 45 deg at 720 deg/min, N310 takes a twelfth of a minute.
  double minutes = 0, turned = 0;
  for (const ProgramMove& move : moves_of(folder.path() / "out.ngc")) {
    if (move.kind == MoveKind::rapid || move.feed_mode != FeedMode::inverse_time) continue;
    minutes += 1 / move.feed;
    turned += move.end[5] - move.start[5];
  }
  EXPECT_NEAR(turned, 60 * kDegree, 1e-3);
  EXPECT_NEAR(minutes, 45.0 / 720 + 1.0 / 12, 1e-4);
}

TEST_F(CompensateGcode, JsonSaysWhatWasDoneAndWithWhatUncertainty) {
  const CommandResult result = run("cone.ngc", {"-o", "out.ngc", "--json", "--leave-out-below-uncertainty", "2"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json.at("written"), true);
  EXPECT_GT(json.at("moves"), 100);
  EXPECT_GT(json.at("largest_correction").at("value_um"), 20);
  EXPECT_LT(json.at("largest_correction").at("value_um"), 100);
  EXPECT_GT(json.at("largest_correction").at("standard_uncertainty_um"), 0.5);
  EXPECT_LT(json.at("largest_correction").at("standard_uncertainty_um"), 5);
  EXPECT_EQ(json.at("axes").size(), 5U);
  EXPECT_EQ(json.at("poses").at("not covered").at("count"), 0);
  EXPECT_THAT(json.at("left_out").get<std::vector<std::string>>(), testing::Contains("EAX"));
}

/// The same of a machine whose axes have play and go where they are carried from move to move.
std::vector<Eigen::Vector3d> points_with_play(test::MachineWithPlay& machine, const std::vector<ProgramMove>& moves) {
  std::vector<Eigen::Vector3d> points;
  for (const ProgramMove& move : moves) {
    const int count = samples_along(move, 20);
    const MovePath path(move);
    for (int k = 0; k <= count; ++k) {
      WordValues words;
      path.at(static_cast<double>(k) / count, words);
      machine.drive(machine.commands(move, words));
      if (move.kind != MoveKind::rapid) points.push_back(machine.actual(move).translation);
    }
  }
  return points;
}

TEST_F(CompensateGcode, AxesWithPlayFollowBothPrograms) {
  std::ifstream file(errors);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  write("r.errors.toml", text + R"(
[[reversal]]
axis = "X"
value_um = -9
standard_uncertainty_um = 0.6
[[reversal]]
axis = "Y"
value_um = -14
standard_uncertainty_um = 0.6
[[reversal]]
axis = "Z"
value_um = -5
standard_uncertainty_um = 4
[[reversal]]
axis = "A"
value_urad = -40
standard_uncertainty_urad = 2
[[reversal]]
axis = "C"
value_urad = -55
standard_uncertainty_urad = 2
)");
  const Machine read = read_machine(machine);
  const ErrorSet with_play = read_errors((folder.path() / "r.errors.toml").string(), read).errors;
  for (const std::string program : {"cone.ngc", "plate.ngc"}) {
    SCOPED_TRACE(program);
    const std::string original = (kExamples / "compensate" / program).string();
    const CommandResult result =
        abbe({"compensate", "gcode", original, "--machine", machine, "--errors", "r.errors.toml", "-o", program});
    ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_THAT(result.out, HasSubstr("reversal of X -9 um, standard uncertainty 0.6 um: taken up "));
    EXPECT_THAT(result.out, HasSubstr("reversal of C -55 urad, standard uncertainty 2 urad: taken up "));
    const WordAxes words = word_axes_by_name(read);
    const std::vector<ProgramMove> commanded_moves = moves_of(original);
    const std::vector<Eigen::Vector3d> commanded = points_along(control(), commanded_moves, false, 400);
    test::MachineWithPlay driven(read, with_play, words), uncorrected(read, with_play, words);
    const std::vector<Eigen::Vector3d> points = points_with_play(driven, moves_of(folder.path() / program));
    EXPECT_LE(distance_from(points, commanded).largest, 1.1e-3);
    EXPECT_LE(distance_from(commanded, points).largest, 1.1e-3);
    EXPECT_GE(distance_from(points_with_play(uncorrected, commanded_moves), commanded).largest, 0.02);
  }
  const CommandResult left =
      abbe({"compensate", "gcode", (kExamples / "compensate/cone.ngc").string(), "--machine", machine, "--errors",
            "r.errors.toml", "--dry-run", "--json", "--leave-out-below-uncertainty", "2"});
  ASSERT_EQ(left.exit_code, ExitCode::done) << left.err;
  const auto json = nlohmann::json::parse(left.out);
  EXPECT_THAT(json.at("left_out").get<std::vector<std::string>>(), testing::Contains("reversal_Z"));
  EXPECT_EQ(json.at("reversals").size(), 4U);
  EXPECT_EQ(json.at("reversals")[0].at("value_um"), -9);
  EXPECT_EQ(json.at("reversals")[0].at("dead_band_um"), 0.125);
  EXPECT_GT(json.at("reversals")[0].at("taken_up").at("count"), 1);
}

TEST_F(CompensateGcode, UncertaintiesOfReversalValuesAreThoseOfTheCovariance) {
  const Machine read = read_machine(machine);
  ErrorsFile contents = read_errors(errors, read);
  contents.errors.reversals = {{read.find_axis("C"), -55e-6, 2e-6}, {read.find_axis("X"), -0.009, 0}};
  contents.covariance = parameter_covariance(contents.errors, {});
  const auto first = static_cast<Eigen::Index>(first_reversal(contents.errors));
  contents.covariance(first, first) = 3e-6 * 3e-6;
  contents.covariance(first + 1, first + 1) = 0.0007 * 0.0007;
  write_errors(folder.path() / "c.errors.toml", read, contents);
  const CommandResult result = abbe({"compensate", "gcode", (kExamples / "compensate/plate.ngc").string(), "--machine",
                                     machine, "--errors", "c.errors.toml", "--dry-run"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("reversal of C -55 urad, standard uncertainty 3 urad: taken up "));
  EXPECT_THAT(result.out, HasSubstr("reversal of X -9 um, standard uncertainty 0.7 um: taken up "));
}

TEST_F(CompensateGcode, ADryRunWritesNothing) {
  const CommandResult result = run("plate.ngc", {"--dry-run"});
  EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("largest correction of the functional point"));
  EXPECT_THAT(result.out, HasSubstr("dry run: nothing written"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST_F(CompensateGcode, CorrectionsAboveTheLimitAreRefusedByLine) {
  const CommandResult result = run("cone.ngc", {"-o", "out.ngc", "--limit-um", "15"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.err, HasSubstr("correction above the limit of 15 um"));
  EXPECT_THAT(result.err, testing::ContainsRegex(", the largest 34\\.1[0-9]+ um in line [0-9]+ at C "));
  EXPECT_THAT(result.err, HasSubstr("lines "));
  EXPECT_THAT(result.err, HasSubstr("nothing written"));
  EXPECT_FALSE(exists("out.ngc"));
  EXPECT_EQ(run("cone.ngc", {"-o", "out.ngc", "--limit-um", "200"}).exit_code, ExitCode::done);
}

TEST_F(CompensateGcode, PosesThatCannotBeCorrectedAreRefusedUnlessAllowed) {
  // The top of Z is the end of its travel, and its correction leads beyond.
  write("top.ngc", "G21 G90\nG0 X0 Y0 Z-5 A-20 C0\nG1 Z0 F100\nM2\n");
  std::vector<std::string> arguments = {"compensate", "gcode", "top.ngc", "--machine", machine,
                                        "--errors",   errors,  "-o",      "out.ngc"};
  CommandResult result = abbe(arguments);
  const bool beyond = result.exit_code != ExitCode::done;
  if (!beyond) {
    // The sign of the correction is the other one: the lower end then.
    write("top.ngc", "G21 G90\nG0 X0 Y0 Z-505 A-20 C0\nG1 Z-510 F100\nM2\n");
    result = abbe(arguments);
    std::filesystem::remove(folder.path() / "out.ngc");
    result = abbe(arguments);
  }
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(
      result.err,
      HasSubstr("outside the travel: 1 pose, line 3, first at C 0.000 deg, A -20.000 deg, Y 0.000 mm, X 0.000"));
  EXPECT_FALSE(exists("out.ngc"));
  arguments.insert(arguments.end(), {"--allow", "outside-travel"});
  EXPECT_EQ(abbe(arguments).exit_code, ExitCode::done);
  EXPECT_TRUE(exists("out.ngc"));
  arguments.back() = "anything";
  EXPECT_EQ(abbe(arguments).exit_code, ExitCode::bad_input);
}

TEST_F(CompensateGcode, RapidMovesAreKeptAtTheEndOfTheTravel) {
  // At one of both ends of Z the correction points outwards.
  write("ends.ngc", "G21 G90\nG0 X0 Y0 Z-5 A-20 C0\nG0 Z0\nX10\nG0 Z-510\nG0 Z-5\nM2\n");
  const CommandResult result =
      abbe({"compensate", "gcode", "ends.ngc", "--machine", machine, "--errors", errors, "-o", "out.ngc", "--json"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_GE(json.at("held_at_travel").at("count"), 1);
  EXPECT_GT(json.at("held_at_travel").at("largest_left_um"), 0.1);
  EXPECT_LT(json.at("held_at_travel").at("largest_left_um"), json.at("largest_correction").at("value_um"));
  EXPECT_EQ(json.at("poses").at("outside travel").at("count"), 0);
  double least = 0, largest = -510;
  for (const ProgramMove& move : moves_of(folder.path() / "out.ngc")) {
    least = std::min(least, move.end[2]);
    largest = std::max(largest, move.end[2]);
  }
  EXPECT_GE(least, -510);
  EXPECT_LE(largest, 0);
  EXPECT_TRUE(least == -510 || largest == 0);
  // Where the program itself leaves the travel it is refused, and so is work that begins where the tool is not.
  write("beyond.ngc", "G21 G90\nG0 X0 Y0 Z-5 A-20 C0\nG0 Z1\nM2\n");
  const CommandResult beyond =
      abbe({"compensate", "gcode", "beyond.ngc", "--machine", machine, "--errors", errors, "-o", "b.ngc"});
  EXPECT_EQ(beyond.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(beyond.err, HasSubstr("Z 1.000 mm; the travel of Z is -510 to 0 mm (--allow"));
  write("work.ngc", "G21 G90\nG0 X0 Y0 Z0 A-20 C0\nG1 Z-5 F100\nG0 Z-510\nG1 Z-505\nM2\n");
  std::vector<std::string> work = {"compensate", "gcode", "work.ngc", "--machine", machine,
                                   "--errors",   errors,  "-o",       "w.ngc",     "--json"};
  const CommandResult refused = abbe(work);
  EXPECT_EQ(refused.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(refused.err, HasSubstr("work that begins at the end of a travel that its correction would leave"));
  EXPECT_THAT(refused.err, HasSubstr("begin it further inside the travel: 1 pose, line"));
  EXPECT_THAT(refused.err, HasSubstr("--allow held-start"));
  EXPECT_FALSE(exists("w.ngc"));
  work.insert(work.end(), {"--allow", "held-start"});
  const CommandResult allowed = abbe(work);
  ASSERT_EQ(allowed.exit_code, ExitCode::done) << allowed.err;
  const auto written = nlohmann::json::parse(allowed.out);
  EXPECT_EQ(written.at("held_starts").at("count"), 1);
  EXPECT_GT(written.at("held_starts").at("largest_left_um"), 0.1);
  EXPECT_EQ(written.at("not_proven").at("count"), 0);
  // A piece to where the correction is within the travel, and the rest.
  EXPECT_EQ(written.at("split_moves"), 1);
  EXPECT_EQ(written.at("pieces"), 5);
}

TEST_F(CompensateGcode, ThreadsAndTapsStayOneMoveWithTheirPitch) {
  write(
      "thread.ngc",
      "G21 G90\nM3 S500\nG0 X100 Y100 Z-100\nG33.1 Z-120 K1.5\nG33 X103 Z-140 K2\nG0 Z-100\nG84 X120 Z-130 R-110 F500\n"
      "G80\nM2\n");
  const auto mill = (kExamples / "machines/three-axis-mill.machine.toml").string();
  const auto mill_errors = (kExamples / "compensate/mill.errors.toml").string();
  std::vector<std::string> arguments = {"compensate", "gcode",    "thread.ngc",     "--machine",
                                        mill,         "--errors", mill_errors,      "--force",
                                        "-o",         "out.ngc",  "--tolerance-um", "5"};
  const CommandResult result = abbe(arguments);
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  NcProgramOptions options;
  for (std::size_t i = 0; i < kAxisWords; ++i) options.words[i] = i < 3;
  const auto moves_in = [&](const std::string& name) {
    Recorder recorder;
    correct_nc_program(folder.read(name), name, options, recorder, [](std::string_view) {});
    std::vector<ProgramMove> chosen;
    for (const ProgramMove& move : recorder.moves) {
      if (move.spindle == SpindleMove::thread || move.spindle == SpindleMove::rigid_tapping) chosen.push_back(move);
    }
    return chosen;
  };
  const std::vector<ProgramMove> original = moves_in("thread.ngc"), corrected = moves_in("out.ngc");
  ASSERT_EQ(original.size(), 2U);
  ASSERT_EQ(corrected.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(corrected[i].spindle, original[i].spindle);
    EXPECT_NE(corrected[i].end, original[i].end);
    // As many turns of the spindle as programmed.
    EXPECT_NEAR(feed_length(corrected[i].start, corrected[i].end) / corrected[i].feed,
                feed_length(original[i].start, original[i].end) / original[i].feed, 2e-6);
  }
  // Both began where the tap had begun.
  EXPECT_NEAR(corrected[0].start[2], corrected[1].start[2], 1e-9);
  arguments.back() = "0.001";
  const CommandResult bent = abbe(arguments);
  EXPECT_EQ(bent.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(bent.err,
              HasSubstr("threads or taps, which are not split, not proven to stay within the tolerance, at most "));
}

TEST_F(CompensateGcode, ProgramsThatDoNotEndAreGivenUpAndNothingIsWritten) {
  write("out.ngc", "mine");
  const auto given_up = [&](const std::string& program, const std::vector<std::string>& more) {
    write("p.ngc", "G21 G90\nG0 X0 Y0 Z-5 A-20 C0\n" + program + "M2\n");
    std::vector<std::string> arguments = {"compensate", "gcode", "p.ngc",   "--machine", machine,
                                          "--errors",   errors,  "--force", "-o",        "out.ngc"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.exit_code, ExitCode::computation_says_no) << program;
    EXPECT_THAT(result.err, HasSubstr("abbe: nothing written\n")) << program;
    EXPECT_EQ(folder.read("out.ngc"), "mine") << program;
    return result.err;
  };
  EXPECT_THAT(given_up("O1 repeat [9000000]\nG1 X1 F100\nX0\nO1 endrepeat\n", {"--max-output-mb", "1"}),
              testing::ContainsRegex("p.ngc:[45]: given up after [0-9]+ moves: the corrected program would be longer "
                                     "than 1 MB; --max-output-mb allows more"));
  EXPECT_THAT(given_up("O1 while [1]\nG2 I9 P99999 F100\nO1 endwhile\n", {"--max-minutes", "0.01"}),
              HasSubstr("moves: it takes longer than 0.01 min; --max-minutes allows more"));
  const CommandResult none = abbe(
      {"compensate", "gcode", "p.ngc", "--machine", machine, "--errors", errors, "--dry-run", "--max-minutes", "0"});
  EXPECT_EQ(none.exit_code, ExitCode::bad_input);
  EXPECT_THAT(none.err, HasSubstr("--max-minutes: 0 is not a finite number above zero; expected a time in min"));
}

TEST_F(CompensateGcode, InputsAreNeverWritten) {
  write("p.ngc", "G21 G90\nG0 X0 Y0 Z-5 A-20 C0\nM2\n");
  const std::vector<std::string> base = {"compensate", "gcode", "p.ngc", "--machine", machine, "--errors", errors};
  for (const std::string output : {"p.ngc", "./p.ngc"}) {
    std::vector<std::string> arguments = base;
    arguments.insert(arguments.end(), {"--force", "-o", output});
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.exit_code, ExitCode::bad_input);
    EXPECT_THAT(result.err, HasSubstr("is an input"));
  }
  for (const std::string limit : {"0", "-5", "nan", "inf"}) {
    std::vector<std::string> arguments = base;
    arguments.insert(arguments.end(), {"--dry-run", "--limit-um", limit});
    EXPECT_EQ(abbe(arguments).exit_code, ExitCode::bad_input) << limit;
  }
  EXPECT_EQ(folder.read("p.ngc"), "G21 G90\nG0 X0 Y0 Z-5 A-20 C0\nM2\n");
  EXPECT_EQ(abbe(base).exit_code, ExitCode::bad_input);
}

TEST_F(CompensateGcode, AStartOutsideTheTravelIsAnErrorUnlessItIsAPoint) {
  write("s.ngc", "G21 G90 G94 F1000\nG1 X0 Y0 Z-5 A-20 C0\nM2\n");
  const auto from = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = {"compensate", "gcode",  "s.ngc",   "--machine", machine,   "--errors", errors,
                                    "--start",    "Y_mm=0", "--start", "Z_mm=-10",  "--start", "C_deg=0",  "--dry-run"};
    all.insert(all.end(), more.begin(), more.end());
    return abbe(all);
  };
  EXPECT_EQ(from({"--start", "X_mm=5", "--start", "A_deg=0"}).exit_code, ExitCode::done);
  const CommandResult linear = from({"--start", "X_mm=9999", "--start", "A_deg=0"});
  EXPECT_EQ(linear.exit_code, ExitCode::bad_input);
  EXPECT_THAT(linear.err, HasSubstr("--start X_mm=9999: outside the axis's travel; expected -300 to 300 mm"));
  const CommandResult rotary = from({"--start", "X_mm=5", "--start", "A_deg=31", "--tool-centre"});
  EXPECT_EQ(rotary.exit_code, ExitCode::bad_input);
  EXPECT_THAT(rotary.err, HasSubstr("expected -120 to 30 deg"));
  EXPECT_THAT(from({"--start", "X_mm=9999", "--start", "A_deg=0", "--tool-centre"}).err,
              testing::Not(HasSubstr("outside the axis's travel; expected")));
}

TEST_F(CompensateGcode, WordsWithoutAnAxisAreErrorsWithTheirLine) {
  write("b.ngc", "G21 G90\nG0 X0 Y0 Z-5 A-20 C0\nG0 B5\nM2\n");
  const CommandResult result =
      abbe({"compensate", "gcode", "b.ngc", "--machine", machine, "--errors", errors, "-o", "out.ngc"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("b.ngc"));
  EXPECT_THAT(result.err, HasSubstr("3"));
  EXPECT_FALSE(exists("out.ngc"));
}

TEST_F(CompensateGcode, ToolCentreProgramsAreOfThePoint) {
  // The same pose in words of the axes and of the point.
  const test::ControlledMachine machine_and_control = control();
  ProgramMove move;
  WordValues words{};
  words[0] = 20, words[1] = 30, words[2] = -300, words[3] = -20 * kDegree, words[5] = 40 * kDegree;
  const Eigen::Vector3d point = machine_and_control.pose(move, words, false).translation;
  write("point.ngc", fmt::format("G21 G90\nG0 X{:.7f} Y{:.7f} Z{:.7f} A-20 C40\nG1 X{:.7f} F100\nM2\n", point.x(),
                                 point.y(), point.z(), point.x() + 3));
  ASSERT_EQ(abbe({"compensate", "gcode",    "point.ngc",     "--machine", machine,   "--errors", errors,
                  "-o",         "out.ngc",  "--tool-centre", "--start",   "X_mm=0",  "--start",  "Y_mm=0",
                  "--start",    "Z_mm=100", "--start",       "A_deg=-20", "--start", "C_deg=40"})
                .exit_code,
            ExitCode::done);
  NcProgramOptions options;
  options.words[4] = false;
  for (std::size_t i = 0; i < kAxisWords; ++i) options.start[i] = 0.0;
  Recorder recorder;
  correct_nc_program(folder.read("out.ngc"), "out.ngc", options, recorder, [](std::string_view) {});
  ASSERT_FALSE(recorder.moves.empty());
  ProgramMove last = recorder.moves.back();
  last.coordinates = ProgramCoordinates::tool_centre;
  const Eigen::Vector3d wanted = point + Eigen::Vector3d(3, 0, 0);
  EXPECT_NEAR((machine_and_control.pose(last, last.end, true).translation - wanted).norm(), 0, 2e-6);
  EXPECT_GE((machine_and_control.pose(last, last.end, false).translation - wanted).norm(), 0.005);
}

TEST_F(CompensateGcode, AsLinuxCncReadsBothProgramsTheToolFollowsThePath) {
  if (!test::has_gcode_module()) {
    GTEST_SKIP() << "LinuxCNC's Python module gcode (Debian package linuxcnc-uspace) is not installed";
  }
  for (const std::string program : {"cone.ngc", "plate.ngc"}) {
    SCOPED_TRACE(program);
    const std::filesystem::path input = kExamples / "compensate" / program, output = folder.path() / program;
    ASSERT_EQ(run(program, {"-o", program}).exit_code, ExitCode::done);
    const std::vector<ProgramMove> original = moves_of_linuxcnc(input), corrected = moves_of_linuxcnc(output);
    ASSERT_GE(original.size(), 30U);
    ASSERT_GE(corrected.size(), original.size());
    expect_same_moves(original, moves_of(input, true));
    expect_same_moves(corrected, moves_of(output, true));
    expect_followed(original, corrected, 1.1e-3);
  }
}

}  // namespace
}  // namespace abbe
