#include "abbe/study/compensation/program_settings.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

Machine trunnion() { return read_machine(ABBE_SOURCE_DIR "/examples/machines/trunnion-mill.machine.toml"); }

TEST(ProgramWordAxes, AreThoseOfTheNamesUnlessOthersAreGiven) {
  Machine machine = trunnion();
  const WordAxes named = program_word_axes(machine, {});
  EXPECT_EQ(named.of(AxisWord::X), machine.find_axis("X"));
  EXPECT_EQ(named.of(AxisWord::C), machine.find_axis("C"));
  EXPECT_EQ(named.of(AxisWord::B), Machine::npos);
  const WordAxes other = program_word_axes(machine, {"C=B"});
  EXPECT_EQ(other.of(AxisWord::B), machine.find_axis("C"));
  EXPECT_EQ(other.of(AxisWord::C), Machine::npos);
  EXPECT_EQ(
      message_of([&] { program_word_axes(machine, {"C=V"}); }),
      "--word: axis C is rotary, but its word V is not; expected A, B or C for rotary axes, X, Y, Z, U, V or W for "
      "linear ones");
  for (std::size_t i = 0; i < machine.axes.size(); ++i) machine.axes[i].name += "1";
  EXPECT_EQ(message_of([&] { program_word_axes(machine, {}, "m.toml"); }),
            "m.toml: no axis of the machine has a program word; expected --word AXIS=WORD, such as --word C1=C");
}

TEST(ProgramStart, IsThatOfTheAxisOfTheWord) {
  const Machine machine = trunnion();
  const WordAxes words = program_word_axes(machine, {"C=B"});
  NcProgramOptions options;
  const std::size_t c = axis_of_word(words, "B", "B_deg=30");
  set_program_start(machine, words, {c, 30 * kDegree}, false, "B_deg=30", options);
  EXPECT_EQ(options.start[static_cast<std::size_t>(AxisWord::B)], 30 * kDegree);
  EXPECT_EQ(message_of([&] { axis_of_word(words, "C", "C_deg=30"); }),
            "--start C_deg=30: no axis of the machine has the word 'C'; expected WORD_unit=position, such as "
            "X_mm=100 or C_deg=30");
}

TEST(ProgramStart, OutsideTheTravelIsRefusedUnlessItIsThatOfTheToolCentre) {
  const Machine machine = trunnion();
  const WordAxes words = program_word_axes(machine, {});
  NcProgramOptions options;
  const std::size_t x = machine.find_axis("X");
  const HeldAxis far{x, machine.axes[x].travel_max + 1};
  const std::string problem = message_of([&] { set_program_start(machine, words, far, false, "X_mm=1", options); });
  EXPECT_NE(problem.find("--start X_mm=1: outside the axis's travel; expected "), std::string::npos) << problem;
  EXPECT_FALSE(options.start[0].has_value());
  set_program_start(machine, words, far, true, "X_mm=1", options);
  EXPECT_EQ(options.start[0], far.position);
}

TEST(ProblemsThatAreAllowed, AreFoundByTheirNames) {
  const AllowedProblems none = allowed_problems({});
  EXPECT_FALSE(none.not_covered || none.outside_travel || none.held_start || none.position_left || none.not_converged ||
               none.not_proven);
  const std::vector<std::string> two = {"held-start", "not-proven"};
  const AllowedProblems some = allowed_problems(two);
  EXPECT_TRUE(some.held_start && some.not_proven);
  EXPECT_FALSE(some.not_covered || some.outside_travel || some.position_left || some.not_converged);
  const std::vector<std::string> wrong = {"held_start"};
  EXPECT_EQ(message_of([&] { allowed_problems(wrong); }),
            "--allow held_start: unknown; expected not-covered, outside-travel, held-start, position-left, "
            "not-converged or not-proven");
}

TEST(UsualLimitsOfAProgram, GrowWithItsSize) {
  EXPECT_EQ(default_program_limits(0).megabytes, 200);
  EXPECT_EQ(default_program_limits(0).minutes, 5);
  EXPECT_EQ(default_program_limits(10'000'000).megabytes, 400);
  EXPECT_EQ(default_program_limits(10'000'000).minutes, 6);
}

TEST(ErrorsThatAreDistrusted, AreRefusedUnlessThatIsAccepted) {
  ErrorsFile file;
  require_trusted(file, "e.toml", false);
  file.distrusted = {"chi-square 9"};
  EXPECT_EQ(message_of([&] { require_trusted(file, "e.toml", false); }),
            "e.toml: distrusted: the identification marked these errors as not to be trusted: chi-square 9; expected "
            "errors whose cause was found, or --accept-misfit to use them as they are");
  require_trusted(file, "e.toml", true);
  file.misfit_accepted = true;
  require_trusted(file, "e.toml", false);
}

}  // namespace
}  // namespace abbe
