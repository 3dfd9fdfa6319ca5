#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>

#include "abbe/geometry/stopped.h"

namespace abbe {

/// What a job that takes long is done with besides its request.
struct JobOptions {
  /// Called during the job: done of total. What is counted, and by which thread it is called, is stated at each job.
  std::function<void(std::size_t done, std::size_t total)> progress{};
  std::stop_token stop{};  ///< looked at whenever progress is told
};

/// For the work of a job to call with what is done: stops it where that was asked for, then tells the progress.
inline std::function<void(std::size_t done, std::size_t total)> stoppable_progress(const JobOptions& options) {
  return [options](std::size_t done, std::size_t total) {
    stop_if_asked(options.stop);
    if (options.progress) options.progress(done, total);
  };
}

}  // namespace abbe
