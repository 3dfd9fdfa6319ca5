// Machine files: any bytes give a machine or an InputError, and a machine reads back from its own text.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/input_error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  abbe::Machine machine;
  try {
    machine = abbe::parse_machine(text, "fuzz.machine.toml");
  } catch (const abbe::InputError&) {
    return 0;
  }
  const std::string written = abbe::machine_text(machine);
  const abbe::Machine back = abbe::parse_machine(written, "written.machine.toml");
  if (back.chain() != machine.chain() || back.tool_offset != machine.tool_offset) std::abort();
  return 0;
}
