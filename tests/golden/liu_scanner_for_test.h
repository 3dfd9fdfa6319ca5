#pragma once

#include <string>

#include "abbe/formats/machine/machine_file.h"

namespace abbe {

inline Machine liu_scanner() {
  return read_machine(std::string(ABBE_SOURCE_DIR "/examples/machines/liu-scanner.machine.toml"));
}

}  // namespace abbe
