#include "bindings/job.h"

#include <nanobind/stl/string.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

namespace abbe::python {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{50};

struct Report {
  std::string step;
  std::size_t done = 0, total = 0;
  bool operator==(const Report&) const = default;
};

/// What the thread that works and the one that waits have in common.
struct Shared {
  std::mutex mutex;
  std::condition_variable changed;
  Report report;
  bool has_report = false, finished = false;
};

/// Waits until the work is done or it is time to look again. @return whether it is done; `report` if there is a new one
bool wait_for(Shared& shared, std::optional<Report>& report) {
  const nb::gil_scoped_release release;
  std::unique_lock lock(shared.mutex);
  shared.changed.wait_for(lock, kBetweenLooks, [&] { return shared.finished; });
  if (shared.has_report) report = shared.report;
  shared.has_report = false;
  return shared.finished;
}

}  // namespace

void run_job(const nb::object& progress, const std::function<void(const JobControl&)>& work) {
  Shared shared;
  std::exception_ptr failure;
  std::jthread worker([&](const std::stop_token& stop) {
    const auto report = [&](const char* step, std::size_t done, std::size_t total) {
      const std::scoped_lock lock(shared.mutex);
      shared.report = {step, done, total};
      shared.has_report = true;
    };
    try {
      work({report, stop});
    } catch (...) {
      failure = std::current_exception();
    }
    const std::scoped_lock lock(shared.mutex);
    shared.finished = true;
    shared.changed.notify_one();
  });

  std::exception_ptr interruption;
  const auto tell = [&](const std::optional<Report>& report) {
    if (interruption) return;
    try {
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      if (report && !progress.is_none()) progress(report->step, report->done, report->total);
    } catch (nb::python_error& error) {
      if (!error.matches(PyExc_StopIteration)) interruption = std::current_exception();
      worker.request_stop();
    }
  };
  for (bool finished = false; !finished;) {
    std::optional<Report> report;
    finished = wait_for(shared, report);
    tell(report);
  }
  {
    const nb::gil_scoped_release release;
    worker.join();
  }
  if (interruption) std::rethrow_exception(interruption);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace abbe::python
