// Reading a measurement file of 1,000,000 rows: the reader of the product against std::ifstream, std::getline and
// std::stod in the same run. The file is in the page cache, so that what is measured is the reading.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "abbe/formats/readings/measurement_file.h"
#include "tracker_csv.h"

namespace {

constexpr int kRows = 1'000'000;

const std::string& measurement_file() {
  static const std::string path = [] {
    const std::string name = (std::filesystem::temp_directory_path() / "abbe_read_csv.csv").string();
    abbe::benchmarks::write_tracker_csv(name, kRows);
    return name;
  }();
  return path;
}

void count_bytes(benchmark::State& state) {
  const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(measurement_file()));
  state.SetBytesProcessed(state.iterations() * bytes);
  state.SetItemsProcessed(state.iterations() * kRows);
}

void plain_streams(benchmark::State& state) {
  const std::string& path = measurement_file();
  for (auto _ : state) {
    std::vector<double> columns[6];
    std::vector<std::string> reflector;
    std::ifstream file(path);
    std::string line, field;
    std::getline(file, line);
    while (std::getline(file, line)) {
      std::istringstream fields(line);
      for (int i = 0, column = 0; std::getline(fields, field, ','); ++i) {
        if (i == 3) {
          reflector.push_back(field);
        } else {
          columns[column++].push_back(std::stod(field));
        }
      }
    }
    if (columns[5].size() != kRows) state.SkipWithError("rows lost");
    benchmark::DoNotOptimize(columns);
  }
  count_bytes(state);
}

void abbe_reader(benchmark::State& state) {
  const std::string& path = measurement_file();
  const abbe::Machine m = abbe::benchmarks::machine_of_tracker_csv();
  abbe::MeasurementOptions options;
  options.threads = static_cast<int>(state.range(0));
  for (auto _ : state) {
    const abbe::MeasurementTable table = abbe::read_measurements(path, m, options);
    if (table.readings.count() != kRows) state.SkipWithError("rows lost");
    benchmark::DoNotOptimize(table.readings.measured[2].data());
  }
  count_bytes(state);
}

}  // namespace

BENCHMARK(plain_streams)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(abbe_reader)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

BENCHMARK_MAIN();
