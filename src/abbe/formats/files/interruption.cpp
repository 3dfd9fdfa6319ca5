#include "abbe/formats/files/interruption.h"

#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
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
  std::vector<pid_t> groups;
};

Unfinished& unfinished() {
  static auto* const all = new Unfinished;
  return *all;
}

/// What still runs would write again what is removed. Killed processes that nobody has waited for yet count as running,
/// so the wait has an end.
void kill_groups(const std::vector<pid_t>& groups) {
  for (const pid_t group : groups) {
    ::kill(-group, SIGKILL);
    for (int i = 0; i < 100 && ::kill(-group, 0) == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
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
    kill_groups(all.groups);
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

UnfinishedProcesses::UnfinishedProcesses(pid_t group) : group_(group) {
  const std::lock_guard<std::mutex> lock(unfinished().list);
  unfinished().groups.push_back(group_);
}

UnfinishedProcesses::~UnfinishedProcesses() {
  const std::lock_guard<std::mutex> lock(unfinished().list);
  std::vector<pid_t>& groups = unfinished().groups;
  const auto found = std::find(groups.begin(), groups.end(), group_);
  if (found != groups.end()) groups.erase(found);
}

}  // namespace abbe
