#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <stop_token>
#include <string>
#include <vector>

#include "abbe/formats/files/work_checkpoint.h"
#include "abbe/formats/readings/reading_shards.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/study/example_file_for_test.h"
#include "abbe/study/run_study.h"
#include "abbe/study/study_steps.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// A ball bar on a trunnion mill, its readings in files: 16 times those of the example, with a line of its own each.
class StreamedReadings : public testing::Test {
 protected:
  StreamedReadings() {
    folder_ = std::filesystem::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    study_ = read_study(test::example_file("trunnion/ball-bar.study.toml"));
    const Campaign campaign = gather_readings(study_);
    const std::string text = campaign.setups[0].readings_text(study_.machine);
    const std::size_t end = text.find('\n') + 1;
    header_ = text.substr(0, end);
    rows_ = text.substr(end);
    study_.simulation.reset();
    study_.identification->held_out_fraction = 0;
    study_.output = folder_ / "results";
    give({{"a.csv", repeated(7)}, {"b.csv", "# the second day\n" + repeated(9)}});
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string repeated(int times) const {
    std::string text = header_;
    for (int i = 0; i < times; ++i) text += rows_;
    return text;
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  void give(const std::vector<std::pair<std::string, std::string>>& files) {
    study_.setups[0].data.clear();
    for (const auto& [name, text] : files) {
      write(name, text);
      study_.setups[0].data.emplace_back().file = folder_ / name;
    }
  }
  StudyResult run(std::size_t in_memory, const RunOptions& options = {.map = false}) {
    study_.identification->readings_in_memory = in_memory;
    return run_study(study_, options);
  }
  std::string refusal() {
    try {
      run(1000);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  std::filesystem::path unfinished() const { return folder_ / "results.unfinished"; }
  /// Keeps every block from the beginning.
  static CheckpointOptions at_once(std::function<void(const std::string&)> tell = {}) {
    return {.after_s = 0, .remaining_s = 0, .tell = std::move(tell)};
  }
  /// A run that keeps its sums and is stopped in the middle of the identification.
  void stop_after_sums(int blocks) {
    std::stop_source stop;
    int steps = 0;
    const auto stop_later = [&](StudyStep step, std::size_t, std::size_t) {
      if (step == StudyStep::identify && ++steps == blocks) stop.request_stop();
    };
    WorkCheckpoint checkpoint(folder_ / "results", at_once());
    EXPECT_THROW(run(1000, {.map = false,
                            .progress = stop_later,
                            .stop = stop.get_token(),
                            .work = [&](const NumberedWork& work) { checkpoint.work(work, {}); }}),
                 Stopped);
  }

  std::filesystem::path folder_;
  Study study_;
  std::string header_, rows_;
};

void expect_same(const Identification& a, const Identification& b) {
  EXPECT_EQ(a.status, b.status);
  ASSERT_EQ(a.estimates.size(), b.estimates.size());
  EXPECT_EQ(a.estimates, b.estimates);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.statistics.chi_square, b.statistics.chi_square);
  EXPECT_EQ(a.statistics.degrees_of_freedom, b.statistics.degrees_of_freedom);
}

TEST_F(StreamedReadings, ArePartsOfOneLongPieceOnly) {
  for (const std::size_t blocks : {std::size_t{256 * 48}, std::size_t{20000}, std::size_t{781250}})
    EXPECT_EQ(readings_of_piece(blocks) % ReadingShards::kTogether, 0U) << blocks;
}

TEST_F(StreamedReadings, GiveTheBytesOfThoseInMemory) {
  const StudyResult in_memory = run(0), small_enough = run(1'000'000), streamed = run(1000);
  ASSERT_EQ(in_memory.identification.status, IdentifyStatus::converged);
  EXPECT_EQ(small_enough.campaign.setups[0].shards, nullptr);
  ASSERT_NE(streamed.campaign.setups[0].shards, nullptr);
  EXPECT_EQ(streamed.campaign.setups[0].shards->count(), in_memory.campaign.reading_count());
  EXPECT_LT(streamed.campaign.reading_count(), 1300U);
  expect_same(in_memory.identification, small_enough.identification);
  expect_same(in_memory.identification, streamed.identification);
  EXPECT_THAT(streamed.warnings, testing::Contains(HasSubstr("are read again for every sum")));
}

TEST_F(StreamedReadings, CountTheOutliersOfAllReadings) {
  const std::string middle = repeated(7);
  const std::size_t row = middle.find('\n', middle.size() / 2) + 1;
  std::string wrong = middle;
  std::size_t length = row;  // behind five axes and the item
  for (int comma = 0; comma < 6; ++comma) length = wrong.find(',', length) + 1;
  const double read = std::stod(wrong.substr(length));
  wrong.replace(length, wrong.find(',', length) - length, std::to_string(read + 0.5));
  const auto reading = std::count(middle.begin(), middle.begin() + static_cast<std::ptrdiff_t>(row), '\n') - 1;
  give({{"a.csv", repeated(3)}, {"b.csv", wrong}});
  const StudyResult result = run(1000);
  EXPECT_THAT(result.warnings, testing::Contains(testing::AllOf(HasSubstr("readings are outliers"),
                                                                HasSubstr("reading " + std::to_string(reading) +
                                                                          " of " + (folder_ / "b.csv").string()))));
}

TEST_F(StreamedReadings, AreRefusedIfAFileWasCutOff) {
  std::string text = repeated(9);
  text.resize(text.size() - 3);
  write("b.csv", text);
  EXPECT_THAT(refusal(), HasSubstr("b.csv:"));
  EXPECT_THAT(refusal(), HasSubstr("ends within a row"));
}

TEST_F(StreamedReadings, AreRefusedIfAFileIsGivenTwice) {
  write("b.csv", repeated(7));
  EXPECT_THAT(refusal(), HasSubstr("b.csv: has the same content as"));
  study_.setups[0].data[1].file = folder_ / "." / "a.csv";
  EXPECT_THAT(refusal(), HasSubstr("is given twice"));
}

TEST_F(StreamedReadings, NameTheLineOfABadField) {
  std::string text = repeated(9);
  const std::size_t row = text.find('\n', text.size() * 9 / 10) + 1;
  const auto line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(row), '\n') + 1;
  text.insert(row, "x");
  write("b.csv", text);
  EXPECT_THAT(refusal(), HasSubstr("b.csv:" + std::to_string(line) + ":"));
}

TEST_F(StreamedReadings, AreRefusedIfAFileChangesDuringTheRun) {
  for (const bool shorter : {true, false}) {
    give({{"a.csv", repeated(16)}});
    bool changed = false;
    const auto change = [&](StudyStep step, std::size_t done, std::size_t) {
      if (step != StudyStep::identify || done == 0 || changed) return;
      changed = true;
      std::string text = repeated(16);
      if (shorter) {
        std::filesystem::resize_file(folder_ / "a.csv", text.size() / 2);
      } else {
        const std::size_t digit = text.find_last_of("123456789");
        text[digit] = text[digit] == '9' ? '8' : '9';
        std::fstream(folder_ / "a.csv", std::ios::in | std::ios::out) << text;
      }
    };
    try {
      run(1000, {.map = false, .progress = change});
      FAIL() << "the change was not seen";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(shorter ? "has become shorter" : "has changed since"));
    }
  }
}

TEST_F(StreamedReadings, GoOnFromTheSumsOfARunThatWasStopped) {
  const StudyResult whole = run(1000);
  stop_after_sums(20);
  ASSERT_TRUE(std::filesystem::exists(unfinished()));
  // Killed while it wrote a record.
  std::filesystem::resize_file(unfinished(), std::filesystem::file_size(unfinished()) - 5);
  std::string told;
  {
    WorkCheckpoint checkpoint(folder_ / "results", at_once([&](const std::string& sentence) { told += sentence; }));
    const StudyResult resumed =
        run(1000, {.map = false, .work = [&](const NumberedWork& work) { checkpoint.work(work, {}); }});
    expect_same(whole.identification, resumed.identification);
    checkpoint.remove();
  }
  EXPECT_THAT(told, HasSubstr("of the sums over the readings are taken from"));
  EXPECT_FALSE(std::filesystem::exists(unfinished()));
}

TEST_F(StreamedReadings, TakeNoSumsOfAnotherModelOrOfOtherReadings) {
  stop_after_sums(20);
  study_.machine.tool_reference.z() += 1e-3;  // residuals become others, requests do not
  const auto expect_fresh = [&] {
    const StudyResult fresh = run(1000);
    std::string told;
    WorkCheckpoint checkpoint(folder_ / "results", at_once([&](const std::string& sentence) { told += sentence; }));
    const StudyResult result =
        run(1000, {.map = false, .work = [&](const NumberedWork& work) { checkpoint.work(work, {}); }});
    expect_same(fresh.identification, result.identification);
    EXPECT_THAT(told, testing::Not(HasSubstr("taken from")));
    EXPECT_THAT(told, HasSubstr("belong to other inputs"));
  };
  expect_fresh();
  stop_after_sums(20);
  give({{"a.csv", repeated(6)}, {"b.csv", repeated(10)}});
  expect_fresh();
}

TEST_F(StreamedReadings, AreRefusedByTheKeyThatNeedsAllInMemory) {
  std::ifstream file(test::example_file("trunnion/ball-bar.study.toml"));
  const std::string example(std::istreambuf_iterator<char>(file), {});
  const std::vector<SetupData> data = study_.setups[0].data;
  const auto with = [&](const std::string& line) {
    std::string text = example;
    const auto put = [&](const std::string& old, const std::string& own) {
      ASSERT_NE(text.find(old), std::string::npos) << old;
      text.replace(text.find(old), old.size(), own);
    };
    put("\"../machines/trunnion-mill.machine.toml\"",
        "\"" + test::example_file("machines/trunnion-mill.machine.toml") + "\"");
    put("held_out_fraction = 0.1", line);
    write("key.study.toml", text);
    study_ = read_study(folder_ / "key.study.toml");
    study_.simulation.reset();
    study_.setups[0].data = data;
    if (line.find("held_out_fraction") != 0) study_.identification->held_out_fraction = 0;
  };
  // Read from a file, so that every key named is one that a study can have.
  for (const char* const text :
       {"held_out_fraction = 0.2", "loss = \"huber\"", "strategy = \"independent\"", "variance_factor = \"estimated\"",
        "pose_noise = \"estimated\"", "block_noise = \"estimated\"\nnoise_block_min = 5", "monte_carlo = 100"}) {
    const std::string line = text;
    with(line);
    const std::string key = "identify." + line.substr(0, line.find(' '));
    EXPECT_THAT(refusal(), testing::StartsWith("trunnion mill, ball bar: " + key + ": ")) << line;
    EXPECT_THAT(refusal(), HasSubstr("needs all readings in memory, and set-up bar has "));
  }
  with("");
  EXPECT_EQ(refusal(), "");
}

}  // namespace
}  // namespace abbe
