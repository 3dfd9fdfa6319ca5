// What an NC program may not say, and how it is told.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/nc/nc_correctors_for_test.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

std::string refusal(std::string_view text) {
  return message_of([&] {
    NcProgramOptions options = options_at_zero();
    options.most_moves = 1000;
    options.most_idle_rounds = 1000;
    run_program(text, options);
  });
}

TEST(NcErrors, OfCodesThatAreNotHandled) {
  EXPECT_EQ(refusal("G1 X1 G41 F1\n"),
            "p.ngc:1:7: G41: cutter compensation is not handled: its path depends on the tool; expected a code of "
            "docs/nc-programs.md");
  EXPECT_EQ(refusal("G42.1 D1\n"),
            "p.ngc:1:1: G42.1: cutter compensation is not handled: its path depends on the tool; expected a code of "
            "docs/nc-programs.md");
  EXPECT_EQ(
      refusal("G76 P1 Z1\n"),
      "p.ngc:1:1: G76: this thread is not handled, only G33, G33.1, and the cycles G74 and G84; expected a code of "
      "docs/nc-programs.md");
  EXPECT_EQ(refusal("G33 Z1\n"), "p.ngc:1:1: G33: G33 without its pitch; expected K");
  EXPECT_EQ(refusal("G33.1 Z1 K-1\n"), "p.ngc:1:10: K-1: the pitch is not positive");
  EXPECT_EQ(refusal("G33 A1 K1\n"), "p.ngc:1:1: G33: G33 with words other than X, Y, Z");
  EXPECT_EQ(refusal("G33 Z0 K1\n"), "p.ngc:1:1: G33: G33 that does not move");
  EXPECT_EQ(refusal("G84 X1 Z-1 R2\n"),
            "p.ngc:1:1: G84: a canned cycle without a feed; expected F before or in this block");
  EXPECT_EQ(refusal("F1 M4 G84 X1 Z-1 R2\n"),
            "p.ngc:1:7: G84: the spindle does not turn as this cycle requires; expected M3");
  EXPECT_EQ(refusal("F1 M3\nT1 M6\nG84 X1 Z-1 R2\n"),
            "p.ngc:3:1: G84: the spindle does not turn as this cycle requires; expected M3");
  EXPECT_EQ(refusal("G38.2 X1 F1\n"),
            "p.ngc:1:1: G38.2: only the control knows where probing ends; expected a code of docs/nc-programs.md");
  EXPECT_EQ(refusal("G5 X1 I1 J1\n"),
            "p.ngc:1:1: G5: splines are not handled, nor is smoothing by the control (G5.1 Q1); expected a code of "
            "docs/nc-programs.md");
  EXPECT_EQ(refusal("G7\n"),
            "p.ngc:1:1: G7: diameter programming is not handled; expected a code of docs/nc-programs.md");
  EXPECT_EQ(refusal("G68.2 X0 Y0 Z0 I0 J0 K0\n"),
            "p.ngc:1:1: G68.2: the machine is not known, which a tilted plane needs");
  EXPECT_EQ(refusal("G87 X1\n"),
            "p.ngc:1:1: G87: this cycle is not handled: it needs the operator or an oriented spindle; expected a code "
            "of docs/nc-programs.md");
  EXPECT_EQ(refusal("G43.5 H1\n"),
            "p.ngc:1:1: G43.5: tool centre control by direction vectors is not handled; expected a code of "
            "docs/nc-programs.md");
  EXPECT_EQ(refusal("G17.05\n"), "p.ngc:1:1: G17.05: is not a G code; expected G0 to G99.9 in tenths");
  EXPECT_EQ(refusal("G200\n"), "p.ngc:1:1: G200: is not a G code; expected G0 to G99.9 in tenths");
  EXPECT_EQ(refusal("G47\n"),
            "p.ngc:1:1: G47: is not a G code that is handled; expected a code of docs/nc-programs.md");
  EXPECT_EQ(refusal("M70\n"),
            "p.ngc:1:1: M70: saving and restoring the modes is not handled; expected M0-M9 M19 M30 M48-M53 M60-M68 M98 "
            "M99 M100-M199");
  EXPECT_EQ(refusal("M250\n"), "p.ngc:1:1: M250: is not an M code; expected a whole number from 0 to 199");
  EXPECT_EQ(
      refusal("M17\n"),
      "p.ngc:1:1: M17: is not an M code that is handled; expected M0-M9 M19 M30 M48-M53 M60-M68 M98 M99 M100-M199");
  EXPECT_EQ(refusal("M3 M4\n"), "p.ngc:1:4: M4: a second M code of the same modal group in one block");
  EXPECT_EQ(refusal("M0 M30\n"), "p.ngc:1:4: M30: a second M code of the same modal group in one block");
  EXPECT_EQ(refusal("M7 M9\n"), "p.ngc:1:4: M9: a second M code of the same modal group in one block");
  EXPECT_EQ(refusal("M0 M6 M3 M8 M48\n"), "p.ngc:1:13: M48: more than four M codes in one block");
  EXPECT_EQ(refusal("G0 G1 X1\n"), "p.ngc:1:4: G1: a second G code of the same modal group in one block");
  EXPECT_EQ(refusal("G90 G91\n"), "p.ngc:1:5: G91: a second G code of the same modal group in one block");
  EXPECT_EQ(refusal("G0 @1 ^2\n"),
            "p.ngc:1:4: @1: polar coordinates are not handled; expected a letter and its value, a parameter that is "
            "set, or a comment");
  EXPECT_EQ(refusal("G10 L2 P1 R5\n"), "p.ngc:1:11: R5: a rotated work offset is not handled");
}

TEST(NcErrors, OfWordsThatAreWrongOrHaveNoUse) {
  EXPECT_EQ(refusal("G0 X1 X2\n"), "p.ngc:1:7: X2: this letter is in the block already");
  EXPECT_EQ(refusal("G0 X\n"),
            "p.ngc:1:5: a value is missing; expected a number, a parameter (#5, #<name>), an expression in [ ] or a "
            "function");
  EXPECT_EQ(refusal("G0 XY1\n"),
            "p.ngc:1:5: Y1: is not a value; expected a number, a parameter (#5, #<name>), an expression in [ ] or a "
            "function");
  EXPECT_EQ(refusal("G0 X1.5.5\n"),
            "p.ngc:1:8: .5: is not a word; expected a letter and its value, a parameter that is set, or a comment");
  EXPECT_EQ(refusal("G0 X1 $\n"),
            "p.ngc:1:7: $: is not a word; expected a letter and its value, a parameter that is set, or a comment");
  EXPECT_EQ(refusal("G0 X1 (abc\n"),
            "p.ngc:1:7: (abc: the comment does not end; expected a closing parenthesis in the same line");
  EXPECT_EQ(refusal("G0 X1 (a (b) c)\n"), "p.ngc:1:7: (a: a comment inside a comment");
  EXPECT_EQ(refusal("G0 N5 X1\n"), "p.ngc:1:4: N5: a line number stands first in its block");
  EXPECT_EQ(refusal("N X1\n"), "p.ngc:1:1: N X1: is not a line number; expected N and a number");
  EXPECT_EQ(refusal("X1 O5\n"), "p.ngc:1:4: O5: an O word stands first in its block");
  EXPECT_EQ(refusal("G0 X2000000000\n"), "p.ngc:1:4: X2000000000: is too large; expected a magnitude of at most 1e9");
  EXPECT_EQ(refusal("G0 U1\n"), "p.ngc:1:4: U1: the machine has no axis of this word");
  EXPECT_EQ(refusal("G0 I1 X1\n"), "p.ngc:1:4: I1: no code of this block uses it; expected G2, G3 or G68.2");
  EXPECT_EQ(refusal("G0 Q1 X1\n"),
            "p.ngc:1:4: Q1: no code of this block uses it; expected G64, G73, G83, M19, M61, M66 or M100-M199");
  EXPECT_EQ(refusal("G0 H1 X1\n"), "p.ngc:1:4: H1: no code of this block uses it; expected G43");
  EXPECT_EQ(refusal("G0 E1 X1\n"), "p.ngc:1:4: E1: no code of this block uses it; expected M66, M67 or M68");
  EXPECT_EQ(refusal("G1 X1 F-1\n"), "p.ngc:1:7: F-1: the feed is negative");
  EXPECT_EQ(refusal("S-1\n"), "p.ngc:1:1: S-1: the speed of the spindle is negative");
  EXPECT_EQ(refusal("T1.5\n"), "p.ngc:1:1: T1.5: is not the number of a tool");
  EXPECT_EQ(refusal("G1 X1\n"), "p.ngc:1:1: G1: G1 without a feed; expected F before or in this block");
  EXPECT_EQ(refusal("G93 G1 X1\n"),
            "p.ngc:1:1: G93: G1 with inverse time and without F; expected F in 1/min in every block of such moves");
  EXPECT_EQ(refusal("G93 F3\nG1 X1\n"),
            "p.ngc:2:1: G1: G1 with inverse time and without F; expected F in 1/min in every block of such moves");
  EXPECT_EQ(refusal("G92\n"), "p.ngc:1:1: G92: axis words are missing");
  EXPECT_EQ(refusal("G92 X1 G1 Y1 F1\n"), "p.ngc:1:8: G1: two codes of this block use the axis words");
  EXPECT_EQ(refusal("G10 X1\n"), "p.ngc:1:1: G10: is not a G10 that is handled; expected L1, L2 or L20");
  EXPECT_EQ(refusal("G10 L2 X1\n"), "p.ngc:1:1: G10: P is missing; expected 0 (current) to 9 (G59.3)");
  EXPECT_EQ(refusal("G10 L2 P12 X1\n"), "p.ngc:1:8: P12: is not a work offset; expected 0 (current) to 9 (G59.3)");
  EXPECT_EQ(refusal("G10 L11 P1 X1\n"), "p.ngc:1:5: L11: is not a G10 that is handled; expected L1, L2 or L20");
  EXPECT_EQ(refusal("G43 H9\n"), "p.ngc:1:5: H9: the tool table has no tool 9");
  EXPECT_EQ(refusal("G43 H1.5\n"), "p.ngc:1:5: H1.5: is not the number of a tool");
  EXPECT_EQ(refusal("G43\n"),
            "p.ngc:1:1: G43: it is not known which tool is in the spindle; expected H, or T and M6 before it");
  EXPECT_EQ(refusal("G43.1\n"), "p.ngc:1:1: G43.1: the offset of the tool is missing; expected axis words");
  EXPECT_EQ(refusal("G43.4 H1\nG43 H1\n"),
            "p.ngc:2:1: G43: another tool length while tool centre control is on; expected G49 before it");
  EXPECT_EQ(
      refusal("G43.4 H1\nG1 X1 F1\n"),
      "p.ngc:2:1: G1: where X, Y, Z stand is not known here, and a move at work begins there; expected a G0 before "
      "it that names these axes, or where they stand when the program begins (--start X_mm=0)");
  EXPECT_EQ(refusal("G43.4 H1\nG0 X1 Y1 Z1\nG53 G0 X1\n"),
            "p.ngc:3:1: G53: G53 while tool centre control is on; expected G49 before it");
  for (const char* code : {"G28", "G28.1", "G30.1"}) {
    EXPECT_EQ(refusal("G43.4 H1\nG0 X1 Y1 Z1\n" + std::string(code) + "\n"),
              "p.ngc:3:1: " + std::string(code) +
                  ": a reference position while tool centre control is on; expected G49 before it");
  }
  EXPECT_EQ(refusal("G4\n"), "p.ngc:1:1: G4: the time of the dwell is missing; expected P in s");
  EXPECT_EQ(refusal("G4 P-1\n"), "p.ngc:1:4: P-1: the time of the dwell is negative");
  EXPECT_EQ(refusal("G91 G53 G0 X1\n"), "p.ngc:1:5: G53: G53 in incremental distances; expected G90");
}

TEST(NcErrors, OfWordsThatBelongToOtherCodesOrAreMissing) {
  const std::string unused = ": no code of this block uses it; expected ";
  for (const auto& [text, word] : std::vector<std::pair<std::string, std::string>>{{"M62 P1 Q1", "8: Q1"},
                                                                                   {"M3 Q1", "4: Q1"},
                                                                                   {"M6 Q1", "4: Q1"},
                                                                                   {"M48 P1", "5: P1"},
                                                                                   {"M3 P1", "4: P1"},
                                                                                   {"M67 E1 P1", "8: P1"},
                                                                                   {"M62 P1 E1", "8: E1"},
                                                                                   {"M100 E1", "6: E1"},
                                                                                   {"M100 L1", "6: L1"},
                                                                                   {"M63 P1 L1", "8: L1"},
                                                                                   {"G43.1 Z1 H1", "10: H1"},
                                                                                   {"G49 H1", "5: H1"},
                                                                                   {"G10 L2 P1 X1 I1", "14: I1"},
                                                                                   {"G80 Q2 M1", "5: Q2"}}) {
    EXPECT_TRUE(refusal(text + "\n").starts_with("p.ngc:1:" + word + unused)) << refusal(text + "\n");
  }
  // Of codes in force that do nothing in this block.
  EXPECT_TRUE(refusal("F9\nG83 X1 Y1 Z-1 R1 Q1\nF5 R1\n").starts_with("p.ngc:3:4: R1" + unused));
  EXPECT_TRUE(refusal("F9\nG2 X3 I1.5\nG43.1 X1 K1\n").starts_with("p.ngc:3:10: K1" + unused));
  EXPECT_EQ(refusal("M62\n"), "p.ngc:1:1: M62: a word of this code is missing; expected P, the number of the output");
  EXPECT_EQ(refusal("M67 Q1\n"),
            "p.ngc:1:1: M67: a word of this code is missing; expected E, the number of the output");
  EXPECT_EQ(refusal("M68 E-1 Q1\n"), "p.ngc:1:5: E-1: is not the number of an output");
  EXPECT_EQ(refusal("M66\n"), "p.ngc:1:1: M66: it is not said which input is waited for; expected P or E");
  EXPECT_EQ(refusal("M61\n"), "p.ngc:1:1: M61: a word of this code is missing; expected Q, the number of the tool");
  EXPECT_EQ(refusal("M61 Q-1\n"), "p.ngc:1:5: Q-1: is not the number of a tool");
  EXPECT_EQ(refusal("G96\n"), "p.ngc:1:1: G96: a word of this code is missing; expected S, the cutting speed");
  EXPECT_EQ(refusal("G43.2\n"), "p.ngc:1:1: G43.2: the offset that is added is not said; expected H, or axis words");
  EXPECT_EQ(refusal("G0 X1\nG43.2 H1 X1\n"),
            "p.ngc:2:1: G43.2: the offset that is added is not said; expected H, or axis words");
  EXPECT_EQ(refusal("G10 L1 P7 Z1\n"), "p.ngc:1:8: P7: the tool table has no tool 7");
  EXPECT_EQ(refusal("G33 Z1 K1\n"), "p.ngc:1:1: G33: G33 and the spindle does not turn; expected M3 or M4 before it");
  EXPECT_EQ(refusal("G95 F.1\nG1 X1\n"),
            "p.ngc:2:1: G1: G1 with a feed per revolution and without a speed of the spindle; expected S before or in "
            "this block");
  EXPECT_EQ(refusal("F9\nG81 M19 R90 X1 Z-1\n"),
            "p.ngc:2:9: R90: two codes of this block use it; expected a block of its own for one of them");
  EXPECT_EQ(refusal("#1=3 M98 P100\nM2\nO100\nM99\n"),
            "p.ngc:1:6: M98: a parameter is set beside M98 or M99; expected a block of its own before it");
  EXPECT_TRUE(refusal("G93\nG1 X1 F2\nG0 X#<_feed>\n").starts_with("p.ngc:3:5: #<_feed>: this parameter has no value"));
}

TEST(NcErrors, OfParametersAndExpressions) {
  EXPECT_EQ(refusal("G0 X#77\n"),
            "p.ngc:1:5: #77: this parameter has no value here; expected a parameter that the program or the parameter "
            "file has set");
  EXPECT_EQ(refusal("G0 X#<tall>\n"),
            "p.ngc:1:5: #<tall>: this parameter has no value here; expected a parameter that the program has set, or "
            "one of the position, units or feed (#<_x>, #<_feed>)");
  EXPECT_EQ(refusal("G0 X#5061\n"),
            "p.ngc:1:5: #5061: only the control knows this parameter (probing, inputs); expected a program whose moves "
            "do not depend on what the control measures");
  EXPECT_EQ(refusal("G0 X#0\n"), "p.ngc:1:6: 0: there is no parameter of this number; expected 1 to 5601");
  EXPECT_EQ(refusal("G0 X#5602\n"), "p.ngc:1:6: 5602: there is no parameter of this number; expected 1 to 5601");
  EXPECT_EQ(refusal("G0 X#1.5\n"), "p.ngc:1:6: 1.5: the number of a parameter is not whole");
  EXPECT_EQ(refusal("#5221=3\n"),
            "p.ngc:1:1: #5221=3: this parameter belongs to the control; expected G10, G52, G92 or G28.1 for offsets; "
            "#1 to #5000 here");
  EXPECT_EQ(refusal("#5399=1\n"),
            "p.ngc:1:1: #5399=1: this parameter belongs to the control; expected G10, G52, G92 or G28.1 for offsets; "
            "#1 to #5000 here");
  EXPECT_EQ(refusal("#<_x>=1\n"), "p.ngc:1: #<_x>: this parameter belongs to the control");
  EXPECT_EQ(refusal("#5 3\n"),
            "p.ngc:1:1: #5 3: a parameter stands here without a letter; expected =, or a letter before it");
  EXPECT_EQ(refusal("G0 X[1\n"), "p.ngc:1:5: [1: the expression does not end with ]; expected an operator or ]");
  EXPECT_EQ(refusal("G0 X[1/0]\n"), "p.ngc:1:6: 1/0]: division by zero");
  EXPECT_EQ(refusal("G0 X[1 MOD 0]\n"), "p.ngc:1:6: 1 MOD 0]: division by zero");
  EXPECT_EQ(refusal("G0 X[[0-2] ** .5]\n"), "p.ngc:1:6: [0-2] ** .5]: a negative number to a power that is not whole");
  EXPECT_EQ(refusal("G0 Xsqrt[-1]\n"), "p.ngc:1:5: sqrt[-1]: the argument -1 is negative");
  EXPECT_EQ(refusal("G0 Xacos[2]\n"), "p.ngc:1:5: acos[2]: the argument 2 is outside -1 to 1");
  EXPECT_EQ(refusal("G0 Xln[0]\n"), "p.ngc:1:5: ln[0]: the argument 0 is not positive");
  EXPECT_EQ(refusal("G0 Xatan[1]\n"), "p.ngc:1:5: atan[1]: ATAN takes two values; expected ATAN[y]/[x]");
  EXPECT_EQ(refusal("G0 Xfoo[1]\n"),
            "p.ngc:1:5: foo[1]: there is no such function; expected ABS ACOS ASIN ATAN COS EXISTS EXP FIX FUP LN ROUND "
            "SIN SQRT TAN");
  EXPECT_EQ(refusal("G0 Xexists[5]\n"), "p.ngc:1:5: exists[5]: EXISTS takes a parameter; expected EXISTS[#<name>]");
  EXPECT_EQ(refusal("G0 X[9**99]\n"), "p.ngc:1:6: 9**99]: has no finite value, or one beyond 1e15");
}

TEST(NcErrors, OfArcs) {
  EXPECT_EQ(refusal("G28 X1 G1\n"), "p.ngc:1:8: G1: two codes of this block use the axis words");
  EXPECT_EQ(refusal("G28\n"),
            "p.ngc:1:1: G28: the reference position is not known; expected parameters 5161 (G28) or 5181 (G30) and the "
            "following");
  EXPECT_EQ(refusal("G53 G2 X1 I1 F1\n"), "p.ngc:1:1: G53: G53 is not followed by a straight move; expected G0 or G1");
  EXPECT_EQ(refusal("G2 X5 F1\n"), "p.ngc:1:1: G2: an arc without a centre or a radius; expected I J K, or R");
  EXPECT_EQ(refusal("G2 X5 I1 K1 F1\n"),
            "p.ngc:1:10: K1: is not a centre in this plane; expected a letter of the plane");
  EXPECT_EQ(refusal("G18 G2 X5 J1 F1\n"),
            "p.ngc:1:11: J1: is not a centre in this plane; expected a letter of the plane");
  EXPECT_EQ(refusal("G2 X5 I1 R2 F1\n"), "p.ngc:1:10: R2: a radius beside a centre");
  EXPECT_EQ(refusal("G2 X1 I5 F1\n"),
            "p.ngc:1:1: G2: the end of the arc is 4.0000 mm from its centre, the start 5.0000 mm; expected a centre as "
            "far from both");
  EXPECT_EQ(refusal("G2 X5 F1 R1\n"),
            "p.ngc:1:10: R1: the radius is too small to reach the end, which is 5.0000 mm away; expected at least half "
            "of that");
  EXPECT_EQ(refusal("G2 R5 F1\n"),
            "p.ngc:1:1: G2: an arc by its radius without an end in its plane; expected the end point");
  EXPECT_EQ(
      refusal("G2 X0 R5 F1\n"),
      "p.ngc:1:7: R5: the arc ends where it begins, so its radius does not determine it; expected a centre by I J K");
  EXPECT_EQ(refusal("G2 X1 Y0 F1 I0 J0\n"),
            "p.ngc:1:1: G2: an arc of radius zero; expected a centre away from start and end");
  EXPECT_EQ(refusal("G2 I1 P1.5 F1\n"),
            "p.ngc:1:7: P1.5: is not a number of turns; expected a whole number from 1 to 1,000,000");
  EXPECT_EQ(refusal("G90.1 G2 X1 I1 F1\n"),
            "p.ngc:1:1: G90.1: an arc with half a centre; expected both coordinates of the centre with G90.1");
  EXPECT_EQ(refusal("G2 X5 I2.5\n"), "p.ngc:1:1: G2: G2 without a feed; expected F before or in this block");
  EXPECT_EQ(refusal("G64 P1 G2 X1 I.5 F1\n"),
            "p.ngc:1:5: P1: two codes of this block use it; expected a block of its own for one of them");
}

TEST(NcErrors, OfCycles) {
  EXPECT_EQ(refusal("X1\n"),
            "p.ngc:1:1: X1: axis words without a code that uses them; expected G0, G1, G2, G3 or a canned cycle");
  EXPECT_EQ(refusal("G80 X1\n"),
            "p.ngc:1:5: X1: axis words without a code that uses them; expected G0, G1, G2, G3 or a canned cycle");
  EXPECT_EQ(refusal("G0 R1 X1\n"), "p.ngc:1:4: R1: no code of this block uses it; expected G2, G3 or a canned cycle");
  EXPECT_EQ(refusal("G0 P1 X1\n"),
            "p.ngc:1:4: P1: no code of this block uses it; expected G2, G3, G4, G10, G64, a canned cycle, M50-M68, M98 "
            "or M100-M199");
  EXPECT_EQ(refusal("G0 L1 X1\n"),
            "p.ngc:1:4: L1: no code of this block uses it; expected G10, a canned cycle, M66 or M98");
  EXPECT_EQ(refusal("G43.4 H1\nG0 X1 Y1 Z1\nG81 X1 Z0 R1 F1\n"),
            "p.ngc:3:1: G81: a canned cycle while tool centre control is on; expected G49 before it");
  EXPECT_EQ(refusal("G53 X1\n"),
            "p.ngc:1:5: X1: axis words without a code that uses them; expected G0, G1, G2, G3 or a canned cycle");
  EXPECT_EQ(refusal("G81 X1 Z-1 R1\n"),
            "p.ngc:1:1: G81: a canned cycle without a feed; expected F before or in this block");
  EXPECT_EQ(refusal("F1\nG81 X1 Z-1\n"), "p.ngc:2:1: G81: R is missing in this cycle");
  EXPECT_EQ(refusal("F1\nG81 X1 R1\n"), "p.ngc:2:1: G81: Z is missing in this cycle");
  EXPECT_EQ(refusal("F1\nG81 X1 Z2 R1\n"), "p.ngc:2:1: G81: R is below the bottom of the hole; expected R above it");
  EXPECT_EQ(refusal("F1\nG81 X1 Z-1 R1 A1\n"), "p.ngc:2:1: G81: a canned cycle with words other than X, Y, Z");
  EXPECT_EQ(refusal("F1\nG81 Z-1 R1 X1 L0\n"),
            "p.ngc:2:15: L0: is not a number of repeats; expected a whole number from 1 to 1000000");
  EXPECT_EQ(refusal("F1\nG82 Z-1 R1 X1\n"), "p.ngc:2:1: G82: P is missing in this cycle");
  EXPECT_EQ(refusal("F1\nG83 Z-1 R1 X1\n"), "p.ngc:2:1: G83: Q is missing in this cycle");
  EXPECT_EQ(refusal("F1\nG83 Z-1 R1 X1 Q-1\n"), "p.ngc:2:1: G83: the step Q is not positive");
  EXPECT_EQ(refusal("F1\nG86 Z-1 R1 X1 P1\n"),
            "p.ngc:2:1: G86: the spindle does not turn, which this cycle stops; expected M3 or M4");
  EXPECT_EQ(refusal("G93 F1\nG81 X1 Z-1 R1\n"), "p.ngc:2:1: G81: a canned cycle with inverse time; expected G94");
  EXPECT_EQ(refusal("F1\nG83 Z-1 R1 X1 Q.000001\n"),
            "p.ngc:2:1: G83: the hole takes more than 100000 pecks; expected a larger Q");
  EXPECT_EQ(refusal("F1\nG82 Z-1 R1 X1 P1 G64\n"),
            "p.ngc:2:15: P1: two codes of this block use it; expected a block of its own for one of them");
}

TEST(NcErrors, OfSubroutinesAndLoops) {
  EXPECT_EQ(refusal("O5 foo\n"),
            "p.ngc:1:4: foo: is not what an O word can say; expected sub, endsub, call, return, if, elseif, else, "
            "endif, while, endwhile, do, repeat, endrepeat, break or continue");
  EXPECT_EQ(refusal("O1 call\n"),
            "p.ngc:1:1: O1 call: there is no subroutine of this name in the file; expected a subroutine in the same "
            "file: those of other files are not read");
  EXPECT_EQ(refusal("O1 call [1] G0\n"),
            "p.ngc:1:1: O1 call [1]: there is no subroutine of this name in the file; expected a subroutine in the "
            "same file: those of other files are not read");
  EXPECT_EQ(refusal("O1 if [1]\nO1 sub\n"),
            "p.ngc:2:1: O1 sub: what ends it is missing; expected its end with the same name");
  EXPECT_EQ(
      refusal("O1 endsub\n"),
      "p.ngc:1:1: O1 endsub: nothing that begins this stands before it; expected the beginning with the same name");
  EXPECT_EQ(
      refusal("O1 endwhile\n"),
      "p.ngc:1:1: O1 endwhile: nothing that begins this stands before it; expected the beginning with the same name");
  EXPECT_EQ(refusal("O1 if [0]\n"), "p.ngc:1:1: O1 if [0]: what ends it is missing; expected endif with the same name");
  EXPECT_EQ(refusal("O1 else\n"),
            "p.ngc:1:1: O1 else: nothing that begins this stands before it; expected the beginning with the same name");
  EXPECT_EQ(refusal("O1 break\n"), "p.ngc:1:1: O1 break: no loop of this name stands around it");
  EXPECT_EQ(refusal("O1 return [1]\nO1 sub\nO1 endsub\n"),
            "p.ngc:1:1: O1 return [1]: ends a subroutine that was not called");
  EXPECT_EQ(refusal("O1 sub\nG0 X1\n"),
            "p.ngc:1:1: O1 sub: what ends it is missing; expected its end with the same name");
  EXPECT_EQ(refusal("O1 sub\nO1 endsub\nO1 sub\nO1 endsub\n"),
            "p.ngc:3:1: O1 sub: a subroutine of this name exists already");
  EXPECT_EQ(refusal("O1 while\nO1 endwhile\n"), "p.ngc:1:9: a value is missing; expected a value in [ ]");
  EXPECT_EQ(refusal("O1 while [1]\nO1 endwhile\n"),
            "p.ngc:2:1: O1 endwhile: 1000 rounds of loops or calls without a move; expected a loop that moves or ends");
  EXPECT_EQ(refusal("O1 while [1]\nG0 X1\nG0 X0\nO1 endwhile\n"),
            "p.ngc:2: more than 1000 moves: a loop that does not end?");
  EXPECT_EQ(refusal("O1 sub\nO1 call\nO1 endsub\nO1 call\n"), "p.ngc:2:1: O1 call: more than 10 calls within calls");
  EXPECT_EQ(refusal("M98\n"), "p.ngc:1:1: M98: the number of the subprogram is missing; expected P");
  EXPECT_EQ(refusal("M98 P5\n"),
            "p.ngc:1:1: M98: there is no subprogram O5 in the file; expected a subprogram in the same file: those of "
            "other files are not read");
  EXPECT_EQ(refusal("M98 P5 G0 X1\n"),
            "p.ngc:1:8: G0: is given together with M98 or M99, which have no other words; expected a block of its own "
            "before it");
  EXPECT_EQ(refusal("M99\n"),
            "p.ngc:1:1: M99: M99 outside a subprogram restarts the program endlessly; expected M2 or M30 at the end");
}

TEST(NcErrors, OfProgramsForOtherControls) {
  const std::vector<std::pair<std::string, std::string>> errors = {
      // FANUC
      {"G5.1 Q1", "p.ngc:2:1: G5.1: splines are not handled, nor is smoothing by the control"},
      {"G65 P9010 A1.", "p.ngc:2:1: G65: macro calls"},
      {"G54.1 P3", "p.ngc:2:1: G54.1: further work offsets"},
      {"G50 S2000", "p.ngc:2:1: G50: scaling, mirroring"},
      {"G92 S2000", "p.ngc:2:1: G92: axis words are missing"},
      {"IF [#1 EQ 1] GOTO 10", "p.ngc:2:1: IF: is a statement of another language"},
      {"N5 GOTO 100", "p.ngc:2:4: GOTO: is a statement of another language"},
      {"WHILE [#1 LT 3] DO1", "p.ngc:2:1: WHILE: is a statement of another language"},
      {"DO1", "p.ngc:2:1: DO1: is a statement of another language"},
      {"G54 M98 P100\nM2\nO100\nM99", "p.ngc:2:1: G54: is given together with M98"},
      {"M98 P100 F5\nM2\nO100\nM99", "p.ngc:2:10: F5: is given together with M98"},
      {"M98 P100\nM2\nO100\nM99 P10", "p.ngc:5:5: P10: no code of this block uses it"},
      {"M98 P51001", "p.ngc:2:1: M98: there is no subprogram O51001"},
      {"M30 P1", "p.ngc:2:5: P1: no code of this block uses it"},
      {"M30 L1", "p.ngc:2:5: L1: no code of this block uses it"},
      {"G30 P2 Z0", "p.ngc:2:5: P2: no code of this block uses it"},
      {"G4 X1.", "p.ngc:2:4: X1.: axis words without a code"},
      {"F9\nG81 X1 Z-1 R1 K3", "p.ngc:3:15: K3: no code of this block uses it"},
      {"F9\nG81 X1 Z-1 R1 P3", "p.ngc:3:15: P3: no code of this block uses it"},
      {"F9\nG83 X1 Z-1 R1 Q1 P3", "p.ngc:3:18: P3: no code of this block uses it"},
      {"F9\nG81 X1 Z-1 R1 Q3", "p.ngc:3:15: Q3: no code of this block uses it"},
      {"G10 L2 P1.5 X1", "p.ngc:2:8: P1.5: is not a whole number"},
      {"G10 L20 P48 X0", "p.ngc:2:9: P48: is not a work offset"},
      {"G0 X1 D5", "p.ngc:2:7: D5: no code of this block uses it"},
      {"/2 G0 X1", "p.ngc:2:2: 2: is not a word"},
      {"G1 X1 ,R2 F1", "p.ngc:2:7: ,R2: is not a word"},
      {":1000", "p.ngc:2:1: :1000: is not a word"},
      // Haas
      {"G187 P1 E.01", "p.ngc:2:1: G187: is not a G code"},
      {"G234 H1", "p.ngc:2:1: G234: tool centre control is not asked for so here; expected G43.4"},
      {"G254", "p.ngc:2:1: G254: work offsets that turn with the workpiece"},
      {"M97 P100", "p.ngc:2:1: M97: is not an M code that is handled"},
      // Siemens, Heidenhain
      {"TRAORI(1)", "p.ngc:2:1: TRAORI(1): is a statement of another language"},
      {"CYCLE800(1)", "p.ngc:2:1: CYCLE800(1): is a statement of another language"},
      {"R1=5", "p.ngc:2:3: =5: is not a word"},
      {"G1 X=R1 F5", "p.ngc:2:5: =R1: is not a value"},
      {"G54 D1", "p.ngc:2:5: D1: no code of this block uses it"},
      {"G290", "p.ngc:2:1: G290: is not a G code"},
      {"BEGIN PGM PLATE MM", "p.ngc:2:1: BEGIN: is a statement of another language"},
  };
  for (const auto& [text, message] : errors) {
    EXPECT_EQ(refusal("G21\n" + text + "\n").substr(0, message.size()), message);
  }
}

TEST(NcErrors, OfTextsThatAreNoPrograms) {
  EXPECT_EQ(refusal(std::string("G0 X1\0X2\n", 10)).substr(0, 31), "p.ngc:1:6: ?X2: is not a word; ");
  EXPECT_EQ(refusal(std::string("G0 X[1\0+2]\n", 12)).substr(0, 50),
            "p.ngc:1:5: [1?+2]: the expression does not end wit");
  EXPECT_EQ(refusal(std::string(100, '\0')).substr(0, 11), "p.ngc:1:1: ");
  EXPECT_EQ(refusal("\xFF\xFEG\0").substr(0, 27), "p.ngc:1:1: ??G: is not a wo");
  EXPECT_EQ(refusal("G0 X" + std::string(400, '1') + "\n").substr(0, 60),
            "p.ngc:1:5: 11111111111111111111111111111111: is not a number");
  EXPECT_EQ(refusal("G0 X" + std::string(10'000'000, '-') + "1\n").substr(46), "the expression is nested too deeply");
}

TEST(NcErrors, OfALoopThatReachesNoNewLine) {
  NcProgramOptions options = options_at_zero();
  options.most_repeated_moves = 100;
  const auto run = [&](const std::string& text) { return message_of([&] { run_program(text, options); }); };
  EXPECT_EQ(run("O1 while [1]\nG0 X1\nX0\nO1 endwhile\n"),
            "p.ngc:2: 100 moves in a loop that reaches no new line of the program; expected a loop that ends");
  // A subroutine in front of its calls, one behind them, and one that calls another.
  std::string calls;
  for (int i = 0; i < 200; ++i) calls += "O1 call\nM98 P2\n";
  const std::string subroutines = "O1 sub\nG0 X1\nM98 P2\nG0 X2\nO1 endsub\n" + calls + "M2\nO2\nG0 Y1\nY2\nM99\n";
  EXPECT_EQ(run_program(subroutines, options).moves.size(), 200U * (4 + 2));
}

TEST(NcErrors, OfAProgramWithoutAToolTable) {
  NcProgramOptions options = options_at_zero();
  options.tools.reset();
  EXPECT_EQ(message_of([&] { run_program("G21\nG43 H1\n", options); }),
            "p.ngc:2:1: G43: there is no tool table; expected a tool table, or the length in the program by G43.1");
}

TEST(NcErrors, OfPositionsThatAreNotKnown) {
  const NcProgramOptions options;
  EXPECT_EQ(message_of([&] { run_program("G21\nG0 X1\nN5 G1 X2 F1\n", options); }),
            "p.ngc:3:1: N5: where Y, Z, A, B, C stand is not known here, and a move at work begins there; expected a "
            "G0 before it "
            "that names these axes, or where they stand when the program begins (--start X_mm=0)");
  EXPECT_EQ(message_of([&] { run_program("G91 G0 X1\n", options); }),
            "p.ngc:1:1: G91: where X stands is not known here, and G91 counts from there; expected a G0 before it that "
            "names these axes, or where they stand when the program begins (--start X_mm=0)");
  EXPECT_EQ(
      message_of([&] { run_program("G92 X0\n", options); }),
      "p.ngc:1:1: G92: where X stands is not known here, and G92 takes it; expected a G0 before it that names these "
      "axes, or where they stand when the program begins (--start X_mm=0)");
}

TEST(NcErrors, OfParametersThatAreGiven) {
  const auto refused = [](int number, double value) {
    return message_of([&] {
      NcProgramOptions options = options_at_zero();
      options.parameters[number] = value;
      run_program("M2\n", options);
    });
  };
  EXPECT_EQ(refused(5230, 3), "p.ngc: #5230: a work offset that is rotated is not handled; expected 0");
  EXPECT_EQ(refused(5220, 12), "p.ngc: #5220: is not a work offset; expected 1 (G54) to 9 (G59.3)");
  EXPECT_EQ(refused(0, 1),
            "p.ngc: #0: is not a parameter that can be set; expected a number from 1 to 5601 and a value up to 1e9");
}

TEST(NcErrors, OfACorrectionThatIsNoNumber) {
  class Lost final : public MoveCorrector {
    void correct(std::span<const ProgramMove> moves, CorrectedPieces& corrected) override {
      corrected.pieces.assign(moves.size(), CorrectedPiece{});
      corrected.first.clear();
      for (std::size_t i = 0; i <= moves.size(); ++i) corrected.first.push_back(i);
      for (CorrectedPiece& piece : corrected.pieces) piece.end[1] = std::nan("");
    }
  };
  EXPECT_EQ(message_of([] {
              Lost lost;
              correct_nc_program("G0 X1\n", "p.ngc", options_at_zero(), lost, [](std::string_view) {});
            }),
            "p.ngc:1: the corrected position is not a number that can be written");
}

}  // namespace
}  // namespace abbe
