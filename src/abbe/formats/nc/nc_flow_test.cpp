#include "abbe/formats/nc/nc_flow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>

#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

/// Runs a program that has nothing but O words, M98, M99, assignments and comments.
class FlowOfAProgram {
 public:
  explicit FlowOfAProgram(std::string text, const NcFlow::Limits& limits = {})
      : text_(std::move(text)), expression_(parameters_), flow_(text_, file_, parameters_, expression_, limits) {}

  /// The comments of the lines in the order in which they run, each one letter.
  std::string run(bool moves = false) {
    NcBlockReader reader(file_, expression_);
    NcBlock block;
    std::string order;
    std::string_view line;
    for (std::size_t number = 0; flow_.next_line(line, number);) {
      reader.read(line, number, block);
      for (const NcAssignment& assignment : block.assignments) parameters_.set(assignment.number, assignment.value);
      for (const std::string_view comment : block.comments) {
        order += comment[1];
        if (moves) most_moves = std::max(most_moves, flow_.moves());
      }
      if (block.flow != NcFlowWord::none) {
        flow_.run(block);
      } else if (block.has('m') && block.value('m') == 98) {
        flow_.call_subprogram(block, block.word('m'), block.value('p'), block.has('l') ? block.value('l') : 1);
      } else if (block.has('m') && block.value('m') == 99) {
        flow_.end_subprogram(block, block.word('m'));
      } else if (block.has('m')) {
        break;
      }
    }
    return order;
  }

  std::size_t most_moves = 0;

 private:
  std::string text_, file_ = "p.ngc";
  NcParameters parameters_;
  NcExpression expression_;
  NcFlow flow_;
};

TEST(NcFlow, LoopsWithinLoopsGoOnAndEndByTheirNames) {
  EXPECT_EQ(FlowOfAProgram("O1 repeat [2]\n(a)\nO2 repeat [3]\n(b)\nO2 endrepeat\nO1 endrepeat\n(c)\n").run(),
            "abbbabbbc");
  EXPECT_EQ(FlowOfAProgram("#1=0\nO1 while [#1 LT 4]\n#1=[#1+1]\nO2 if [#1 EQ 2]\nO1 continue\nO2 endif\n(a)\n"
                           "O3 if [#1 EQ 3]\nO1 break\nO3 endif\n(b)\nO1 endwhile\n(c)\n")
                .run(),
            "abac");
  EXPECT_EQ(FlowOfAProgram("#1=0\nO1 do\n(a)\n#1=[#1+1]\nO1 while [#1 LT 3]\n(b)\n").run(), "aaab");
  EXPECT_EQ(FlowOfAProgram("O1 repeat [0]\n(a)\nO1 endrepeat\n(b)\n").run(), "b");
}

TEST(NcFlow, OneBranchRuns) {
  for (const auto& [value, order] : {std::pair{"1", "ae"}, {"2", "be"}, {"3", "ce"}}) {
    EXPECT_EQ(FlowOfAProgram("#1=" + std::string(value) +
                             "\nO1 if [#1 EQ 1]\n(a)\nO1 elseif [#1 EQ 2]\n(b)\nO1 else\n(c)\nO1 endif\n(e)\n")
                  .run(),
              order);
  }
}

TEST(NcFlow, SubroutinesStandBeforeOrBehindTheirCalls) {
  EXPECT_EQ(
      FlowOfAProgram("O1 sub\n(a)\nO2 call\nO1 endsub\nO1 call\nO2 sub\n(b)\nO2 return\n(c)\nO2 endsub\n(d)\n").run(),
      "abd");
  EXPECT_EQ(FlowOfAProgram("M98 P7 L2\n(a)\nM2\nO7\n(b)\nM99\n").run(), "bba");
  // What a loop of the caller has left to do is not touched.
  EXPECT_EQ(FlowOfAProgram("O1 sub\nO2 repeat [2]\n(a)\nO1 return\nO2 endrepeat\nO1 endsub\n"
                           "O2 repeat [2]\nO1 call\n(b)\nO2 endrepeat\n")
                .run(),
            "abab");
}

TEST(NcFlow, LoopsWithoutMovesAndCallsWithoutEndAreRefused) {
  NcFlow::Limits limits;
  limits.idle_jumps = 20;
  limits.depth = 3;
  EXPECT_EQ(message_of([&] { FlowOfAProgram("O1 while [1]\n(a)\nO1 endwhile\n", limits).run(); }),
            "p.ngc:3:1: O1 endwhile: 20 rounds of loops or calls without a move; expected a loop that moves or ends");
  EXPECT_EQ(message_of([&] { FlowOfAProgram("O1 sub\nO1 call\nO1 endsub\nO1 call\n", limits).run(); }),
            "p.ngc:2:1: O1 call: more than 3 calls within calls");
  // A move in it is enough.
  EXPECT_EQ(FlowOfAProgram("O1 repeat [50]\n(a)\nO1 endrepeat\n", limits).run(true), std::string(50, 'a'));
}

TEST(NcFlow, MovesAreCountedFromTheLastNewLine) {
  FlowOfAProgram program("(a)\nO1 repeat [5]\n(b)\nO1 endrepeat\n(c)\n(d)\n");
  EXPECT_EQ(program.run(true), "abbbbbcd");
  // The first round reaches new lines, the other four do not.
  EXPECT_EQ(program.most_moves, 4U);
}

}  // namespace
}  // namespace abbe
