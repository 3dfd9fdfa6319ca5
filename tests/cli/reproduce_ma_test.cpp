#include <nlohmann/json.hpp>
#include <string>

#include "cli/command_test.h"

namespace abbe {
namespace {

class ReproduceMa : public CommandTest {};

TEST_F(ReproduceMa, JsonIsTheSummaryOfTheFolder) {
  const CommandResult result = abbe({"reproduce", "ma", "--json", "-o", "results"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out), nlohmann::json::parse(folder.read("results/summary.json")));
}

TEST_F(ReproduceMa, TextStatesTheGaugeAndWhatIsWrongInPrint) {
  const CommandResult result = abbe({"reproduce", "ma"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  for (const char* words : {"Wrong in print", "mean of EXC over the turn is zero", "axis average line",
                            "two mounts, turned by one face", "agrees with the reference"}) {
    EXPECT_NE(result.out.find(words), std::string::npos) << words;
  }
}

}  // namespace
}  // namespace abbe
