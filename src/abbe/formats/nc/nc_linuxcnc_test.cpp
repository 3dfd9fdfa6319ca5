// Against LinuxCNC's own interpreter, `rs274` and its module `gcode`: the same programs give the same moves, and so do
// those that are written.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "abbe/formats/nc/linuxcnc_for_test.h"
#include "abbe/formats/nc/nc_correctors_for_test.h"

namespace abbe {
namespace {

using test::Canon;
using test::CanonMove;

/// 4 decimals of mm, or of inches.
constexpr double kPrinted = 2.6e-3;
/// mm or degrees: rounding of inches to mm, and nine decimals of what is written.
constexpr double kDoubles = 1e-9;

void expect_same(const std::vector<CanonMove>& expected, const std::vector<CanonMove>& found, double tolerance) {
  ASSERT_FALSE(expected.empty());
  for (std::size_t i = 0; i < std::min(expected.size(), found.size()); ++i) {
    SCOPED_TRACE(fmt::format("move {}", i + 1));
    ASSERT_EQ(expected[i].kind, found[i].kind);
    for (std::size_t k = 0; k < 6; ++k) ASSERT_NEAR(expected[i].end[k], found[i].end[k], tolerance) << "XYZABC"[k];
    for (std::size_t k = 0; k < 2; ++k) ASSERT_NEAR(expected[i].centre[k], found[i].centre[k], tolerance);
    ASSERT_EQ(expected[i].turns, found[i].turns);
  }
  ASSERT_EQ(expected.size(), found.size());
}

/// rs274 has no machine of its own: its parameters are in inches.
NcProgramOptions options() {
  NcProgramOptions o = options_at_zero();
  o.parameters_in_inches = true;
  for (const int first : {5161, 5181}) {
    for (int k = 0; k < 6; ++k) o.parameters[first + k] = 0;
  }
  return o;
}

struct NamedProgram {
  const char* name;
  const char* text;
};
void PrintTo(const NamedProgram& program, std::ostream* out) { *out << program.name; }

/// Moves of the program that is written against those of the original.
void expect_same_ends(const Canon& original, const Canon& written, double tolerance) {
  // Arcs are chords there; every end point is met in its order, and nothing else is between straight moves.
  std::size_t at = 0;
  for (const CanonMove& move : original.moves) {
    SCOPED_TRACE(fmt::format("move {} of {}", &move - original.moves.data() + 1, original.moves.size()));
    const auto is_there = [&](const CanonMove& other) {
      bool same = true;
      for (std::size_t k = 0; k < 6; ++k) same = same && std::abs(other.end[k] - move.end[k]) < tolerance;
      return same;
    };
    if (move.kind != 'A') {
      ASSERT_LT(at, written.moves.size());
      ASSERT_TRUE(is_there(written.moves[at]));
      ASSERT_EQ(written.moves[at].kind, move.kind);
      ++at;
      continue;
    }
    const std::size_t first = at;
    // The last piece of the arc is its end: a full circle passes near it earlier only when it begins.
    const std::size_t least = first + static_cast<std::size_t>(4 * std::abs(move.turns)) - 1;
    at = std::min(least, written.moves.size());
    while (at < written.moves.size() && !is_there(written.moves[at])) ++at;
    ASSERT_LT(at, written.moves.size());
    ++at;
  }
  ASSERT_EQ(at, written.moves.size());
}

class SameAsLinuxCnc : public testing::TestWithParam<NamedProgram> {
 protected:
  void SetUp() override {
    if (test::rs274().empty()) GTEST_SKIP() << "rs274 (Debian package linuxcnc-uspace) is not installed";
  }
};

TEST_P(SameAsLinuxCnc, MovesOfAProgram) {
  const Canon canon = test::run_rs274(GetParam().text);
  ASSERT_EQ(canon.error, "");
  const RunProgram run = run_program(GetParam().text, options());
  expect_same(canon.moves, test::canon_moves(run.moves), kPrinted);
}

TEST_P(SameAsLinuxCnc, MovesOfTheProgramThatIsWritten) {
  const RunProgram run = run_program(GetParam().text, options());
  const Canon written = test::run_rs274(run.text);
  ASSERT_EQ(written.error, "") << run.text;
  SCOPED_TRACE(run.text);
  expect_same_ends(test::run_rs274(GetParam().text), written, kPrinted);
}

TEST_P(SameAsLinuxCnc, MovesOfBothInFullDoubles) {
  if (!test::has_gcode_module()) GTEST_SKIP() << "LinuxCNC's Python module gcode is not installed";
  const Canon original = test::run_gcode_module(GetParam().text);
  ASSERT_EQ(original.error, "");
  NcProgramOptions fine = options();
  fine.parameters_in_inches = false;  // the module has them in the unit of the machine
  fine.decimals_mm = fine.decimals_deg = 9;
  const RunProgram run = run_program(GetParam().text, fine);
  expect_same(original.moves, test::canon_moves(run.moves), kDoubles);
  const Canon written = test::run_gcode_module(run.text);
  ASSERT_EQ(written.error, "") << run.text;
  SCOPED_TRACE(run.text);
  expect_same_ends(original, written, kDoubles);
}

const std::array kPrograms = {
    NamedProgram{"lines", "G21 G90\nG0 X1 Y2 Z3\nG1 X4 F100\nG91 X1 Y-1\nG90 Z-.5\nM2\n"},
    NamedProgram{"five_axes",
                 "G21 G90 G94\nT1 M6\nG43 H1\nG0 X0 Y0 Z-50 A0 C0\nG1 X100 Y50 Z-80 A10 C30 F600\nA-20 C370\n"
                 "G2 X120 Y50 I10 J0 A5\nG49\nG0 X0 Y0 Z0 A0 C0\nM2\n"},
    NamedProgram{
        "arcs_by_centre",
        "G21 F100\nG2 X10 Y0 I5 J0\nG3 X10 Y10 J5\nG2 I2\nG18 G3 X0 Z0 I-5\nG2 X3 Z3 K3\nG19 G3 Y0 Z13 J-5 K5\n"
        "G17 G90.1 G3 X5 Y2 I4 J1\nG91.1 G91 G2 X4 Y0 I2 J0\nM2\n"},
    NamedProgram{"arcs_by_radius",
                 "G21 F100\nG2 X3 Y4 R5\nG3 X0 Y1 R-4\nG18 G2 X3 Z4 R5\nG3 X7 Z9 R-8\nG19 G3 Y3 Z7 R4\nG2 Y0 Z0 R-6\n"
                 "G17 G2 X9.001 Y0 R3.0004\nM2\n"},
    NamedProgram{"helices", "G21 F100\nG2 X10 Y0 Z3 I5 J0 P3\nG3 X10 Y0 Z0 I-5 P2 A30\nG18 G2 X0 Z0 Y5 I-5 P1\nM2\n"},
    NamedProgram{"work_offsets",
                 "G21\nG10 L2 P1 X1 Y2 Z3\nG10 L2 P2 X10 A5\nG0 X0 Y0 Z0\nG55 X0 Y0 A0\nG10 L20 P2 X5\nX6\n"
                 "G53 G0 X7 Y8\nG10 L2 P9 Z4\nG59.3 G0 Z1\nG59 Z1\nG54 X1\nM2\n"},
    NamedProgram{"axis_offsets",
                 "G21\nG0 X1 Y2 Z3\nG92 X0 Y0\nX5\nG92.2\nX5\nG92.3\nX5 A10\nG92 A0\nA1\nG92.1\nX5\nG52 X1\nX5 A1\n"
                 "G92 X3\nX4\nG92.1\nX0\nM2\n"},
    NamedProgram{
        "tool_lengths",
        "G21\nG43 H1\nG0 Z0\nG43 H2\nX0 Y0 Z0\nG43.1 Z5\nX0 Z0\nG43.2 H1\nZ0\nG49\nX0 Z0\nT2 M6\nG43\nX1 Z1\nM2\n"},
    NamedProgram{"inches",
                 "G20 F10\nG0 X1 Y.5\nG1 Z-.1\nG21 X3\nG2 X5 Y12.7 I1\nG20 G91 G1 X1\nG2 X.1 I.05\nG21 G1 A9\nM2\n"},
    NamedProgram{"drilling",
                 "G21 F100\nG0 Z10\nG99 G81 X1 Y1 Z-1 R2\nX2\nG98 G82 X3 Z-1 R2 P.1\nG83 X4 Z-3 R1 Q1.2\n"
                 "G73 X5 Z-3 R1 Q1.2\nG85 X6 Z-1 R3\nG89 X7 Z-1 R3 P.2\nX8 R4\nG99 X9 Z-2\nG98 X10 R12\nX11 R2\nG99 "
                 "X12 R5\nX13 R1\nG80\nG0 X0\nM2\n"},
    NamedProgram{"cycles_that_are_cancelled",
                 "G21 F100\nG0 G17 G40 G49 G80 Z9\nG80 G81 X1 Y1 Z1 R2\nX2\nG81 G80 X3\nG80 G1 X4\nX5\nG81 X6 Z1 "
                 "R2\nG80 G0 X7\nG80 G80\nG0 X8\nM2\n"},
    NamedProgram{"drilling_from_hole_to_hole",
                 "G21 F100\nG0 Z10\nG98 G81 X1 Y1 Z-1 R2\nX2 G99 R4\nX3 G98 R3\nX4 R12\nX5 G99 R2\nX6 G98 R2\nG80\n"
                 "G0 Z1\nG98 G81 X7 R3 Z-1 L2\nX8 G99 R5\nX9 G98 R4\nG80\nM2\n"},
    NamedProgram{"drilling_by_increments",
                 "G21 F100\nG0 Z10\nG91 G81 X1 Y1 Z-3 R-2 L3\nX1\nG98 G81 X1 Y1 Z-3 R-2 L2\nX1\nG99 X1\nX1\nX1 R1\nG90 "
                 "G0 Z20\nM2\n"},
    NamedProgram{"drilling_in_other_planes",
                 "G21 F100\nG18 G0 Y10\nG81 X1 Z1 Y-3 R2 L2\nG80\nG19 G0 X9\nG82 Y1 Z2 X-3 R1 P1\nZ5\nG80\nM2\n"},
    NamedProgram{"boring_with_the_spindle_stopped", "G21 F100 M3 S100\nG0 Z10\nG86 X1 Y1 Z-1 R2 P.5\nG80\nM2\n"},
    NamedProgram{"pecking_beside_overrides",
                 "G21 F100 M3 S100\nG0 Z10\nG83 X1 Y1 Z-1 R2 Q1 M52\nX2 M50 P0\nG73 X3 Z-2 R2 Q1 M51 P1\nG80\nM2\n"},
    NamedProgram{"tapping",
                 "G21 F100 M3 S100\nG0 Z10\nG84 X1 Y1 Z-1 R2 P.5\nX2\nG98 X3\nG80\nM4\nG74 X5 Z-3 R1\nG80\nG0 "
                 "X0\nM2\n"},
    NamedProgram{"threads",
                 "G21 M3 S100\nG0 X0 Y0 Z10\nG33 Z-5 K1.5\nX1 Z-8 K1\nG0 Z10\nG33.1 Z5 K1.5\nG0 X3\nG20\nG33.1 X.2 "
                 "Z.1 K.05\nG91 G33 Z-.1 K.1\nM2\n"},
    NamedProgram{"subroutines",
                 "G21\nO100 sub\nG0 X#1 Y#2 Z#3\n#1=7\nO100 endsub [#1]\nO100 call [1] [2]\nG0 Y#<_value>\n"
                 "O<hole> sub\nO5 if [#1 GT 3]\nO<hole> return [2]\nO5 endif\nG0 Z#1\nO<hole> endsub\n"
                 "O<hole> call [1]\nO<hole> call [5]\nG0 A#<_value>\nM2\n"},
    NamedProgram{"loops",
                 "G21\n#1=0\nO1 while [#1 LT 3]\n#1=[#1+1]\nG0 X#1\nO1 endwhile\n"
                 "O3 do\nG0 Y#1\n#1=[#1+1]\nO3 while [#1 LT 5]\nO4 repeat [2]\nG91 X1\nO4 endrepeat\nG90\n#1=0\n"
                 "O6 while [#1 LT 6]\n#1=[#1+1]\nO7 if [[#1 MOD 2] EQ 0]\nO6 continue\nO7 elseif [#1 EQ 3]\nG0 Z3\n"
                 "O7 else\nG0 Z[10+#1]\nO7 endif\nG0 A#1\nO8 if [#1 EQ 5]\nO6 break\nO8 endif\nO6 endwhile\nM2\n"},
    NamedProgram{"subprograms", "G21\n#1=5\nM98 P100 L2\nG0 Y#1\nM2\nO100\nG91 G0 X1\n#1=7\nG90\nM99\n"},
    NamedProgram{"subprograms_with_names",
                 "G21\n#<a>=5\n#1=1\nM98 P100 L2\nG0 X#<a> Y#1\nM2\nO100\nG0 Z[EXISTS[#<a>]]\n#<a>=3\n#1=[#1+1]\n"
                 "G0 A#<a>\nM99\n"},
    NamedProgram{
        "expressions",
        "G21\n#1=[2**3**2]\n#2=[1 EQ 1.00005]\n#3=[-5 MOD 3]\n#<tall>=ATAN[1]/[-1]\n#6=ROUND[-2.5]\n#7=FIX[-2.5]\n"
        "#8=FUP[-2.5]\n#9=[2+3*4**2-10/5]\nG0 X#1 Y#2 Z#3 A#<tall> C#6\nX#7 Y#8 Z#9\nX-#1 Y-sin[30] Z[1 AND 1 OR 0 XOR "
        "1]\n"
        "X[1 GT 0 AND 2 GT 3] Y[1 + 2 EQ 3]\n#10=2\n#2=9 X##10 #10=7\n#10=2\nX##10 Y#[1+1] Z--5\nX[-2**2] Y[0-2**2] "
        "Z[1+-2]\n"
        "X sqrt[2] Y acos[.5] Z ln[10]\nX exp[1] Y tan[30] Z abs[-3] A exists[#<nothing>]\nX[7 MOD -4] Y[-7 MOD -4]\n"
        "X1 2 . 5 y+.25\nM2\n"},
    NamedProgram{"positions_in_expressions",
                 "G21\nG0 X3 A4\nG0 Y#5420 Z#<_x>\nG10 L2 P1 X1\nG0 Y#5420 Z#5221\nG20 G0 X#5420\nM2\n"},
    NamedProgram{"inverse_time",
                 "G21 G93\nG1 X1 F2\nX2 A9 F60\nG2 X4 Y0 I1 F3\nG94 F50\nG1 X9\nG0 Z1\nG1 A90 F360\nM2\n"},
    NamedProgram{"references",
                 "G21\nG0 X20 Y20 Z3\nG28.1\nG0 X1 Y1 Z1\nG28 X5\nG30.1\nG0 A30\nG91 G28 Z2\nG90 G30\nM2\n"},
    NamedProgram{"percent_signs", "%\nN10 G21 (first)\nN20 G0 X1 ; and\n/G0 X2\nn30 x3\nM2\n%\nG0 X9\n"},
};

INSTANTIATE_TEST_SUITE_P(Programs, SameAsLinuxCnc, testing::ValuesIn(kPrograms),
                         [](const testing::TestParamInfo<NamedProgram>& program) {
                           return std::string(program.param.name);
                         });

}  // namespace
}  // namespace abbe
