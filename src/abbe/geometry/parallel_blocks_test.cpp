#include "abbe/geometry/parallel_blocks.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace abbe {
namespace {

TEST(ParallelBlocks, RunsEveryBlockOnce) {
  for (int threads : {0, 1, 2, 5}) {
    std::vector<std::atomic<int>> runs(1000);
    for_each_block(runs.size(), threads, [&](std::size_t block) { ++runs[block]; });
    for (const std::atomic<int>& count : runs) EXPECT_EQ(count, 1);
  }
}

TEST(ParallelBlocks, PassesAnExceptionOn) {
  EXPECT_THROW(for_each_block(100, 3,
                              [](std::size_t block) {
                                if (block == 40) throw std::runtime_error("block 40");
                              }),
               std::runtime_error);
}

}  // namespace
}  // namespace abbe
