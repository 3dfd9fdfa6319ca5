#pragma once

#include "abbe/formats/machine/machine_file.h"

/// Machine whose errors, studies and measurements are fuzzed.
inline abbe::Machine fuzz_machine() {
  return abbe::parse_machine(
      "name = \"m\"\nchain = \"w C' X' b Z t\"\n[axis.C]\nendless = true\n[axis.X]\ntravel_mm = [0, 1400]\n"
      "[axis.Z]\ntravel_mm = [0, 600]\n",
      "fuzz");
}
