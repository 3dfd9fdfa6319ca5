#include "abbe/formats/evaluations/trace_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "abbe/formats/text/message_of.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Traces : public testing::Test {
 protected:
  const Machine machine = test::trunnion_mill();

  TraceFile read(const std::string& text) const { return parse_trace(text, "trace.csv", machine); }
  std::string problem(const std::string& text) const {
    return message_of([&] { read(text); });
  }
};

TEST_F(Traces, HaveACommandOfEveryAxisForEverySample) {
  const TraceFile trace = read("# servo cycles\nX_mm,Y_mm,Z_mm,A_deg,C_deg\n1,2,-3,10,180\n4,5,-6,11,190\n");
  EXPECT_EQ(trace.commands.count(), 2U);
  EXPECT_THAT(trace.commands.axis[machine.find_axis("X")], ElementsAre(1, 4));
  EXPECT_THAT(trace.commands.axis[machine.find_axis("Z")], ElementsAre(-3, -6));
  EXPECT_NEAR(trace.commands.axis[machine.find_axis("C")][0], std::numbers::pi, 1e-15);
  EXPECT_THAT(trace.time_s, IsEmpty());
  EXPECT_THAT(trace.lines, ElementsAre(3, 4));
  EXPECT_TRUE(trace.commands.approach.empty());
}

TEST_F(Traces, StandInTheOrderOfTime) {
  const std::string header = "time_s,X_mm,Y_mm,Z_mm,A_deg,C_deg\n";
  EXPECT_THAT(read(header + "0.5,1,2,-3,0,0\n0.5,1,2,-3,0,0\n0.501,1,2,-3,0,0\n").time_s, ElementsAre(0.5, 0.5, 0.501));
  const std::string message = problem(header + "0.5,1,2,-3,0,0\n# pause\n0.499,1,2,-3,0,0\n");
  EXPECT_THAT(message, HasSubstr("trace.csv:4: time_s: 0.499 s follows 0.5 s"));
  EXPECT_THAT(message, HasSubstr("rows in chronological order"));
}

TEST_F(Traces, MayHaveTheOtherColumnsOfPlannedCommandsAndNoMore) {
  const TraceFile trace = read(
      "line,step,point,region,beam,feed_mm_per_min,length_mm,dwell_s,X_mm,Y_mm,Z_mm,A_deg,C_deg\n"
      "7,1,1,0,0,1200,0,0,1,2,-3,0,0\n8,2,1,0,1,1200,5,0.1,4,5,-6,0,0\n");
  EXPECT_THAT(trace.commands.axis[machine.find_axis("Y")], ElementsAre(2, 5));
  EXPECT_THAT(problem("note,X_mm,Y_mm,Z_mm,A_deg,C_deg\n1,1,2,-3,0,0\n1,1,2,-3,0,0\n"), HasSubstr("unknown column"));
}

TEST_F(Traces, MayLeaveTheTravelAsACorrectionDoes) {
  const TraceFile trace = read("X_mm,Y_mm,Z_mm,A_deg,C_deg\n1,2,0.02,10,180\n1,2,0.02,10,180\n");
  EXPECT_EQ(trace.commands.axis[machine.find_axis("Z")][1], 0.02);
}

TEST_F(Traces, AreTwoSamplesAtLeast) {
  const std::string header = "X_mm,Y_mm,Z_mm,A_deg,C_deg\n";
  EXPECT_THAT(problem(header), HasSubstr("there are no rows below the header"));
  EXPECT_THAT(problem(header + "1,2,-3,0,0\n"), HasSubstr("1 sample; expected two or more"));
  EXPECT_THAT(problem("X_mm,Y_mm,Z_mm,A_deg\n1,2,-3,0\n1,2,-3,0\n"), HasSubstr("C_deg"));
}

}  // namespace
}  // namespace abbe
