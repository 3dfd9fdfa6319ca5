// Study files of a fixed machine: any bytes give a study or an InputError.
#include <cstddef>
#include <cstdint>
#include <string>

#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/input_error.h"
#include "fuzz_machine_data.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const abbe::Machine machine = fuzz_machine();
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    abbe::parse_study(text, "no-folder/fuzz.study.toml", machine);
  } catch (const abbe::InputError&) {
  }
  return 0;
}
