#include "abbe/formats/files/checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/files/unfinished_output.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(CheckpointOfAJob, IsFoundByTheSameJobOnly) {
  const fs::path output = test::empty_folder("abbe_checkpoint") / "new" / "out", file = unfinished_name(output);
  const CheckpointFacts facts{{"scan", "12 bytes"}, {"part", "3"}};
  { const Checkpoint nothing(output, facts); }
  EXPECT_FALSE(fs::exists(file));
  {
    Checkpoint job(output, facts);
    EXPECT_EQ(job.found(), "");
    job.save("first");
    job.save(std::string("second\0\n\n", 9));
    EXPECT_THAT(message_of([&] { Checkpoint second(output, facts); }), HasSubstr("another process works on"));
  }
  EXPECT_THAT(message_of([&] {
                Checkpoint other(output, {{"scan", "13 bytes"}, {"part", "3"}});
              }),
              HasSubstr("is the checkpoint of another job: it has 'scan: 12 bytes', not 'scan: 13 bytes'"));
  Checkpoint again(output, facts);
  EXPECT_EQ(again.found(), std::string("second\0\n\n", 9));
  again.remove();
  EXPECT_FALSE(fs::exists(file));
}

TEST(CheckpointOfAJob, ThatIsDamagedIsRefused) {
  const fs::path output = test::empty_folder("abbe_checkpoint_damaged") / "out", file = unfinished_name(output);
  const CheckpointFacts facts{{"scan", "12 bytes"}};
  { Checkpoint(output, facts).save("state"); }
  std::fstream(file, std::ios::in | std::ios::out).seekp(-6, std::ios::end) << "X";
  EXPECT_THAT(message_of([&] { Checkpoint damaged(output, facts); }), HasSubstr("or is damaged"));
  EXPECT_TRUE(fs::exists(file));
}

}  // namespace
}  // namespace abbe
