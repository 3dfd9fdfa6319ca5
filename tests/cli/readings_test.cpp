// Readings against the machine: abbe check of a study, what abbe run says of readings that do not fit, and abbe verify
// --readings.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kFolder = ABBE_SOURCE_DIR "/examples/";
const std::string kSecondTracker = kFolder + "verify/second-tracker.study.toml";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

std::string text_of(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

class ReadingsAgainstTheMachine : public CommandTest {
 protected:
  /// The study of the second tracker with readings that are changed, a row at a time: X, Y, Z, A, C, range, azimuth,
  /// elevation; mm and degrees.
  std::string study_of(const std::function<void(std::vector<double>&)>& change, const std::string& more = "") const {
    std::istringstream lines(text_of(kFolder + "verify/second-tracker.csv"));
    std::string line, csv;
    std::getline(lines, line);
    csv = line + "\n";
    while (std::getline(lines, line)) {
      std::vector<double> row;
      std::istringstream fields(line);
      for (std::string field; std::getline(fields, field, ',');) row.push_back(std::stod(field));
      change(row);
      for (std::size_t c = 0; c < row.size(); ++c) csv += (c > 0 ? "," : "") + fmt::format("{:.7f}", row[c]);
      csv += "\n";
    }
    folder.write("second-tracker.csv", csv);
    const std::string study = replaced(text_of(kSecondTracker), "\"../machines", "\"" + kFolder + "machines");
    return folder.write("changed.study.toml", study + more).string();
  }
};

TEST_F(ReadingsAgainstTheMachine, CheckReadsAStudyAndSaysThatTheyFit) {
  const CommandResult result = abbe({"check", kSecondTracker});
  EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("tracker (tracker): 60 readings\nthe nominal machine explains the readings"));
  const CommandResult simulated = abbe({"check", kFolder + "aguado/aguado.study.toml", "--json"});
  EXPECT_EQ(simulated.exit_code, ExitCode::done) << simulated.err;
  const nlohmann::json json = nlohmann::json::parse(simulated.out);
  EXPECT_EQ(json["simulated"], true);
  EXPECT_EQ(json["explained"], true);
  EXPECT_EQ(json["setups"][0]["readings"], 1800);
}

TEST_F(ReadingsAgainstTheMachine, CheckNamesWhatWouldExplainThem) {
  const std::string study = study_of([](std::vector<double>& row) {
    row[6] = -row[6];
    row[7] = 90 - row[7];
  });
  const std::string cause = "if the azimuth counts clockwise, and the elevation counts from the zenith\n";
  const CommandResult result = abbe({"check", study});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.out, HasSubstr("front: none of its 60 readings fits the nominal machine; they fit to "));
  EXPECT_THAT(result.out, HasSubstr(cause));
  EXPECT_THAT(result.out, Not(HasSubstr("explains the readings of all")));
  const CommandResult json = abbe({"check", study, "--json"});
  EXPECT_EQ(json.exit_code, ExitCode::computation_says_no);
  EXPECT_EQ(nlohmann::json::parse(json.out)["setups"][0]["unexplained"][0]["causes"].size(), 1U);

  const std::string with_errors =
      study_of([](std::vector<double>& row) { std::swap(row[0], row[1]); }, "\n[identify]\nlocations = [\"EX0C\"]\n");
  const CommandResult run = abbe({"run", with_errors, "-o", "results"});
  EXPECT_EQ(run.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(run.out, HasSubstr("if the commands of Y and X are swapped\n"));
}

TEST_F(ReadingsAgainstTheMachine, WhatNothingExplainsIsNotCalledExplained) {
  // The offset of the reflector is open in this study.
  const std::vector<std::function<void(std::vector<double>&)>> changes = {[row = 0](std::vector<double>& of) mutable {
                                                                            of[6] = std::fmod(37.0 * row * row, 360);
                                                                            of[7] = std::fmod(23.0 * row * row, 80);
                                                                            ++row;
                                                                          },
                                                                          [](std::vector<double>& of) {
                                                                            of[0] /= 25.4;  // X and Z alone are in inch
                                                                            of[2] /= 25.4;
                                                                          }};
  for (const auto& change : changes) {
    const CommandResult result = abbe({"check", study_of(change)});
    EXPECT_EQ(result.exit_code, ExitCode::computation_says_no) << result.out;
    EXPECT_THAT(result.out, HasSubstr("none of the usual mistakes would explain that"));
    EXPECT_THAT(result.out, Not(HasSubstr("the nominal machine explains")));
  }
}

TEST_F(ReadingsAgainstTheMachine, CheckFindsATrackerThatWasMoved) {
  const CommandResult result = abbe({"check", study_of([row = 0](std::vector<double>& of) mutable {
                                       if (row++ >= 30) of[6] += 40;
                                     })});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.out, HasSubstr("mm if front moved after reading 29\n"));
}

TEST_F(ReadingsAgainstTheMachine, CheckDoesNotSayThatTheMachineExplainsWhatItCannotJudge) {
  const CommandResult result = abbe({"check", kFolder + "three_axis/level-and-autocollimator.study.toml"});
  EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("they cannot be checked against the nominal machine\n"));
  EXPECT_THAT(result.out, Not(HasSubstr("the nominal machine explains")));
}

TEST_F(ReadingsAgainstTheMachine, RunWithoutAnIdentificationSaysWhatIsWrong) {
  const std::string study = study_of([](std::vector<double>& row) { row[6] = -row[6]; });
  const CommandResult result = abbe({"run", study, "-o", "results"});
  EXPECT_EQ(result.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(result.out, HasSubstr("if the azimuth counts clockwise\n"));
  EXPECT_THAT(result.err, HasSubstr("the nominal machine does not explain the readings"));
  const CommandResult json = abbe({"run", study, "-o", "json", "--json"});
  EXPECT_EQ(json.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(nlohmann::json::parse(json.out)["warnings"].dump(), HasSubstr("the azimuth counts clockwise"));
  EXPECT_EQ(abbe({"run", study, "-o", "accepted", "--accept-misfit"}).exit_code, ExitCode::done);
  const CommandResult good = abbe({"run", kSecondTracker, "-o", "good"});
  EXPECT_EQ(good.exit_code, ExitCode::done) << good.err;
  EXPECT_THAT(good.out, Not(HasSubstr("warning")));
}

TEST_F(ReadingsAgainstTheMachine, CheckRefusesWhatAStudyHasNoUseFor) {
  const CommandResult unit = abbe({"check", kSecondTracker, "--unit", "mm"});
  EXPECT_EQ(unit.exit_code, ExitCode::bad_input);
  EXPECT_THAT(unit.err, HasSubstr("--unit: a study states its machine, errors and units"));
  const std::string bad = study_of([](std::vector<double>& row) { row[5] = -1; });
  const CommandResult result = abbe({"check", bad});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("second-tracker.csv:2:"));
}

class VerifyReadings : public ReadingsAgainstTheMachine {
 protected:
  const std::string errors_ = kFolder + "compensate/trunnion.errors.toml";
  CommandResult verify(const std::string& study, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"verify", "--errors", errors_, "--readings", study});
    return abbe(more);
  }
};

TEST_F(VerifyReadings, OfAnotherInstrumentConfirmTheErrors) {
  const CommandResult result = verify(kSecondTracker, {"-o", "page.html", "--least-reduction", "4"});
  EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("improvement: the identified errors make the residuals smaller\n"));
  EXPECT_THAT(result.out,
              HasSubstr("reduction: the mean residual becomes 4.7 times smaller: at least the required 4 times\n"));
  EXPECT_THAT(folder.read("page.html"), HasSubstr("Second tracker"));
  const nlohmann::json json = nlohmann::json::parse(verify(kSecondTracker, {"--json"}).out);
  EXPECT_EQ(json["readings"], 60);
  EXPECT_NEAR(json["chi_square"], 172.3, 0.1);
  EXPECT_EQ(json["degrees_of_freedom"], 171);
}

TEST_F(VerifyReadings, ThatContradictTheErrorsSayNo) {
  const CommandResult moved = verify(study_of([](std::vector<double>& row) { row[5] += 2e-4 * row[0]; }));
  EXPECT_EQ(moved.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(moved.out, HasSubstr("do NOT explain what is left"));
  const CommandResult wanted = verify(kSecondTracker, {"--largest-ratio", "0.9"});
  EXPECT_EQ(wanted.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(wanted.out, HasSubstr("ABOVE the permitted 0.9 times"));
}

TEST_F(VerifyReadings, TakeNothingThatTheyHaveNoUseFor) {
  for (const auto& [option, value] : std::vector<std::pair<std::string, std::string>>{
           {"--truth", kFolder + "verify/truth.errors.toml"},
           {"--range", "X_mm=0:1"},
           {"--seed", "3"},
           {"--poses", "20"},
           {"--reach-mm", "2"},
           {"--machine", kFolder + "machines/trunnion-mill.machine.toml"}}) {
    const CommandResult result = verify(kSecondTracker, {option, value});
    EXPECT_EQ(result.exit_code, ExitCode::bad_input) << option;
    EXPECT_THAT(result.err, HasSubstr(option + ": cannot be combined with --readings"));
  }
  const CommandResult none = abbe({"verify", "--readings", kSecondTracker});
  EXPECT_EQ(none.exit_code, ExitCode::bad_input);
  EXPECT_THAT(none.err, HasSubstr("--errors"));
  const CommandResult other =
      abbe({"verify", "--errors", kFolder + "compare/march.errors.toml", "--readings", kSecondTracker});
  EXPECT_EQ(other.exit_code, ExitCode::bad_input);
  EXPECT_THAT(other.err, HasSubstr("march.errors.toml"));
}

}  // namespace
}  // namespace abbe
