// The examples of docs/formats.md and docs/import.md are files that the readers accept.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <vector>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/import/import_mapping.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/readings/channel_file.h"
#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/study/study_file.h"

namespace abbe {
namespace {

std::vector<std::string> blocks(const std::string& kind, const char* page = "formats.md") {
  const std::string text = read_text_file(std::filesystem::path(ABBE_DOCS) / page);
  const std::string begin = "```" + kind + "\n";
  std::vector<std::string> found;
  for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
    at += begin.size();
    const std::size_t end = text.find("```", at);
    found.push_back(text.substr(at, end - at));
    at = end;
  }
  return found;
}

TEST(DocumentedExamples, AreAccepted) {
  const std::vector<std::string> toml = blocks("toml"), csv = blocks("csv");
  ASSERT_EQ(toml.size(), 7U);
  ASSERT_EQ(csv.size(), 3U);
  const Machine machine = parse_machine(toml[0], "machine");
  EXPECT_EQ(machine.chain(), "w C' X' b Z t");
  const std::string arm = "name = \"arm\"\nchain = \"w b A1 A2 A3 t\"\n" + toml[1] +
                          "[axis.A1]\ntravel_deg = [-90, 90]\n[axis.A2]\ntravel_deg = [-90, 90]\n";
  EXPECT_EQ(parse_machine(arm, "arm").couplings.size(), 1U);
  const std::string column = "name = \"column\"\nchain = \"w X' b Z A t\"\n" + toml[2] +
                             "[axis.X]\ntravel_mm = [0, 1]\n[axis.Z]\ntravel_mm = [0, 1]\n[axis.A]\nendless = true\n";
  EXPECT_EQ(parse_machine(column, "states").states.size(), 7U);

  const auto folder = std::filesystem::path(testing::TempDir()) / "abbe_documented";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "ebx.csv") << "X_mm,EBX_urad,remark\n0,1,a\n1400,2,b\n";
  std::string errors = toml[3];
  const std::string covariance = "covariance = \"a.covariance.csv\"";
  ASSERT_NE(errors.find(covariance), std::string::npos);
  errors.erase(errors.find(covariance), covariance.size());
  const Machine with_state = parse_machine(toml[0] + "[state.ambient]\nkind = \"measured\"\nunit = \"degC\"\n" +
                                               "[state.scale_x]\nkind = \"measured\"\nunit = \"degC\"\n",
                                           "state");
  const ErrorsFile contents = parse_errors(errors, folder / "a.errors.toml", with_state, StatesOfErrors::allowed);
  EXPECT_EQ(contents.errors.motions.size(), 8U);
  EXPECT_EQ(contents.errors.motions[4].basis.nodes.size(), 2U);

  EXPECT_EQ(parse_measurements(csv[0], "csv", machine).readings.count(), 2U);
  const Machine recorded = parse_machine(toml[0] + "[state.ambient]\nkind = \"measured\"\nunit = \"degC\"\n" +
                                             "[state.spindle]\nkind = \"measured\"\nunit = \"degC\"\n",
                                         "recorded");
  StateChannels channels;
  channels.add(csv[2], "csv", recorded, {});
  EXPECT_EQ(channels.common_time(), std::pair(-90.0 * 60, -88.0 * 60));
  EXPECT_EQ(parse_measurements(csv[1], "csv", machine).readings.stated, StatedUncertainty::covariance);

  const std::vector<std::string> mapping = blocks("toml", "import.md");
  ASSERT_EQ(mapping.size(), 1U);
  EXPECT_EQ(parse_import_mapping(mapping[0], "m.import.toml").columns.size(), 2U);

  const Machine with_lag = parse_machine(
      machine_text(with_state) + "[state.column]\nkind = \"lag\"\nof = \"ambient\"\ntime_constant_s = 2400\n", "lag");
  const Study simulated = parse_study(toml[4], "a.study.toml", with_lag);
  EXPECT_EQ(simulated.setups[0].plans.size(), 4U);
  EXPECT_EQ(simulated.identification->motions.size(), 15U);
  const Study measured = parse_study(toml[5], "b.study.toml", machine);
  EXPECT_TRUE(measured.setups[0].noise_from_data);
  const Study bar = parse_study(toml[6], "c.study.toml", machine);
  EXPECT_EQ(bar.setups[0].plans.size(), 2U);
}

}  // namespace
}  // namespace abbe
