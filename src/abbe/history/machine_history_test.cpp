#include "abbe/history/machine_history.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/machine/chain.h"
#include "abbe/study/comparison/campaigns_for_test.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

CampaignToKeep kept_campaign(const IdentifiedCampaign& campaign, const std::string& date) {
  return {campaign, date_of(date), "results/" + campaign.name, "{\"format\": 1}\n"};
}

/// A campaign of its own for every number.
CampaignToKeep numbered(std::uint64_t number) {
  IdentifiedCampaign campaign = drawn(mill_campaign("mill"), 3, number);
  campaign.name = "c" + std::to_string(number);
  return kept_campaign(campaign, date_text(date_of("2026-01-01") + std::chrono::days(number)));
}

std::string bytes_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class MachineHistory : public testing::Test {
 protected:
  std::string file() const { return (folder_ / "mill.history").string(); }
  /// One for each test: they run at the same time.
  const std::filesystem::path folder_ = test::empty_folder(
      (std::string("abbe_history_") + testing::UnitTest::GetInstance()->current_test_info()->name()).c_str());
};

TEST(HistoryDates, AreThoseOfTheCalendar) {
  EXPECT_EQ(date_text(date_of("2024-02-29")), "2024-02-29");
  EXPECT_EQ((date_of("2026-03-01") - date_of("2026-02-28")).count(), 1);
  for (const char* const text : {"", "2026-02-29", "2026-13-01", "2026-3-1", "26-03-01", "2026-03-01x", "0000-01-01",
                                 "-200-01-01", "2026/03/01", "2026-0a-01"}) {
    EXPECT_THAT(message_of([&] { date_of(text); }), HasSubstr("expected year-month-day, such as 2026-03-02")) << text;
  }
}

TEST_F(MachineHistory, GivesBackWhatWasAddedInTheOrderOfTime) {
  const CampaignToKeep later = numbered(7), earlier = numbered(2);
  EXPECT_THAT(add_to_history(file(), {later}), ElementsAre(1));
  EXPECT_THAT(add_to_history(file(), {earlier}), ElementsAre(2));
  const std::vector<KeptCampaign> kept = read_history(file());
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0].number, 2);
  EXPECT_EQ(kept[1].number, 1);
  EXPECT_EQ(date_text(kept[1].measured), "2026-01-08");
  const IdentifiedCampaign& back = kept[1].campaign;
  EXPECT_EQ(back.name, "c7");
  EXPECT_EQ(back.errors.errors.parameters(), later.campaign.errors.errors.parameters());
  EXPECT_EQ(back.errors.covariance, later.campaign.errors.covariance);
  EXPECT_EQ(machine_text(back.machine), machine_text(later.campaign.machine));
  EXPECT_EQ(kept[1].source, "results/c7");
  EXPECT_EQ(kept[1].summary, "{\"format\": 1}\n");
  EXPECT_THAT(kept[1].added, testing::MatchesRegex("20..-..-..T..:..:..Z"));
  EXPECT_FALSE(kept[1].abbe_version.empty());
}

TEST_F(MachineHistory, IsToldInLinesAndJsonAndByNumber) {
  add_to_history(file(), {numbered(7), numbered(2)});
  const std::vector<KeptCampaign> kept = read_history(file());
  EXPECT_EQ(history_text(kept),
            "   2  2026-01-03  c2  from results/c2\n"
            "   1  2026-01-08  c7  from results/c7\n");
  const nlohmann::ordered_json json = history_json(kept);
  ASSERT_EQ(json.size(), 2U);
  EXPECT_EQ(json[0].at("day"), "2026-01-03");
  EXPECT_EQ(json[1].at("number"), 1);
  EXPECT_EQ(campaign_of_history(file(), 2).campaign.name, "c2");
  EXPECT_THAT(message_of([&] { static_cast<void>(campaign_of_history(file(), 3)); }),
              HasSubstr("--campaign: there is no campaign 3 in "));
}

TEST_F(MachineHistory, ACampaignIsFilesOfAResultsFolder) {
  add_to_history(file(), {numbered(2)});
  KeptCampaign kept = read_history(file()).front();
  const auto names = [&] {
    std::vector<std::string> all;
    for (const auto& [name, contents] : campaign_files(kept)) all.push_back(name);
    return all;
  };
  EXPECT_THAT(names(), ElementsAre("machine.toml", "errors.toml", "errors.covariance.csv", "summary.json"));
  for (const auto& [name, contents] : campaign_files(kept)) std::ofstream(folder_ / name) << contents;
  const IdentifiedCampaign back = read_campaign(folder_.string(), std::nullopt);
  EXPECT_EQ(back.machine.chain(), kept.campaign.machine.chain());
  EXPECT_EQ(back.errors.errors.parameters(), kept.campaign.errors.errors.parameters());
  EXPECT_TRUE(back.errors.covariance.isApprox(kept.campaign.errors.covariance, 1e-12));
  kept.campaign.errors.covariance.resize(0, 0);
  kept.summary.clear();
  EXPECT_THAT(names(), ElementsAre("machine.toml", "errors.toml"));
}

TEST_F(MachineHistory, RefusesTheSameErrorsTwiceAndAddsNothingThen) {
  add_to_history(file(), {numbered(1)});
  EXPECT_THAT(message_of([&] {
                add_to_history(file(), {numbered(2), numbered(1)});
              }),
              HasSubstr("these errors are in the history already, as c1 of 2026-01-02"));
  EXPECT_EQ(read_history(file()).size(), 1U);
  EXPECT_THAT(message_of([&] {
                add_to_history(file(), {numbered(3), numbered(3)});
              }),
              HasSubstr("these are the errors of c3"));
  EXPECT_THAT(message_of([&] { add_to_history(file(), {}); }), HasSubstr("there is nothing to add"));
}

TEST_F(MachineHistory, RefusesAnotherMachine) {
  CampaignToKeep other = numbered(2);
  other.campaign.machine = parse_chain("w C' X' b Z t").machine;
  other.campaign.errors = {};
  add_to_history(file(), {numbered(1)});
  EXPECT_THAT(message_of([&] { add_to_history(file(), {other}); }), HasSubstr("campaigns of one machine"));
  const std::string elsewhere = file() + "2";
  EXPECT_THAT(message_of([&] {
                add_to_history(elsewhere, {numbered(1), other});
              }),
              HasSubstr("campaigns of one machine"));
  EXPECT_FALSE(std::filesystem::exists(elsewhere));
}

TEST_F(MachineHistory, RefusesErrorsThatItCouldNotReadAgain) {
  CampaignToKeep wrong = numbered(2);
  wrong.campaign.errors_file = "june";
  wrong.campaign.errors.errors.locations.at(0).value = 1e6;
  EXPECT_THAT(message_of([&] {
                add_to_history(file(), {numbered(1), wrong});
              }),
              testing::AllOf(HasSubstr("june:"), HasSubstr("too large for an error of a machine")));
  EXPECT_FALSE(std::filesystem::exists(file()));
  add_to_history(file(), {numbered(1)});
  EXPECT_THAT(message_of([&] { add_to_history(file(), {wrong}); }), HasSubstr("too large for an error of a machine"));
  EXPECT_EQ(read_history(file()).size(), 1U);
}

TEST_F(MachineHistory, LeavesFilesOfOthersAlone) {
  EXPECT_THAT(message_of([&] { read_history(file()); }), HasSubstr("mill.history: there is no such file; expected"));
  EXPECT_FALSE(std::filesystem::exists(file()));
  std::ofstream(file()).close();
  EXPECT_THAT(message_of([&] { read_history(file()); }), HasSubstr("mill.history: the file is empty; expected"));
  EXPECT_EQ(std::filesystem::file_size(file()), 0U);
  EXPECT_THAT(message_of([&] { read_history(folder_.string()); }), HasSubstr("cannot be opened"));
  EXPECT_THAT(message_of([&] { add_to_history((folder_ / "no/mill.history").string(), {numbered(1)}); }),
              HasSubstr("cannot be opened"));
  EXPECT_THAT(message_of([&] { read_history("-"); }), HasSubstr("is not the name of a file"));
  std::ofstream(file()) << "X_mm,Y_mm\n1,2\n" << std::string(2000, 'x');
  const std::string before = bytes_of_file(file());
  EXPECT_THAT(message_of([&] { add_to_history(file(), {numbered(1)}); }), HasSubstr("this is not a history"));
  EXPECT_THAT(message_of([&] { read_history(file()); }), HasSubstr("this is not a history"));
  EXPECT_EQ(bytes_of_file(file()), before);
}

TEST_F(MachineHistory, ACutFileIsSaidAndNoAnswer) {
  add_to_history(file(), {numbered(1), numbered(2)});
  const std::string whole = bytes_of_file(file());
  for (const std::size_t size : {whole.size() / 2, whole.size() - 5000, std::size_t{100}}) {
    std::ofstream(file(), std::ios::binary | std::ios::trunc) << whole.substr(0, size);
    EXPECT_THAT(message_of([&] { read_history(file()); }), HasSubstr("mill.history")) << size;
  }
}

/// Runs `work` in a process of its own.
template <typename Work>
pid_t forked(const Work& work) {
  const pid_t child = fork();
  if (child != 0) return child;
  int code = 0;
  try {
    work();
  } catch (const std::exception&) {
    code = 1;
  }
  _exit(code);
}

TEST_F(MachineHistory, SeveralProgramsMayAddAtATime) {
  constexpr std::uint64_t kPrograms = 6, kEach = 5;
  std::vector<CampaignToKeep> all;
  for (std::uint64_t k = 0; k < kPrograms * kEach; ++k) all.push_back(numbered(k));
  std::vector<pid_t> children;
  for (std::uint64_t program = 0; program < kPrograms; ++program) {
    children.push_back(forked([&] {
      for (std::uint64_t k = 0; k < kEach; ++k) add_to_history(file(), {all[program * kEach + k]});
    }));
  }
  for (const pid_t child : children) {
    int status = -1;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
  }
  std::set<std::string> names;
  for (const KeptCampaign& one : read_history(file())) names.insert(one.campaign.name);
  EXPECT_EQ(names.size(), kPrograms * kEach);
}

TEST_F(MachineHistory, ProgramsKilledAtAnyMomentLeaveWholeCampaigns) {
  add_to_history(file(), {numbered(0)});
  std::vector<CampaignToKeep> all;
  for (std::uint64_t k = 0; k < 60; ++k) all.push_back(numbered(k));
  std::size_t most = 1;
  // On a busy machine a program may need longer to write anything at all.
  for (std::uint64_t round = 0; round < 30 || (most == 1 && round < 40); ++round) {
    const pid_t child = forked([&] {
      // Two at a time: both, or none of them.
      for (std::uint64_t k = 1 + 2 * (round % 10); k + 1 < all.size(); k += 2) {
        try {
          add_to_history(file(), {all[k], all[k + 1]});
        } catch (const std::exception&) {  // in it already
        }
      }
    });
    usleep(static_cast<useconds_t>(round < 30 ? 300 + 700 * round : std::uint64_t{20'000} << (round - 29)));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const std::vector<KeptCampaign> kept = read_history(file());
    EXPECT_GE(kept.size(), most);
    most = kept.size();
    EXPECT_EQ(kept.size() % 2, 1U);
    for (const KeptCampaign& one : kept) {
      const auto number = static_cast<std::size_t>(std::stoul(one.campaign.name.substr(1)));
      EXPECT_EQ(one.campaign.errors.errors.parameters(), all[number].campaign.errors.errors.parameters());
      EXPECT_EQ(one.campaign.errors.covariance, all[number].campaign.errors.covariance);
    }
  }
  EXPECT_GT(most, 1U);
}

}  // namespace
}  // namespace abbe
