#pragma once

// Long work: the GIL is free meanwhile, progress comes to a Python function, Ctrl-C stops it.
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "abbe/study/job_options.h"
#include "bindings/bindings.h"

namespace abbe::python {

/// What a job reports and is stopped by; progress() may be called from any thread.
struct JobControl {
  std::function<void(const char* step, std::size_t done, std::size_t total)> progress;
  std::stop_token stop;

  /// For jobs that have one step.
  JobOptions options(const char* step) const {
    return {.progress = [report = progress, step](std::size_t done, std::size_t total) { report(step, done, total); },
            .stop = stop};
  }
};

/// Runs work(control) in a thread of its own while this one waits without the GIL, calls `progress` from time to time,
/// and looks for signals. Exceptions of the work are rethrown here; where the function of Python raises one, or Ctrl-C
/// does, the work is stopped and that is what is raised.
/// @param progress  None, or a function of the step's name, the amount done and the total; StopIteration ends the work
void run_job(const nb::object& progress, const std::function<void(const JobControl&)>& work);

/// The same with a result.
template <class Work>
auto job_result(const nb::object& progress, const Work& work) {
  std::optional<decltype(work(std::declval<const JobControl&>()))> result;
  run_job(progress, [&](const JobControl& control) { result.emplace(work(control)); });
  return std::move(*result);
}

/// work(stop) as a job without progress.
template <class Work>
auto stoppable_result(const Work& work) {
  return job_result(nb::none(), [&](const JobControl& control) { return work(control.stop); });
}

}  // namespace abbe::python
