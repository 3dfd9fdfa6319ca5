// Peak memory of an identification from many readings; a program of its own, because a peak cannot be taken back.
//
//   identification_memory [readings]     exit code 1 at 1 GiB or more
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "abbe/identify/identify.h"
#include "identification_case.h"

namespace {

double peak_memory_mib() {
  std::ifstream file("/proc/self/status");
  std::string word;
  while (file >> word)
    if (word == "VmHWM:") {
      double kib = 0;
      file >> kib;
      return kib / 1024;
    }
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  const std::size_t readings = count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 1000000;
  std::unique_ptr<abbe::TrackerObservations> observed;
  abbe::Problem problem;
  {
    const abbe::benchmark_case::XcfzCase data(readings);
    observed = data.observations();
    problem = data.problem(*observed);
  }
  const double before = peak_memory_mib();
  const auto start = std::chrono::steady_clock::now();
  const abbe::Identification result = abbe::identify(problem);
  const double time = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("%zu readings: %s in %.2f s; peak memory %.0f MiB, of that %.0f MiB before the identification\n",
              readings, result.message.c_str(), time, peak_memory_mib(), before);
  return result.status == abbe::IdentifyStatus::converged && peak_memory_mib() < 1024 ? 0 : 1;
}
