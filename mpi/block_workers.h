#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "abbe/geometry/numbered_work.h"

namespace abbe {

/// Threads that compute blocks of numbered work, while the thread that owns this sends and receives.
class BlockWorkers {
 public:
  explicit BlockWorkers(const NumberedWork& work);
  /// Ends when the blocks that are being computed are.
  ~BlockWorkers();
  BlockWorkers(const BlockWorkers&) = delete;
  BlockWorkers& operator=(const BlockWorkers&) = delete;

  std::size_t threads() const { return threads_.size(); }
  void add(std::size_t block);
  /// Blocks that were added and that no thread has begun.
  std::size_t waiting() const;
  /// True if finished() has returned all blocks that were added, so that there is nothing to wait for.
  bool is_idle() const;
  /// Blocks that were finished since the last call; waits for one, but not longer. Rethrows what a block has thrown.
  std::vector<std::size_t> finished(std::chrono::microseconds wait);

 private:
  void run();

  const NumberedWork& work_;
  mutable std::mutex mutex_;
  std::condition_variable added_, done_;
  std::deque<std::size_t> blocks_;
  std::vector<std::size_t> finished_;
  std::size_t unfinished_ = 0;  // blocks added that finished() has not returned yet
  std::exception_ptr failure_;
  bool ends_ = false;
  std::vector<std::jthread> threads_;
};

}  // namespace abbe
