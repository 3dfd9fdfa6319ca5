#include "block_workers.h"

#include <utility>

#include "abbe/geometry/parallel_blocks.h"

namespace abbe {

BlockWorkers::BlockWorkers(const NumberedWork& work) : work_(work) {
  int count = 1;
  if (work.in_parallel) count = work.threads > 0 ? work.threads : default_thread_count();
  for (int i = 0; i < count; ++i) threads_.emplace_back([this] { run(); });
}

BlockWorkers::~BlockWorkers() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  added_.notify_all();
  threads_.clear();
}

void BlockWorkers::add(std::size_t block) {
  {
    const std::lock_guard lock(mutex_);
    blocks_.push_back(block);
    ++unfinished_;
  }
  added_.notify_one();
}

std::size_t BlockWorkers::waiting() const {
  const std::lock_guard lock(mutex_);
  return blocks_.size();
}

bool BlockWorkers::is_idle() const {
  const std::lock_guard lock(mutex_);
  return unfinished_ == 0 && failure_ == nullptr;
}

std::vector<std::size_t> BlockWorkers::finished(std::chrono::microseconds wait) {
  std::unique_lock lock(mutex_);
  done_.wait_for(lock, wait, [this] { return failure_ != nullptr || !finished_.empty(); });
  if (failure_) std::rethrow_exception(failure_);
  unfinished_ -= finished_.size();
  return std::exchange(finished_, {});
}

void BlockWorkers::run() {
  for (;;) {
    std::unique_lock lock(mutex_);
    added_.wait(lock, [this] { return ends_ || !blocks_.empty(); });
    if (ends_) return;
    const std::size_t block = blocks_.front();
    blocks_.pop_front();
    lock.unlock();
    std::exception_ptr failure;
    try {
      work_.compute(block);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure) {
      failure_ = failure;
      ends_ = true;
    } else {
      finished_.push_back(block);
    }
    done_.notify_one();
  }
}

}  // namespace abbe
