#include "abbe/geometry/parallel_blocks.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace abbe {

namespace {

std::atomic<int> set_thread_count{0};

}  // namespace

int default_thread_count() {
  const int set = set_thread_count;
  return std::clamp(set > 0 ? set : static_cast<int>(std::thread::hardware_concurrency()), 1, 64);
}

void set_default_thread_count(int threads) { set_thread_count = threads; }

void for_each_block(std::size_t blocks, int threads, const std::function<void(std::size_t)>& work) {
  if (threads <= 0) threads = default_thread_count();
  threads = static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(threads), blocks));
  if (threads <= 1) {
    for (std::size_t block = 0; block < blocks; ++block) work(block);
    return;
  }
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto run = [&] {
    for (std::size_t block = next++; block < blocks; block = next++) {
      try {
        work(block);
      } catch (...) {
        const std::lock_guard lock(failure_mutex);
        if (!failure) failure = std::current_exception();
        next = blocks;
      }
    }
  };
  {
    std::vector<std::jthread> helpers;
    for (int i = 1; i < threads; ++i) helpers.emplace_back(run);
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace abbe
