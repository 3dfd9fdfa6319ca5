#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>

#include "abbe/geometry/numbered_work.h"
#include "abbe/geometry/stopped.h"
#include "abbe/geometry/work_in_step.h"

namespace abbe {

/// Options of a long job, besides its request.
struct JobOptions {
  /// Called during the job with the work done and its total. Each job states what is counted and which thread calls.
  std::function<void(std::size_t done, std::size_t total)> progress{};
  std::stop_token stop{};  ///< checked whenever progress is reported
  /// Who does the numbered work of a job; empty: this process. Jobs that have none do not use it.
  WorkDriver work{};
  WorkInStep in_step{};  ///< processes that do the same job; jobs that have no such work do not use it
};

/// A callback for the work of a job: stops it if that was requested, otherwise reports the progress.
inline std::function<void(std::size_t done, std::size_t total)> stoppable_progress(const JobOptions& options) {
  return [options](std::size_t done, std::size_t total) {
    stop_if_asked(options.stop);
    if (options.progress) options.progress(done, total);
  };
}

}  // namespace abbe
