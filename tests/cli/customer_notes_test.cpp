// Notes in customer reports of `abbe evaluate` and `abbe run` in the languages other than English.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

class CustomerNotesCommand : public CommandTest {
 protected:
  static std::string example(const std::string& path) {
    std::ifstream file(ABBE_SOURCE_DIR "/examples/" + path);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
};

TEST_F(CustomerNotesCommand, NoNoteOfAnEvaluationIsLeftInEnglish) {
  const std::string examples = ABBE_SOURCE_DIR "/examples/", evaluate = examples + "evaluate/";
  const std::string laser = examples + "laser_engraver/", yin = examples + "machines/yin-engraver-u.machine.toml";
  const std::vector<std::vector<std::string>> tests = {
      {"positioning", evaluate + "linear.csv"},
      {"positioning", evaluate + "linear.csv", "--machine-temperature-degC", "23", "--machine-expansion-um-per-m-K",
       "11"},
      {"circular", evaluate + "circular.csv", "--radius-mm", "150", "--machine-temperature-degC", "23",
       "--machine-expansion-um-per-m-K", "11"},
      {"diagonals", evaluate + "diagonals.csv"},
      {"circular", evaluate + "circular.csv", "--radius-mm", "150"},
      {"rotation", evaluate + "rotation.csv"},
      {"straightness", evaluate + "straightness.csv"},
      {"squareness", evaluate + "squareness.csv"},
      {"contour", laser + "sections.csv"},
      {"contour", laser + "sections.csv", "--u-origin-um", "2"},
      {"contour", laser + "engraved.csv", "--curve", laser + "regions.ngc", "--machine", yin},
      {"linkage", laser + "five-steps.csv", "--machine", yin, "--exit-to-axis-mm", "120", "--board-mm", "4"}};
  for (const std::string language : {"de", "zh", "ja"}) {
    folder.write("facts.toml", "[report]\nlanguage = \"" + language + "\"\n");
    for (const std::vector<std::string>& test : tests) {
      std::vector<std::string> words = {"evaluate"};
      words.insert(words.end(), test.begin(), test.end());
      words.insert(words.end(), {"--facts", "facts.toml", "--customer-report", "report.html", "--force"});
      const CommandResult result = abbe(words);
      ASSERT_NE(result.exit_code, bad_input) << result.err;
      EXPECT_THAT(folder.read("report.html"), Not(HasSubstr("lang=\"en\""))) << test[0] << " " << language;
    }
  }
}

TEST_F(CustomerNotesCommand, NoNoteOfAStudyIsLeftInEnglish) {
  std::string study = example("three_axis/dials.study.toml");
  const std::string relative = "\"../machines";
  study.replace(study.find(relative), relative.size(), "\"" ABBE_SOURCE_DIR "/examples/machines");
  folder.write("x-axis.errors.toml", example("three_axis/x-axis.errors.toml"));
  folder.write("dials.study.toml", study + "\n[report]\nlanguage = \"de\"\ncustomer = { name = \"A\" }\n");
  const CommandResult result = abbe({"run", "dials.study.toml", "-o", "results"});
  ASSERT_EQ(result.exit_code, done) << result.err;
  const std::string page = folder.read("results/customer-report.html");
  EXPECT_THAT(page, Not(HasSubstr("lang=\"en\"")));
  EXPECT_THAT(page, HasSubstr("3 der 19 Abweichungen, die das Werkzeug bewegen, sind ermittelt. Wahre volumetrische"));
  EXPECT_THAT(page, HasSubstr("Die Messwerte lassen die volumetrische Abweichung in 2 Richtungen offen"));
}

}  // namespace
}  // namespace abbe
