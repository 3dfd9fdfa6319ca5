#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

class HistoryCommandTest : public CommandTest {
 protected:
  static std::string example(const std::string& name) { return std::string(ABBE_SOURCE_DIR "/examples/") + name; }
  CommandResult add(const std::vector<std::string>& names, const std::vector<std::string>& dates) const {
    std::vector<std::string> arguments = {"history", "add", "mill.history"};
    for (const std::string& name : names) arguments.push_back(example("compare/" + name + ".errors.toml"));
    for (const std::string& date : dates) arguments.insert(arguments.end(), {"--date", date});
    arguments.insert(arguments.end(), {"--machine", example("machines/three-axis-mill.machine.toml")});
    return abbe(arguments);
  }
};

TEST_F(HistoryCommandTest, FollowsTheErrorsOfTheExample) {
  const CommandResult added = add({"october", "march", "june"}, {"2026-10-05", "2026-03-02", "2026-06-01"});
  ASSERT_EQ(added.exit_code, ExitCode::done) << added.err;
  const CommandResult listed = abbe({"history", "list", "mill.history", "--json"});
  const nlohmann::json list = nlohmann::json::parse(listed.out);
  ASSERT_EQ(list.size(), 3U);
  EXPECT_EQ(list[0]["name"], "march");
  EXPECT_EQ(list[0]["number"], 2);
  EXPECT_EQ(list[2]["day"], "2026-10-05");

  const CommandResult trends = abbe({"history", "trends", "mill.history", "--limit-um", "20", "-o", "out", "--json"});
  EXPECT_EQ(trends.exit_code, ExitCode::computation_says_no) << trends.err;
  const nlohmann::json json = nlohmann::json::parse(trends.out);
  EXPECT_EQ(json["kind"], "history");
  for (const nlohmann::json& error : json["errors"]) {
    // Nothing happened until June, and then something to EXX and EC0Y: examples/compare/README.md. A line through two
    // campaigns predicts EC0Y too uncertainly to tell.
    EXPECT_EQ(error["last_is_expected"].get<bool>(), error["name"] != "EXX") << error.dump();
    if (error["name"] == "EXX") {
      EXPECT_NEAR(error["change_um"][2].get<double>(), 7.6, 0.05);
    }
  }
  EXPECT_THAT(folder.read("out/report.html"), HasSubstr("Errors of a machine over its campaigns"));
  EXPECT_THAT(folder.read("out/trend-EXX.svg"), HasSubstr("years since 2026-03-02"));
  EXPECT_THAT(abbe({"history", "trends", "mill.history", "--limit-um", "20"}).out, HasSubstr("Measure again by 20"));
}

TEST_F(HistoryCommandTest, ExportsACampaignThatOtherCommandsRead) {
  ASSERT_EQ(add({"march", "october"}, {"2026-03-02", "2026-10-05"}).exit_code, ExitCode::done);
  const CommandResult exported = abbe({"history", "export", "mill.history", "--campaign", "1", "-o", "back"});
  ASSERT_EQ(exported.exit_code, ExitCode::done) << exported.err;
  const CommandResult compared = abbe({"compare", "back", example("compare/march.errors.toml"), "--json"});
  EXPECT_EQ(compared.exit_code, ExitCode::bad_input);  // an errors file has no machine
  const CommandResult same = abbe({"compare", "back", example("compare/march.errors.toml"), "--machine",
                                   example("machines/three-axis-mill.machine.toml"), "--json"});
  ASSERT_EQ(same.exit_code, ExitCode::done) << same.err;
  const nlohmann::json comparison = nlohmann::json::parse(same.out);
  const nlohmann::json& errors = comparison.at("pairs").at(0).at("errors");
  EXPECT_FALSE(errors.empty());
  for (const nlohmann::json& error : errors) {
    EXPECT_NE(error["verdict"], "changed") << error.dump();
  }
  const CommandResult missing = abbe({"history", "export", "mill.history", "--campaign", "9", "-o", "none"});
  EXPECT_EQ(missing.exit_code, ExitCode::bad_input);
  EXPECT_THAT(missing.err, HasSubstr("--campaign: there is no campaign 9 in mill.history"));
}

TEST_F(HistoryCommandTest, SaysWhatIsMissingOrWrong) {
  CommandResult result = add({"march", "june"}, {"2026-03-02"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err,
              HasSubstr("--date: 1 date for 2 campaigns; expected one date for each campaign, in their order"));
  result = add({"march"}, {"2.3.2026"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("--date: '2.3.2026' is not a date; expected year-month-day, such as 2026-03-02"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "mill.history"));
  ASSERT_EQ(add({"march"}, {"2026-03-02"}).exit_code, ExitCode::done);
  result = add({"march"}, {"2026-03-03"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("these errors are in the history already, as march of 2026-03-02"));
  result = abbe({"history", "trends", "mill.history"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("one campaign is in it; expected campaigns of two days or more"));
}

}  // namespace
}  // namespace abbe
