#include "abbe/machine/chain.h"

#include <gtest/gtest.h>

#include <limits>

#include "abbe/machine/machine_check.h"

namespace abbe {
namespace {

TEST(Chain, IsReadWithAndWithoutBlanks) {
  for (const char* text : {"w C' X' b Z t", "wC'X'bZt", "  w  C'\tX' bZ t ", "w C\xE2\x80\xB2 X\xE2\x80\xB2 b Z t"}) {
    const ParsedChain parsed = parse_chain(text);
    ASSERT_TRUE(parsed.ok) << parsed.error.message();
    EXPECT_EQ(parsed.machine.chain(), "w C' X' b Z t");
    EXPECT_TRUE(find_problems(parsed.machine).empty());
  }
}

TEST(Chain, WritesBackWhatItReads) {
  for (const char* text : {"w b Z t", "w C2 X Y b Z C1 A t", "w C12' b X1 X2 t", "w C b X Z A Y B t", "w X' b t"}) {
    const ParsedChain parsed = parse_chain(text);
    ASSERT_TRUE(parsed.ok) << text << ": " << parsed.error.message();
    EXPECT_EQ(parsed.machine.chain(), text);
  }
}

TEST(Chain, GivesEveryLetterItsKindDirectionAndSide) {
  const Machine machine = parse_chain("w A' V' b W B t").machine;
  ASSERT_EQ(machine.axes.size(), 4u);
  EXPECT_EQ(machine.axes[0].kind, AxisKind::rotary);
  EXPECT_EQ(machine.axes[0].direction, Eigen::Vector3d::UnitX());
  EXPECT_EQ(machine.axes[1].kind, AxisKind::linear);
  EXPECT_EQ(machine.axes[1].direction, Eigen::Vector3d::UnitY());
  EXPECT_EQ(machine.axes[1].side, ChainSide::workpiece);
  EXPECT_EQ(machine.axes[2].direction, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(machine.axes[2].side, ChainSide::tool);
  EXPECT_EQ(machine.axes[3].direction, Eigen::Vector3d::UnitY());
  EXPECT_FALSE(machine.axes[3].primed);
}

TEST(Chain, AnUnprimedAxisMayCarryTheWorkpiece) {
  const ParsedChain parsed = parse_chain("w C b Z t");
  ASSERT_TRUE(parsed.ok);
  EXPECT_EQ(parsed.machine.axes[0].side, ChainSide::workpiece);
  EXPECT_EQ(parsed.machine.axes[0].sense(), 1.0);
}

struct WrongChain {
  const char* text;
  std::size_t position;
  std::size_t length;
  const char* found;
  const char* expected_part;
};

class ChainErrors : public testing::TestWithParam<WrongChain> {};

TEST_P(ChainErrors, AreLocatedAndSayWhatWasExpected) {
  const WrongChain& wrong = GetParam();
  const ParsedChain parsed = parse_chain(wrong.text);
  ASSERT_FALSE(parsed.ok) << wrong.text;
  EXPECT_EQ(parsed.error.position, wrong.position) << parsed.error.message();
  EXPECT_EQ(parsed.error.length, wrong.length) << parsed.error.message();
  EXPECT_EQ(parsed.error.found, wrong.found);
  EXPECT_NE(parsed.error.expected.find(wrong.expected_part), std::string::npos) << parsed.error.message();
}

INSTANTIATE_TEST_SUITE_P(
    All, ChainErrors,
    testing::Values(
        WrongChain{"", 0, 1, "the end", "w for the workpiece"}, WrongChain{"X b Z t", 0, 1, "'X'", "w for"},
        WrongChain{"w", 1, 1, "the end", "b for the bed"}, WrongChain{"w X t", 4, 1, "'t'", "b for the bed"},
        WrongChain{"w X b Z", 7, 1, "the end", "t for the tool"}, WrongChain{"w b Z b t", 6, 1, "'b'", "one bed only"},
        WrongChain{"w b Z t X", 8, 1, "'X'", "nothing"}, WrongChain{"w b t", 5, 1, "the end", "at least one axis"},
        WrongChain{"w c b Z t", 2, 1, "'c'", "capitals: C"}, WrongChain{"w x' b Z t", 2, 1, "'x'", "capitals: X"},
        WrongChain{"w C b Z T", 8, 1, "'T'", "small t"}, WrongChain{"w w C b Z t", 2, 1, "'w'", "once"},
        WrongChain{"w C 2 b Z t", 4, 1, "'2'", "follows its letter"},
        WrongChain{"w C ' b Z t", 4, 1, "'''", "follows its axis"}, WrongChain{"w C0 b Z t", 3, 1, "'0'", "1 to 99"},
        WrongChain{"w C123 b Z t", 3, 3, "'123'", "1 to 99"}, WrongChain{"w X b X t", 6, 1, "'X'", "number axes"},
        WrongChain{"w X1 b X1 t", 7, 2, "'X1'", "C1 and C2"}, WrongChain{"w b Z' t", 4, 2, "'Z''", "carry the tool"},
        WrongChain{"w X, b Z t", 3, 1, "','", "an axis"}, WrongChain{"w S b t", 2, 1, "'S'", "an axis"},
        WrongChain{"w \xC3\x84 b t", 2, 2, "'\xC3\x84'", "an axis"}));

TEST(Chain, PointsUnderThePlaceOfAnError) {
  const char* text = "w C' x b t";
  EXPECT_EQ(parse_chain(text).error.pointed(text), "w C' x b t\n     ^");
  const char* primes = "w C\xE2\x80\xB2 C\xE2\x80\xB2 b t";
  EXPECT_EQ(parse_chain(primes).error.pointed(primes), std::string(primes) + "\n     ^^");
}

bool has_problem(const Machine& machine, const std::string& axis, const std::string& field) {
  for (const MachineProblem& problem : find_problems(machine)) {
    if (problem.axis == axis && problem.field == field && !problem.message.empty()) return true;
  }
  return false;
}

TEST(MachineCheck, FindsEveryKindOfProblem) {
  const Machine sound = parse_chain("w C' X' b Z t").machine;
  ASSERT_TRUE(find_problems(sound).empty());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Machine m = sound;
  m.axes[0].direction = {0, 0, 2};
  EXPECT_TRUE(has_problem(m, "C", "direction"));
  m = sound;
  m.axes[0].point = {0, nan, 0};
  EXPECT_TRUE(has_problem(m, "C", "point"));
  m = sound;
  m.axes[1].travel_min = 300;
  EXPECT_TRUE(has_problem(m, "X", "travel"));
  m = sound;
  m.axes[1].travel_max = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(has_problem(m, "X", "travel"));
  m = sound;
  m.axes[1].name = "Z";
  EXPECT_TRUE(has_problem(m, "Z", "name"));
  m = sound;
  m.axes[1].name = "x";
  EXPECT_TRUE(has_problem(m, "x", "name"));
  m = sound;
  m.axes[1].kind = AxisKind::rotary;
  EXPECT_TRUE(has_problem(m, "X", "kind"));
  m = sound;
  m.axes[1].endless = true;
  EXPECT_TRUE(has_problem(m, "X", "endless"));
  m = sound;
  std::swap(m.axes[1], m.axes[2]);
  EXPECT_TRUE(has_problem(m, "X", "side"));
  m = sound;
  m.axes[2].primed = true;
  EXPECT_TRUE(has_problem(m, "Z", "primed"));
  m = sound;
  m.tool_direction = {1, 1, 0};
  EXPECT_TRUE(has_problem(m, "", "tool_direction"));
  m = sound;
  m.tool_offset.x() = nan;
  EXPECT_TRUE(has_problem(m, "", "tool_offset"));
  m = sound;
  m.bed_from_workpiece.rotation(0, 0) = -1;
  EXPECT_TRUE(has_problem(m, "", "bed_from_workpiece"));
  m.axes.clear();
  EXPECT_TRUE(has_problem(m, "", "axes"));
}

TEST(MachineCheck, SaysTheProblemInWords) {
  Machine m = parse_chain("w b Z t").machine;
  m.axes[0].direction = {0, 0, 2};
  ASSERT_EQ(find_problems(m).size(), 1u);
  EXPECT_EQ(find_problems(m)[0].text(), "axis Z: direction: (0, 0, 2) has length 2, must be 1");
}

}  // namespace
}  // namespace abbe
