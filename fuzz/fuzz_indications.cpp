// Files of indications: any bytes give a table or an InputError; a table reads back as the same table.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "abbe/formats/readings/indication_file.h"
#include "abbe/formats/text/input_error.h"
#include "fuzz_machine_data.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const abbe::Machine machine = fuzz_machine();
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  abbe::IndicationTable table;
  try {
    table = abbe::parse_indications(text, "fuzz.csv", machine, {.along_axis = 1e-5, .across_axis = 6e-4});
  } catch (const abbe::InputError&) {
    return 0;
  }
  // Two angles that differ in the last place may become one when written in degrees; lengths keep their bits.
  if (table.readings.kind == abbe::AxisKind::rotary) return 0;
  const abbe::IndicationTable back =
      abbe::parse_indications(abbe::indications_text(machine, table), "written.csv", machine);
  if (back.readings.positions != table.readings.positions || back.readings.indications != table.readings.indications ||
      back.readings.probes.size() != table.readings.probes.size()) {
    std::abort();
  }
  return 0;
}
