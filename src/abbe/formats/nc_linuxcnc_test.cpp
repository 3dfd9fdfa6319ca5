// Against LinuxCNC's own interpreter, `rs274`: the same programs give the same moves, and so do those that are written.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "abbe/formats/child_process.h"
#include "abbe/formats/message_of.h"
#include "abbe/formats/nc_correctors_for_test.h"

namespace abbe {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

std::string rs274() {
  const char* const folders = std::getenv("PATH");
  std::istringstream list(folders == nullptr ? "" : folders);
  for (std::string folder; std::getline(list, folder, ':');) {
    const std::filesystem::path path = std::filesystem::path(folder) / "rs274";
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored)) return path.string();
  }
  return "";
}

/// A move as `rs274` prints it, in mm and degrees of the control.
struct CanonMove {
  char kind = 0;  ///< T rapid, F straight, A arc
  std::array<double, 6> end{};
  std::array<double, 2> centre{};  ///< first and second axis of the plane
  int turns = 0;                   ///< signed
  double feed = 0;                 ///< as in force; mm/min in G21
};

struct Canon {
  std::vector<CanonMove> moves;
  std::string error;
};

std::vector<double> numbers(const std::string& text) {
  std::vector<double> values;
  const char* at = text.c_str();
  while (*at != 0) {
    char* end = nullptr;
    const double value = std::strtod(at, &end);
    if (end == at) {
      ++at;
    } else {
      values.push_back(value);
      at = end;
    }
  }
  return values;
}

class Rs274 {
 public:
  Canon run(const std::string& program) {
    const std::string folder = std::filesystem::path(testing::TempDir()) / fmt::format("abbe_rs274_{}", ::getpid());
    std::filesystem::create_directories(folder);
    const std::string ngc = folder + "/program.ngc", var = folder + "/parameters.var", tools = folder + "/tools.tbl";
    std::ofstream(ngc) << program;
    std::ofstream(var) << "5161\t0\n5181\t0\n5220\t1\n";
    // It takes the lengths of its table for inches.
    std::ofstream(tools) << fmt::format("T1 P1 Z{:.12f}\nT2 P2 X{:.12f} Y{:.12f} Z{:.12f}\n", 50 / 25.4, 1 / 25.4,
                                        2 / 25.4, 30 / 25.4);
    // Its tools stand in a file of the home folder, which another one at work would take away.
    const ChildProcess process({"/usr/bin/env", "HOME=" + folder, rs274(), "-g", "-v", var, "-t", tools, ngc}, 60);
    Canon canon = read(std::string(process.output()));
    if (std::string(process.output()).find("PROGRAM_END") == std::string::npos &&
        program.find("M2") != std::string::npos) {
      canon.error = "rs274 did not reach the end: " + std::string(process.messages()) + std::string(process.output());
    }
    std::filesystem::remove_all(folder);
    return canon;
  }

 private:
  static Canon read(const std::string& output) {
    Canon canon;
    std::array<double, 6> system{}, axis_offset{}, tool{};
    double unit = 1, feed = 0;
    std::array<std::size_t, 3> plane = {0, 1, 2};
    std::array<double, 6> now{};
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
      const std::size_t open = line.find('(');
      const std::size_t blank = line.rfind(' ', open);
      if (open == std::string::npos || blank == std::string::npos) continue;
      const std::string name = line.substr(blank + 1, open - blank - 1);
      const std::string inside = line.substr(open + 1);
      const std::vector<double> v = numbers(inside);
      const auto scaled = [&](std::size_t first, std::array<double, 6>& values) {
        for (std::size_t k = 0; k < 6; ++k) values[k] = k < 3 ? unit * v[first + k] : v[first + k];
      };
      if (name == "USE_LENGTH_UNITS") unit = inside.find("INCHES") != std::string::npos ? 25.4 : 1;
      if (name == "SET_G5X_OFFSET") scaled(1, system);
      if (name == "SET_G92_OFFSET") scaled(0, axis_offset);
      if (name == "USE_TOOL_LENGTH_OFFSET") scaled(0, tool);
      if (name == "SET_FEED_RATE") feed = v[0];
      if (name == "SELECT_PLANE") {
        if (inside.find("XY") != std::string::npos) plane = {0, 1, 2};
        if (inside.find("XZ") != std::string::npos) plane = {2, 0, 1};
        if (inside.find("YZ") != std::string::npos) plane = {1, 2, 0};
      }
      CanonMove move;
      if (name == "STRAIGHT_TRAVERSE" || name == "STRAIGHT_FEED") {
        move.kind = name == "STRAIGHT_FEED" ? 'F' : 'T';
        scaled(0, move.end);
        for (std::size_t k = 0; k < 6; ++k) move.end[k] += system[k] + axis_offset[k] + tool[k];
      } else if (name == "ARC_FEED") {
        move.kind = 'A';
        move.end[plane[0]] = unit * v[0];
        move.end[plane[1]] = unit * v[1];
        move.end[plane[2]] = unit * v[5];
        for (std::size_t k = 3; k < 6; ++k) move.end[k] = v[k + 3];
        for (std::size_t k = 0; k < 6; ++k) move.end[k] += system[k] + axis_offset[k] + tool[k];
        for (std::size_t i = 0; i < 2; ++i) {
          const std::size_t k = plane[i];
          move.centre[i] = unit * v[2 + i] + system[k] + axis_offset[k] + tool[k];
        }
        move.turns = static_cast<int>(v[4]);
      } else {
        continue;
      }
      move.feed = feed;
      // It repeats where it stands between the holes of a cycle.
      if (move.kind == 'A' || move.end != now) canon.moves.push_back(move);
      now = move.end;
    }
    return canon;
  }
};

std::vector<CanonMove> as_canon(const std::vector<ProgramMove>& moves) {
  std::vector<CanonMove> canon;
  for (const ProgramMove& move : moves) {
    CanonMove& c = canon.emplace_back();
    const bool is_arc = move.kind == MoveKind::arc_clockwise || move.kind == MoveKind::arc_counterclockwise;
    c.kind = is_arc ? 'A' : move.kind == MoveKind::rapid ? 'T' : 'F';
    for (std::size_t k = 0; k < 6; ++k) c.end[k] = k < 3 ? move.end[k] : move.end[k] / kDegree;
    if (is_arc) {
      const std::size_t a = move.plane == ArcPlane::XY ? 0 : move.plane == ArcPlane::ZX ? 2 : 1;
      c.centre = {move.arc_centre[a], move.arc_centre[(a + 1) % 3]};
      c.turns = move.kind == MoveKind::arc_clockwise ? -move.arc_turns : move.arc_turns;
    }
    if (!is_arc && move.start == move.end) canon.pop_back();
  }
  return canon;
}

/// 4 decimals of mm, or of inches.
constexpr double kPrinted = 2.6e-3;

void expect_same(const std::vector<CanonMove>& expected, const std::vector<CanonMove>& found) {
  ASSERT_FALSE(expected.empty());
  for (std::size_t i = 0; i < std::min(expected.size(), found.size()); ++i) {
    SCOPED_TRACE(fmt::format("move {}", i + 1));
    ASSERT_EQ(expected[i].kind, found[i].kind);
    for (std::size_t k = 0; k < 6; ++k) ASSERT_NEAR(expected[i].end[k], found[i].end[k], kPrinted) << "XYZABC"[k];
    for (std::size_t k = 0; k < 2; ++k) ASSERT_NEAR(expected[i].centre[k], found[i].centre[k], kPrinted);
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

class SameAsLinuxCnc : public testing::TestWithParam<NamedProgram> {
 protected:
  void SetUp() override {
    if (rs274().empty()) GTEST_SKIP() << "rs274 (Debian package linuxcnc-uspace) is not installed";
  }
};

TEST_P(SameAsLinuxCnc, MovesOfAProgram) {
  Rs274 linuxcnc;
  const Canon canon = linuxcnc.run(GetParam().text);
  ASSERT_EQ(canon.error, "");
  const RunProgram run = run_program(GetParam().text, options());
  expect_same(canon.moves, as_canon(run.moves));
}

TEST_P(SameAsLinuxCnc, MovesOfTheProgramThatIsWritten) {
  Rs274 linuxcnc;
  const RunProgram run = run_program(GetParam().text, options());
  const Canon original = linuxcnc.run(GetParam().text);
  const Canon written = linuxcnc.run(run.text);
  ASSERT_EQ(written.error, "") << run.text;
  // Arcs are chords there; every end point is met in its order, and nothing else is between straight moves.
  std::size_t at = 0;
  for (const CanonMove& move : original.moves) {
    SCOPED_TRACE(fmt::format("move {} of {}", &move - original.moves.data() + 1, original.moves.size()));
    const auto is_there = [&](const CanonMove& other) {
      bool same = true;
      for (std::size_t k = 0; k < 6; ++k) same = same && std::abs(other.end[k] - move.end[k]) < kPrinted;
      return same;
    };
    if (move.kind != 'A') {
      ASSERT_LT(at, written.moves.size());
      ASSERT_TRUE(is_there(written.moves[at])) << run.text;
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
  ASSERT_EQ(at, written.moves.size()) << run.text;
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
    NamedProgram{"drilling_by_increments",
                 "G21 F100\nG0 Z10\nG91 G81 X1 Y1 Z-3 R-2 L3\nX1\nG98 G81 X1 Y1 Z-3 R-2 L2\nX1\nG99 X1\nX1\nX1 R1\nG90 "
                 "G0 Z20\nM2\n"},
    NamedProgram{"drilling_in_other_planes",
                 "G21 F100\nG18 G0 Y10\nG81 X1 Z1 Y-3 R2 L2\nG80\nG19 G0 X9\nG82 Y1 Z2 X-3 R1 P1\nZ5\nG80\nM2\n"},
    NamedProgram{"boring_with_the_spindle_stopped", "G21 F100 M3 S100\nG0 Z10\nG86 X1 Y1 Z-1 R2 P.5\nG80\nM2\n"},
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
