#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

namespace abbe::benchmarks {

/// Keeps the shortest time per item of all repetitions: what the machine can do when others leave it alone.
class FastestReporter : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration) continue;
      const double seconds = 1.0 / run.counters.at("items_per_second").value;
      const auto [place, inserted] = fastest.emplace(run.run_name.function_name, seconds);
      if (!inserted) place->second = std::min(place->second, seconds);
      if (!(run.real_accumulated_time > 0) || !(run.cpu_accumulated_time > 0)) continue;
      const double rated = run.run_name.time_type.empty() ? run.cpu_accumulated_time : run.real_accumulated_time;
      const double cpu = seconds * run.cpu_accumulated_time / rated;
      const auto [own, first] = processor.emplace(run.run_name.function_name, cpu);
      if (!first) own->second = std::min(own->second, cpu);
    }
  }
  std::map<std::string, double> fastest;  ///< s per item
  /// s of the processor per item: of the first thread, or of all if the benchmark says MeasureProcessCPUTime. It does
  /// not count what other programs take, but what they throw out of the caches.
  std::map<std::string, double> processor;
};

/// Repetitions of all benchmarks in turn instead of one benchmark after the other: what is compared shares the
/// machine's good and bad moments.
inline void initialize(int argc, char** argv) {
  static char interleaved[] = "--benchmark_enable_random_interleaving=true";
  std::vector<char*> arguments(argv, argv + argc);
  arguments.insert(arguments.begin() + 1, interleaved);
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
}

/// One line of the result; says whether the target is met.
inline bool report(const char* what, double ratio, double target) {
  std::printf("%-58s %7.2f   target %5.1f   %s\n", what, ratio, target, ratio >= target ? "met" : "MISSED");
  return ratio >= target;
}

}  // namespace abbe::benchmarks
