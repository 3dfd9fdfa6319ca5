#include "abbe/machine/drawing.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

std::size_t columns(const std::string& line) {
  std::size_t count = 0;
  for (char c : line) count += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  return count;
}

TEST(Drawing, IsThisForATrunnionMill) {
  EXPECT_EQ(draw_machine(test::trunnion_mill()), R"(trunnion mill
w C' A' Y' b X Z t

  w  workpiece
  │    origin (0, 0, 0) mm
  ○ C'  ↺ about -Z  through (0, 0, 0)      endless
  ○ A'  ↺ about -X  through (0, 0.02, 50)  -120 … 30 deg
  □ Y'  ↙ along -Y                         -255 … 255 mm
══╪══ b  bed ═══════════════════════════════════════════
  □ X   → along +X                         -300 … 300 mm
  □ Z   ↑ along +Z                         -510 … 0 mm
  │    gauge point (0, 0, 560) mm
  │    functional point (0, 0, 410) mm
  t  tool ↓ pointing along -Z

□ linear, ○ rotary: motion of what the axis carries at a positive command, seen
from the front (→ X, ↗ Y away, ↑ Z); ↺ right-handed. Points in mm with all axes
at zero.
)");
}

TEST(Drawing, FitsEightyColumnsWithOneLineForEveryAxis) {
  std::vector<test::NamedMachine> machines = test::all_machines();
  Machine awkward = test::yin_engraver('U');
  for (Axis& axis : awkward.axes) axis.direction = Eigen::Vector3d(-1, -2, -3).normalized();
  for (Axis& axis : awkward.axes) axis.point = {-12345.678, -98765.432, -55555.555};
  awkward.name = std::string(60, 'n') + " " + std::string(60, 'm');
  machines.push_back({"awkward", awkward});
  for (const test::NamedMachine& named : machines) {
    const std::string drawing = draw_machine(named.machine);
    std::istringstream lines(drawing);
    std::string text;
    for (std::string line; std::getline(lines, line);) {
      EXPECT_LE(columns(line), 80u) << named.name << ": " << line;
      EXPECT_TRUE(line.empty() || line.back() != ' ') << named.name << ": " << line;
    }
    for (const Axis& axis : named.machine.axes) {
      const std::string symbol = axis.kind == AxisKind::linear ? "□ " : "○ ";
      EXPECT_NE(drawing.find("  " + symbol + axis.name + (axis.primed ? "' " : " ")), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace abbe
