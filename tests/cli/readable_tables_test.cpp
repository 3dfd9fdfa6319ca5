// Files that other programs wrote, given to the commands that evaluate readings, without abbe import.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "abbe/formats/import/gzip_for_test.h"
#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const std::string kExamples = ABBE_SOURCE_DIR "/examples/";

class ReadableTables : public CommandTest {
 protected:
  nlohmann::json figures(std::vector<std::string> arguments) const {
    arguments.emplace_back("--json");
    const CommandResult result = abbe(arguments);
    EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
    return result.exit_code == ExitCode::done ? nlohmann::json::parse(result.out).at("figures") : nlohmann::json();
  }

  std::string example(const std::string& name) const {
    std::ostringstream text;
    std::ifstream file(kExamples + name, std::ios::binary);
    text << file.rdbuf();
    EXPECT_FALSE(text.str().empty()) << name;
    return text.str();
  }

  /// With semicolons and decimal commas; comments stay.
  static std::string german(const std::string& csv) {
    std::string text;
    bool comment = false, start = true;
    for (const char c : csv) {
      if (start) comment = c == '#';
      start = c == '\n';
      if (!comment && c == ',') {
        text += ';';
      } else if (!comment && c == '.') {
        text += ',';
      } else {
        text += c;
      }
    }
    return text;
  }
};

TEST_F(ReadableTables, EvaluationsAreTheSame) {
  struct Case {
    std::string test, file;
    std::vector<std::string> options;
  };
  for (const Case& one :
       {Case{"positioning", "linear.csv", {}}, Case{"positioning", "rotary.csv", {}},
        Case{"diagonals", "diagonals.csv", {}}, Case{"straightness", "straightness.csv", {}},
        Case{"squareness", "squareness.csv", {}}, Case{"rotation", "rotation.csv", {}}, Case{"etve", "etve.csv", {}},
        Case{"spindle-distortion", "spindle.csv", {}}, Case{"axis-distortion", "axis_warming.csv", {}}}) {
    const std::string csv = example("evaluate/" + one.file);
    const auto evaluated = [&](const std::string& file) { return figures({"evaluate", one.test, file}); };
    const nlohmann::json expected = evaluated(kExamples + "evaluate/" + one.file);
    folder.write("german.csv", german(csv));
    EXPECT_EQ(evaluated("german.csv"), expected) << one.file;
    folder.write("packed.csv.gz", test::gzip_of(csv));
    EXPECT_EQ(evaluated("packed.csv.gz"), expected) << one.file;
    folder.write("utf16.txt", "\xFF\xFE" + test::utf16_of(german(csv), false));
    EXPECT_EQ(evaluated("utf16.txt"), expected) << one.file;
  }
}

TEST_F(ReadableTables, FitsRegistrationsAndDeviationsAreTheSame) {
  folder.write("bore.csv", german(example("fit/bore.csv")));
  EXPECT_EQ(figures({"fit", "bore.csv", "--shape", "cylinder"}),
            figures({"fit", kExamples + "fit/bore.csv", "--shape", "cylinder"}));
  folder.write("bore.csv.gz", test::gzip_of(example("fit/bore.csv")));
  EXPECT_EQ(figures({"fit", "bore.csv.gz", "--shape", "cylinder"}),
            figures({"fit", kExamples + "fit/bore.csv", "--shape", "cylinder"}));
  const std::string pin = kExamples + "scan/pin.stl", transform = kExamples + "scan/pin-transform.csv";
  const nlohmann::json deviations =
      figures({"deviate", kExamples + "scan/pin-scan.csv", pin, "--transform", transform});
  folder.write("scan.csv.gz", test::gzip_of(german(example("scan/pin-scan.csv"))));
  folder.write("pin.stl.gz", test::gzip_of(example("scan/pin.stl")));
  EXPECT_EQ(figures({"deviate", "scan.csv.gz", "pin.stl.gz", "--transform", transform}), deviations);
  const auto pose = [&](const std::string& scan) {
    const CommandResult result = abbe({"register", scan, kExamples + "scan/bracket.stl", "--json"});
    EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
    return result.exit_code == ExitCode::done ? nlohmann::json::parse(result.out).at("part_from_scan")
                                              : nlohmann::json();
  };
  folder.write("bracket-scan.csv", german(example("scan/bracket-scan.csv")));
  EXPECT_EQ(pose("bracket-scan.csv"), pose(kExamples + "scan/bracket-scan.csv"));
}

TEST_F(ReadableTables, RefusalsSayWhatIsWrongInTheFile) {
  folder.write("damaged.csv.gz", "\x1f\x8b\x08 this is no gzip");
  CommandResult result = abbe({"evaluate", "positioning", "damaged.csv.gz"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("damaged.csv.gz: "));
  EXPECT_THAT(result.err, HasSubstr("gzip"));
  folder.write("thousands.csv", "x_mm;y_mm;z_mm\n1,234;2,345;3,456\n");
  result = abbe({"fit", "thousands.csv", "--shape", "plane"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("thousands.csv:2:1: '1,234' in line 2 may have decimals or thousands"));
  folder.write("binary.csv", std::string("\x89PNG\r\n\x1a\n\0\0\xFF\xFE\x80", 13));
  result = abbe({"evaluate", "straightness", "binary.csv"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("this is not text"));
}

}  // namespace
}  // namespace abbe
