#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/machine/machine_file.h"

namespace abbe::benchmarks {

inline Machine machine_of_tracker_csv() {
  return parse_machine(
      "name = \"m\"\nchain = \"w C' X' b Z t\"\n[axis.C]\nendless = true\n[axis.X]\ntravel_mm = [0, 1400]\n"
      "[axis.Z]\ntravel_mm = [0, 600]\n",
      "machine");
}

/// A file like those of a laser tracker: three commands, a reflector, its offset, the measured point.
inline void write_tracker_csv(const std::string& path, int rows) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  std::fputs("X_mm,Z_mm,C_deg,reflector,measured_x_mm,measured_y_mm,measured_z_mm\n", file);
  RandomStream random(1);
  for (int i = 0; i < rows; ++i) {
    const std::string line = fmt::format("{:.9f},{:.9f},{},T{},{:.9f},{:.9f},{:.9f}\n", random.uniform(0, 1400),
                                         random.uniform(0, 600), 5 * (i % 72), 1 + i % 3, random.uniform(-1000, 1000),
                                         random.uniform(-1000, 1000), random.uniform(-1000, 1000));
    std::fputs(line.c_str(), file);
  }
  std::fclose(file);
}

}  // namespace abbe::benchmarks
