#include "abbe/study/compensation/corrected_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <string>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/stopped.h"

namespace abbe {
namespace {

using testing::HasSubstr;

ProgramRequest trunnion_program() {
  const std::string examples = ABBE_SOURCE_DIR "/examples/";
  ProgramRequest request;
  request.machine = read_machine(examples + "machines/trunnion-mill.machine.toml");
  const ErrorsFile file = read_errors(examples + "compensate/trunnion.errors.toml", request.machine);
  request.errors = file.errors;
  request.covariance = file.covariance;
  request.program_file = "p.ngc";
  request.words = word_axes_by_name(request.machine);
  for (std::size_t word = 0; word < kAxisWords; ++word) {
    request.text.words[word] = request.words.axis[word] != Machine::npos;
  }
  return request;
}

std::string corrected(const ProgramRequest& request, const std::string& program, CorrectedProgram& result) {
  std::string text;
  std::size_t last = 0;
  result = correct_program(
      request, program, [&](std::string_view piece) { text += piece; },
      [&](std::size_t end) {
        EXPECT_GE(end, last);
        last = end;
      });
  return text;
}

const char* const kMoves = "G21 G90\nG0 X0 Y0 Z-100 A0 C0\nG1 X20 F600\nG1 Y20 A-10\nM2\n";

TEST(CorrectedProgramOfText, IsWrittenWithFiguresOfItsLargestCorrection) {
  const ProgramRequest request = trunnion_program();
  CorrectedProgram result;
  const std::string text = corrected(request, kMoves, result);
  EXPECT_TRUE(result.refused.empty()) << testing::PrintToString(result.refused);
  EXPECT_GT(result.report.moves, 0U);
  EXPECT_GT(result.report.largest_shift.value, 1e-4);
  EXPECT_THAT(text, HasSubstr("M2"));
  EXPECT_NE(text, kMoves);
  const ProgramWordsRequest words{.program = "p.ngc", .output = "out.ngc"};
  EXPECT_THAT(program_text(words, request.machine, result), HasSubstr("out.ngc written\n"));
  EXPECT_EQ(program_json(words, request.machine, result)["moves"], result.report.moves);
}

TEST(CorrectedProgramOfText, IsRefusedAboveTheLimitAndGivenUpBeyondIts) {
  ProgramRequest request = trunnion_program();
  CorrectedProgram result;
  request.limit_um = 0.01;
  corrected(request, kMoves, result);
  ASSERT_EQ(result.refused.size(), 1U);
  EXPECT_THAT(result.refused[0], HasSubstr("correction above the limit of 0.01 um"));
  request = trunnion_program();
  request.limits.megabytes = 1e-6;
  corrected(request, kMoves, result);
  ASSERT_EQ(result.refused.size(), 1U);
  EXPECT_THAT(result.refused[0], HasSubstr("--max-output-mb allows more"));
}

TEST(CorrectedProgramOfText, StopsWhileALineOfTheProgramIsStillAtWork) {
  const ProgramRequest request = trunnion_program();
  std::stop_source asked;
  std::size_t pieces = 0;
  const auto correct = [&](const std::string& program) {
    return correct_program(
        request, program,
        [&](std::string_view) {
          ++pieces;
          asked.request_stop();
        },
        [](std::size_t) {}, asked.get_token());
  };
  EXPECT_THROW(correct("G21 G90\nG0 X0 Y0 Z0 A0 C0\nG91 G81 X0.001 Z-5 R2 F600 L1000000\nM2\n"), Stopped);
  EXPECT_EQ(pieces, 1U);
  EXPECT_THROW(correct(kMoves), Stopped);  // it was asked before
  EXPECT_EQ(pieces, 1U);
}

TEST(CorrectedProgramOfText, NumbersOutOfRangeAreRefusedWithTheOptionThatSetsThem) {
  const auto problem = [](const auto& change) {
    ProgramRequest request = trunnion_program();
    request.errors_file = "e.toml";
    change(request);
    CorrectedProgram result;
    return message_of([&] { corrected(request, kMoves, result); });
  };
  EXPECT_EQ(problem([](ProgramRequest& r) { r.correction.tolerance.position = -2e-3; }),
            "--tolerance-um: -2 is not a finite number above zero; expected a length in um");
  EXPECT_EQ(problem([](ProgramRequest& r) { r.correction.rapid_tolerance = 0; }),
            "--rapid-tolerance-um: 0 is not a finite number above zero; expected a length in um");
  EXPECT_EQ(problem([](ProgramRequest& r) { r.correction.tolerance.orientation = std::nan(""); }),
            "--orientation-tolerance-urad: nan is not a finite number above zero; expected an angle in urad");
  EXPECT_EQ(problem([](ProgramRequest& r) { r.correction.inverse.largest_turn = -kDegree; }),
            "--largest-turn-deg: -1 is not a finite number above zero; expected an angle in deg");
  EXPECT_EQ(problem([](ProgramRequest& r) { r.correction.reversal_dead_band = -1e-3; }),
            "--reversal-dead-band-um: -1 is not a finite number above zero; expected a length in um");
  EXPECT_EQ(problem([](ProgramRequest& r) { r.limits.megabytes = 0; }),
            "--max-output-mb: 0 is not a finite number above zero; expected a size in MB");
  EXPECT_EQ(problem([](ProgramRequest& r) { r.limits.minutes = std::numeric_limits<double>::infinity(); }),
            "--max-minutes: inf is not a finite number above zero; expected a time in min");
  EXPECT_EQ(problem([](ProgramRequest& r) { r.limit_um = 0; }),
            "--limit-um: 0 is not a limit; expected a number above zero in um, or no limit at all");
  EXPECT_EQ(problem([](ProgramRequest& r) { r.leave_out_factor = 1001; }),
            "--leave-out-below-uncertainty: out of range; expected 0 to 1000 standard uncertainties");
}

}  // namespace
}  // namespace abbe
