#include "abbe/formats/files/work_checkpoint.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <numeric>
#include <thread>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

struct Killed {};

/// Forty blocks of three numbers.
class Numbers {
 public:
  explicit Numbers(double start = 1) : start_(start), values_(kBlocks * 3) {}

  NumberedWork work() {
    NumberedWork work;
    work.name = "test";
    work.blocks = kBlocks;
    work.threads = 2;
    work.fingerprint = [this] { return static_cast<std::uint64_t>(start_); };
    work.compute = [this](std::size_t block) {
      if (killed_after != 0 && computed == killed_after) throw Killed();
      ++computed;
      for (std::size_t i = 3 * block; i < 3 * block + 3; ++i) values_[i] = start_ / (1 + static_cast<double>(i));
    };
    work.pack = [this](std::size_t block, std::vector<std::byte>& bytes) { pack_numbers(of(block), bytes); };
    work.unpack = [this](std::size_t block, std::span<const std::byte> bytes) {
      unpack_numbers(bytes, of(block));
      require_unpacked(bytes);
    };
    return work;
  }
  const std::vector<double>& values() const { return values_; }

  static constexpr std::size_t kBlocks = 40;
  std::atomic<std::size_t> computed{0};
  std::size_t killed_after = 0;

 private:
  std::span<double> of(std::size_t block) { return {values_.data() + 3 * block, 3}; }

  double start_;
  std::vector<double> values_;
};

class WorkCheckpointTest : public testing::Test {
 protected:
  WorkCheckpointTest()
      : folder_(test::empty_folder(
            (std::string("work-checkpoint-") + testing::UnitTest::GetInstance()->current_test_info()->name())
                .c_str())) {
    Numbers numbers;
    work_in_threads(numbers.work());
    expected_ = numbers.values();
  }

  CheckpointOptions at_once() {
    return {.version = "1", .after_s = 0, .remaining_s = 0, .tell = [this](const std::string& sentence) {
              said_ += sentence + "\n";
            }};
  }
  /// Leaves `blocks` finished blocks.
  void kill_after(std::size_t blocks, double start = 1) {
    Numbers numbers(start);
    numbers.killed_after = blocks;
    WorkCheckpoint checkpoint(output(), at_once());
    NumberedWork work = numbers.work();
    work.threads = 1;
    EXPECT_THROW(checkpoint.work(work, {}), Killed);
  }
  /// All of it, from what is there. @returns number of blocks that were computed
  std::size_t finish() {
    Numbers numbers;
    WorkCheckpoint checkpoint(output(), at_once());
    checkpoint.work(numbers.work(), {});
    EXPECT_EQ(numbers.values(), expected_);
    checkpoint.remove();
    EXPECT_FALSE(fs::exists(file()));
    return numbers.computed;
  }
  fs::path output() const { return folder_ / "results"; }
  fs::path file() const { return folder_ / "results.unfinished"; }
  std::string contents() const {
    std::ifstream in(file(), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void write(const std::string& bytes) const { std::ofstream(file(), std::ios::binary) << bytes; }

  fs::path folder_;
  std::vector<double> expected_;
  std::string said_;
};

TEST_F(WorkCheckpointTest, KilledWorkGoesOnWithItsFinishedBlocks) {
  kill_after(17);
  EXPECT_TRUE(fs::exists(file()));
  EXPECT_EQ(finish(), Numbers::kBlocks - 17);
  EXPECT_NE(said_.find("17 of 40 blocks"), std::string::npos) << said_;
}

// Results that are added up and dropped are still there when they are written, also those from before the file began.
TEST_F(WorkCheckpointTest, BlocksAreReducedOnceAndWrittenBefore) {
  const double all = std::accumulate(expected_.begin(), expected_.end(), 0.0);
  for (const double after_s : {0.0, 0.02, 1e9}) {
    for (const std::size_t killed : {std::size_t{17}, std::size_t{0}}) {
      Numbers numbers;
      numbers.killed_after = killed;
      std::vector<int> reduced(Numbers::kBlocks);
      double sum = 0;
      NumberedWork work = numbers.work();
      work.threads = 1;
      work.compute = [compute = work.compute](std::size_t block) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        compute(block);
      };
      work.reduce = [&](std::size_t block) {
        ++reduced[block];
        std::vector<std::byte> bytes;
        work.pack(block, bytes);
        std::array<double, 3> values{}, zeros{};
        std::span<const std::byte> rest = bytes;
        unpack_numbers(rest, values);
        sum += values[0] + values[1] + values[2];
        bytes.clear();
        pack_numbers(zeros, bytes);
        work.unpack(block, bytes);
      };
      CheckpointOptions options = at_once();
      options.after_s = after_s;
      WorkCheckpoint checkpoint(output(), options);
      if (killed > 0) {
        EXPECT_THROW(checkpoint.work(work, {}), Killed);
        continue;
      }
      checkpoint.work(work, {});
      checkpoint.remove();
      EXPECT_EQ(reduced, std::vector<int>(Numbers::kBlocks, 1)) << after_s;
      EXPECT_NEAR(sum, all, 1e-12) << after_s;
      EXPECT_EQ(numbers.computed, Numbers::kBlocks - (after_s < 1 ? 17 : 0));
    }
  }
}

TEST_F(WorkCheckpointTest, WorkThatIsNotKeptMakesNoFile) {
  Numbers numbers;
  WorkCheckpoint checkpoint(output(), at_once());
  NumberedWork work = numbers.work();
  work.is_kept = false;
  checkpoint.work(work, {});
  EXPECT_FALSE(fs::exists(file()));
  EXPECT_EQ(numbers.values(), expected_);
}

TEST_F(WorkCheckpointTest, SeveralKillsAddUp) {
  kill_after(10);
  kill_after(12);
  EXPECT_EQ(finish(), Numbers::kBlocks - 22);
}

TEST_F(WorkCheckpointTest, ShortWorkMakesNoFile) {
  Numbers numbers;
  CheckpointOptions options = at_once();
  options.after_s = 2;
  WorkCheckpoint checkpoint(output(), options);
  checkpoint.work(numbers.work(), {});
  EXPECT_EQ(numbers.values(), expected_);
  EXPECT_FALSE(fs::exists(file()));
  checkpoint.remove();
  EXPECT_EQ(said_, "");
}

TEST_F(WorkCheckpointTest, ATornRecordIsComputedAgain) {
  kill_after(17);
  const std::string whole = contents();
  for (const std::size_t lost : {std::size_t{1}, std::size_t{20}, std::size_t{51}}) {
    write(whole.substr(0, whole.size() - lost));
    EXPECT_EQ(finish(), Numbers::kBlocks - 16) << lost;
  }
}

TEST_F(WorkCheckpointTest, ADamagedRecordAndAllBehindItAreComputedAgain) {
  kill_after(17);
  std::string bytes = contents();
  const std::size_t record = 24 + 24 + 4;
  bytes[bytes.size() - 2 * record + 30] ^= 1;
  write(bytes);
  EXPECT_EQ(finish(), Numbers::kBlocks - 15);
}

TEST_F(WorkCheckpointTest, BlocksOfOtherInputsAreNotUsed) {
  kill_after(17, 2);
  EXPECT_EQ(finish(), Numbers::kBlocks);
  EXPECT_NE(said_.find("belong to other inputs"), std::string::npos) << said_;
}

TEST_F(WorkCheckpointTest, BlocksOfWorkThatFollowsStayWhenWorkThatWasNotKeptIsWritten) {
  kill_after(17, 2);
  {
    Numbers first(1), second(2);
    WorkCheckpoint checkpoint(output(), at_once());
    checkpoint.work(first.work(), {});
    EXPECT_EQ(first.computed, Numbers::kBlocks);
    checkpoint.work(second.work(), {});
    EXPECT_LT(second.computed, Numbers::kBlocks);
    checkpoint.remove();
  }
  EXPECT_NE(said_.find("blocks of the test are taken from"), std::string::npos) << said_;
  EXPECT_FALSE(fs::exists(file()));
}

TEST_F(WorkCheckpointTest, BlocksOfAnotherVersionAreNotUsed) {
  kill_after(17);
  std::string bytes = contents();
  ASSERT_EQ(bytes[23], '1');
  bytes[23] = '2';
  write(bytes);
  EXPECT_EQ(finish(), Numbers::kBlocks);
}

TEST_F(WorkCheckpointTest, ABlockThatIsThereTwiceCountsOnce) {
  kill_after(17);
  const std::string bytes = contents();
  const std::size_t record = 24 + 24 + 4;
  write(bytes + bytes.substr(bytes.size() - record));
  EXPECT_EQ(finish(), Numbers::kBlocks - 17);
  EXPECT_NE(said_.find("17 of 40 blocks"), std::string::npos) << said_;
}

TEST_F(WorkCheckpointTest, AFileOfSomebodyElseStays) {
  write("shopping list");
  Numbers numbers;
  WorkCheckpoint checkpoint(output(), at_once());
  EXPECT_THROW(checkpoint.work(numbers.work(), {}), InputError);
  EXPECT_EQ(contents(), "shopping list");
}

TEST_F(WorkCheckpointTest, ASecondJobIsRefusedAndTheFirstGoesOn) {
  Numbers first, second;
  WorkCheckpoint checkpoint(output(), at_once());
  NumberedWork work = first.work();
  work.threads = 1;
  work.finished = [&](std::size_t block) {
    if (block != 20) return;
    WorkCheckpoint other(output(), at_once());
    try {
      other.work(second.work(), {});
      ADD_FAILURE() << "not refused";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("another process"), std::string::npos) << error.what();
    }
  };
  checkpoint.work(work, {});
  EXPECT_EQ(first.values(), expected_);
  EXPECT_EQ(second.computed, 0u);
}

TEST_F(WorkCheckpointTest, AFullDiskEndsTheWorkAndWholeBlocksStay) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit small = before;
  small.rlim_cur = 25 + 12 * 52 + 7;  // within a record
  setrlimit(RLIMIT_FSIZE, &small);
  {
    Numbers numbers;
    WorkCheckpoint checkpoint(output(), at_once());
    EXPECT_THROW(checkpoint.work(numbers.work(), {}), InputError);
  }
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(contents().size(), 25u + 12 * 52);
  EXPECT_EQ(finish(), Numbers::kBlocks - 12);
}

TEST_F(WorkCheckpointTest, SeveralListsShareAFile) {
  {
    Numbers one(1), two(2);
    two.killed_after = 5;
    WorkCheckpoint checkpoint(output(), at_once());
    checkpoint.work(one.work(), {});
    NumberedWork work = two.work();
    work.threads = 1;
    EXPECT_THROW(checkpoint.work(work, {}), Killed);
  }
  Numbers one(1), two(2);
  WorkCheckpoint checkpoint(output(), at_once());
  checkpoint.work(one.work(), {});
  checkpoint.work(two.work(), {});
  EXPECT_EQ(one.computed, 0u);
  EXPECT_EQ(two.computed, Numbers::kBlocks - 5);
  EXPECT_EQ(one.values(), expected_);
}

}  // namespace
}  // namespace abbe
