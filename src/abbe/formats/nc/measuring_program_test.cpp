#include "abbe/formats/nc/measuring_program.h"

#include <gmock/gmock.h>

#include <array>
#include <string>
#include <vector>

#include "abbe/formats/nc/nc_correctors_for_test.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

using testing::HasSubstr;

Machine small_mill() { return parse_chain("w C' b X Z t").machine; }

std::vector<MeasuringSection> two_sections() {
  MeasuringStop first{{}, {90 * kDegree, 10.5, -20}, "reading 1, reflector (r1)"};
  MeasuringStop second{
      {{90 * kDegree, 10.5, 100}, {-45.1234567 * kDegree, 10.5, 100}}, {-45.1234567 * kDegree, 0, -20}, "reading 2"};
  MeasuringStop same{{}, second.pose, "reading 3"};
  return {{"set-up tracker", {first, second}}, {"set-up \xC3\xB6ne", {same}}};
}

MeasuringProgramOptions of_dialect(NcDialect dialect) {
  MeasuringProgramOptions options;
  options.dialect = dialect;
  options.name = "CHECK";
  options.dwell = 1.5;
  options.comments = {"3 readings"};
  return options;
}

std::string message_of_program(const Machine& machine, const MeasuringProgramOptions& options) {
  try {
    measuring_program(machine, two_sections(), options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(AMeasuringProgram, HasTheFormsOfIso) {
  EXPECT_EQ(measuring_program(small_mill(), two_sections(), of_dialect(NcDialect::iso)),
            "G21 G90 G94 G40 G49 G80\n"
            "(3 readings)\n"
            "(set-up tracker)\n"
            "M0\n"
            "(reading 1, reflector  r1 )\n"
            "G0 C90.000000 X10.500000 Z-20.000000\n"
            "G4 P1.5\n"
            "(reading 2)\n"
            "G0 Z100.000000\n"
            "G0 C-45.123457\n"
            "G0 X0.000000 Z-20.000000\n"
            "G4 P1.5\n"
            "(set-up ?ne)\n"
            "M0\n"
            "(reading 3)\n"
            "G4 P1.5\n"
            "M30\n");
}

TEST(AMeasuringProgram, HasTheFormsOfLinuxCnc) {
  MeasuringProgramOptions options = of_dialect(NcDialect::linuxcnc);
  options.trigger = NcTrigger::output;
  options.number = 3;
  options.pulse = 0.25;
  options.reading = 4;
  options.machine_coordinates = true;
  options.feed = 50;
  options.decimals = 3;
  EXPECT_EQ(measuring_program(small_mill(), two_sections(), options),
            "G21 G90 G94 G40 G49 G80 G61\n"
            "(3 readings)\n"
            "(MSG, set-up tracker)\n"
            "M0\n"
            "(reading 1, reflector  r1 )\n"
            "G53 G1 C90.000 X10.500 Z-20.000 F3000\n"
            "G4 P1.5\nM64 P3\nG4 P0.25\nM65 P3\nG4 P4\n"
            "(reading 2)\n"
            "G53 G1 Z100.000 F3000\n"
            "G53 G1 C-45.123 F3000\n"
            "G53 G1 X0.000 Z-20.000 F3000\n"
            "G4 P1.5\nM64 P3\nG4 P0.25\nM65 P3\nG4 P4\n"
            "(MSG, set-up ?ne)\n"
            "M0\n"
            "(reading 3)\n"
            "G4 P1.5\nM64 P3\nG4 P0.25\nM65 P3\nG4 P4\n"
            "M30\n");
}

TEST(AMeasuringProgram, HasTheFormsOfHeidenhain) {
  MeasuringProgramOptions options = of_dialect(NcDialect::heidenhain);
  options.trigger = NcTrigger::m_function;
  options.number = 123;
  options.machine_coordinates = true;
  EXPECT_EQ(measuring_program(small_mill(), two_sections(), options),
            "0 BEGIN PGM CHECK MM\n"
            "1 ; 3 readings\n"
            "2 ; set-up tracker\n"
            "3 STOP\n"
            "4 ; reading 1, reflector  r1 \n"
            "5 L C+90.0000 X+10.5000 Z-20.0000 R0 FMAX M91\n"
            "6 CYCL DEF 9.0 DWELL TIME\n"
            "7 CYCL DEF 9.1 DWELL 1.5\n"
            "8 M123\n"
            "9 ; reading 2\n"
            "10 L Z+100.0000 R0 FMAX M91\n"
            "11 L C-45.1235 R0 FMAX M91\n"
            "12 L X+0.0000 Z-20.0000 R0 FMAX M91\n"
            "13 CYCL DEF 9.0 DWELL TIME\n"
            "14 CYCL DEF 9.1 DWELL 1.5\n"
            "15 M123\n"
            "16 ; set-up ?ne\n"
            "17 STOP\n"
            "18 ; reading 3\n"
            "19 CYCL DEF 9.0 DWELL TIME\n"
            "20 CYCL DEF 9.1 DWELL 1.5\n"
            "21 M123\n"
            "22 M30\n"
            "23 END PGM CHECK MM\n");
}

TEST(AMeasuringProgram, HasTheFormsOfSiemens) {
  MeasuringProgramOptions options = of_dialect(NcDialect::siemens);
  options.trigger = NcTrigger::output;
  options.number = 7;
  options.words = {{"C", "C1="}};
  EXPECT_EQ(measuring_program(small_mill(), two_sections(), options),
            "G710 G90 G94 G40 G60 RTLION\n"
            "; 3 readings\n"
            "MSG(\"set-up tracker\")\n"
            "M0\n"
            "MSG()\n"
            "; reading 1, reflector  r1 \n"
            "G0 C1=90.0000 X10.5000 Z-20.0000\n"
            "G4 F1.5\nSTOPRE\n$A_OUT[7]=1\nG4 F0.1\nSTOPRE\n$A_OUT[7]=0\n"
            "; reading 2\n"
            "G0 Z100.0000\n"
            "G0 C1=-45.1235\n"
            "G0 X0.0000 Z-20.0000\n"
            "G4 F1.5\nSTOPRE\n$A_OUT[7]=1\nG4 F0.1\nSTOPRE\n$A_OUT[7]=0\n"
            "MSG(\"set-up ?ne\")\n"
            "M0\n"
            "MSG()\n"
            "; reading 3\n"
            "G4 F1.5\nSTOPRE\n$A_OUT[7]=1\nG4 F0.1\nSTOPRE\n$A_OUT[7]=0\n"
            "M30\n");
}

TEST(AMeasuringProgram, HasTheFormsOfFanuc) {
  MeasuringProgramOptions options = of_dialect(NcDialect::fanuc);
  options.trigger = NcTrigger::output;
  options.number = 1100;
  EXPECT_EQ(measuring_program(small_mill(), two_sections(), options),
            "%\n"
            "O0001 (CHECK)\n"
            "G21 G90 G94 G40 G49 G80\n"
            "(3 READINGS)\n"
            "(SET-UP TRACKER)\n"
            "M0\n"
            "(READING 1, REFLECTOR  R1 )\n"
            "G0 C90.000 X10.500 Z-20.000\n"
            "G4 P1500\nG53\n#1100=1\nG4 P100\nG53\n#1100=0\n"
            "(READING 2)\n"
            "G0 Z100.000\n"
            "G0 C-45.123\n"
            "G0 X0.000 Z-20.000\n"
            "G4 P1500\nG53\n#1100=1\nG4 P100\nG53\n#1100=0\n"
            "(SET-UP ?NE)\n"
            "M0\n"
            "(READING 3)\n"
            "G4 P1500\nG53\n#1100=1\nG4 P100\nG53\n#1100=0\n"
            "M30\n"
            "%\n");
}

/// Poses at which the moves of a program end, X Z C in mm and rad, as the library's interpreter finds them.
std::vector<std::array<double, 3>> reached(const std::string& program) {
  std::vector<std::array<double, 3>> ends;
  for (const ProgramMove& move : run_program(program).moves) ends.push_back({move.end[0], move.end[2], move.end[5]});
  return ends;
}

TEST(AMeasuringProgram, ReachesEveryPoseExactly) {
  for (const NcDialect dialect : {NcDialect::iso, NcDialect::linuxcnc}) {
    for (const bool at_feed : {false, true}) {
      for (const bool machine_coordinates : {false, true}) {
        MeasuringProgramOptions options = of_dialect(dialect);
        options.feed = at_feed ? 20 : 0;
        options.machine_coordinates = machine_coordinates;
        options.trigger = dialect == NcDialect::linuxcnc ? NcTrigger::output : NcTrigger::m_function;
        options.number = dialect == NcDialect::linuxcnc ? 0 : 150;
        std::vector<MeasuringSection> sections = two_sections();
        const Machine machine = small_mill();
        std::vector<std::vector<double>> wanted;
        for (MeasuringSection& section : sections) {
          for (MeasuringStop& stop : section.stops) {
            for (std::vector<double>& pose : stop.via) wanted.push_back(pose = stated_pose(machine, pose, 6));
            stop.pose = stated_pose(machine, stop.pose, 6);
            if (wanted.empty() || wanted.back() != stop.pose) wanted.push_back(stop.pose);
          }
        }
        const auto found = reached(measuring_program(machine, sections, options));
        ASSERT_EQ(found.size(), wanted.size());
        for (std::size_t k = 0; k < found.size(); ++k) {
          EXPECT_NEAR(found[k][0], wanted[k][1], 1e-12);
          EXPECT_NEAR(found[k][1], wanted[k][2], 1e-12);
          EXPECT_NEAR(found[k][2], wanted[k][0], 1e-14);
        }
      }
    }
  }
}

TEST(AMeasuringProgram, OfFanucReachesThemWithItsDigits) {
  MeasuringProgramOptions options = of_dialect(NcDialect::fanuc);
  std::string program = measuring_program(small_mill(), two_sections(), options);
  // The interpreter is one of RS274/NGC: an O number means something else to it.
  const std::size_t number = program.find("O0001");
  program.erase(number, program.find('\n', number) - number);
  const auto found = reached(program);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_NEAR(found[0][0], 10.5, 1e-12);
  EXPECT_NEAR(found[2][2], -45.123 * kDegree, 1e-14);
  EXPECT_NEAR(found[3][1], -20, 1e-12);
}

TEST(AMeasuringProgram, RefusesWhatItsControlDoesNotHave) {
  MeasuringProgramOptions options = of_dialect(NcDialect::heidenhain);
  options.trigger = NcTrigger::output;
  EXPECT_THAT(message_of_program(small_mill(), options), HasSubstr("--trigger output"));
  options.dialect = NcDialect::linuxcnc;
  options.number = 64;
  EXPECT_THAT(message_of_program(small_mill(), options), HasSubstr("motion.digital-out"));
  options.dialect = NcDialect::siemens;
  options.number = 0;
  EXPECT_THAT(message_of_program(small_mill(), options), HasSubstr("$A_OUT"));
  options.dialect = NcDialect::fanuc;
  EXPECT_THAT(message_of_program(small_mill(), options), HasSubstr("1100 to 1131"));
  options.trigger = NcTrigger::m_function;
  options.number = 30;
  EXPECT_THAT(message_of_program(small_mill(), options), HasSubstr("M30 stops or ends programs"));
  options.number.reset();
  EXPECT_THAT(message_of_program(small_mill(), options),
              HasSubstr("--trigger-number: missing; expected the number of"));
  options.trigger = NcTrigger::dwell;
  options.number = 5;
  EXPECT_THAT(message_of_program(small_mill(), options),
              HasSubstr("--trigger-number: has no effect without a trigger"));
  options.number.reset();
  options.feed = 0.0004 / 60;
  EXPECT_THAT(message_of_program(small_mill(), options), HasSubstr("--feed-mm-per-min: is 0 with the three decimals"));
  options.machine_coordinates = true;
  options.feed = 10;
  EXPECT_THAT(message_of_program(small_mill(), options), HasSubstr("--feed-mm-per-min"));
  options = of_dialect(NcDialect::iso);
  const Machine numbered = parse_chain("w C1' b X C2 t").machine;
  EXPECT_THAT(message_of_program(numbered, options), HasSubstr("such as --word C1=C"));
}

TEST(AMeasuringProgram, IsNamedForItsFile) {
  EXPECT_EQ(nc_program_name("out/trunnion-mill 2.ngc"), "TRUNNION_MILL_2");
  EXPECT_EQ(nc_program_name(""), "MEASURE");
  EXPECT_EQ(nc_program_name("abcdefghijklmnopqrstuvwxyzabcd.h"), "ABCDEFGHIJKLMNOPQRSTUVWX");
}

TEST(AStatedPose, IsRoundedAndStaysWithinTheTravel) {
  Machine machine = small_mill();
  machine.axes[1].travel_max = 100.00049;
  const std::vector<double> stated = stated_pose(machine, {0.1 * kDegree, 100.00049, 1.0004}, 4);
  EXPECT_NEAR(stated[0], 0.1 * kDegree, 1e-15);
  EXPECT_NEAR(stated[1], 100.0004, 1e-12);
  EXPECT_NEAR(stated[2], 1.0004, 1e-12);
}

}  // namespace
}  // namespace abbe
