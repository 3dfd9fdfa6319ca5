// Errors files of a fixed machine: any bytes give errors or an InputError, and errors read back to the same bits.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/text/input_error.h"
#include "fuzz_machine_data.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const abbe::Machine machine = fuzz_machine();
  const std::string text(reinterpret_cast<const char*>(data), size);
  abbe::ErrorsFile contents;
  try {
    contents = abbe::parse_errors(text, "no-folder/fuzz.errors.toml", machine);
  } catch (const abbe::InputError&) {
    return 0;
  }
  const abbe::ErrorsFile back =
      abbe::parse_errors(abbe::errors_text(machine, contents), "written.errors.toml", machine);
  if (back.errors.motions != contents.errors.motions || back.errors.locations != contents.errors.locations)
    std::abort();
  return 0;
}
