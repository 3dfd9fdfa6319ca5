#include "abbe/formats/files/interruption.h"

#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <thread>
#include <vector>

#include "abbe/formats/files/remove_unfinished.h"

namespace abbe {
namespace {

/// Never destroyed: the waiting thread may use it until the process is gone.
struct Unfinished {
  std::mutex steps;  ///< held while files are made, renamed or removed
  std::mutex list;
  std::vector<std::filesystem::path> paths;
};

Unfinished& unfinished() {
  static auto* const all = new Unfinished;
  return *all;
}

sigset_t signals_of_interruption() {
  sigset_t set;
  ::sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before = {};
    // A blocked signal would be received even if whoever started this had it ignored.
    if (::sigaction(signal, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) ::sigaddset(&set, signal);
  }
  return set;
}

}  // namespace

void end_cleanly_when_interrupted(std::function<void(int signal)> before) {
  unfinished();
  const sigset_t set = signals_of_interruption();
  // Threads inherit the mask, so that only the one below receives them.
  if (::pthread_sigmask(SIG_BLOCK, &set, nullptr) != 0) return;
  std::thread([set, before = std::move(before)] {
    int signal = 0;
    while (::sigwait(&set, &signal) != 0) {
    }
    Unfinished& all = unfinished();
    // Kept to the end: nobody makes another file.
    all.steps.lock();
    if (before) before(signal);
    all.list.lock();
    for (const std::filesystem::path& path : all.paths) remove_unfinished(path);
    ::_exit(128 + signal);
  }).detach();
}

UninterruptedSteps::UninterruptedSteps() : held_(unfinished().steps) {}

UnfinishedPath::UnfinishedPath(const std::filesystem::path& path) : path_(std::filesystem::absolute(path)) {
  const std::lock_guard<std::mutex> lock(unfinished().list);
  unfinished().paths.push_back(path_);
}

UnfinishedPath::~UnfinishedPath() {
  const std::lock_guard<std::mutex> lock(unfinished().list);
  std::vector<std::filesystem::path>& paths = unfinished().paths;
  const auto found = std::find(paths.begin(), paths.end(), path_);
  if (found != paths.end()) paths.erase(found);
}

}  // namespace abbe
