// Measurement files of a fixed machine: any bytes give a table or an InputError; a table reads back as the same table.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/text/input_error.h"
#include "fuzz_machine_data.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const abbe::Machine machine = fuzz_machine();
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  abbe::MeasurementOptions options;
  options.threads = 1;
  options.mapping.columns = {{"X_mm", "x"}};
  options.mapping.ignore = {"remark"};
  for (const bool mapped : {true, false}) {
    if (!mapped) options.mapping = {};
    abbe::MeasurementTable table;
    try {
      table = abbe::parse_measurements(text, "fuzz.csv", machine, options);
    } catch (const abbe::InputError&) {
      continue;
    }
    abbe::MeasurementOptions plain;
    plain.threads = 1;
    const abbe::MeasurementTable back =
        abbe::parse_measurements(abbe::measurements_text(machine, table), "written.csv", machine, plain);
    if (back.readings.count() != table.readings.count() ||
        back.readings.poses.axis[1] != table.readings.poses.axis[1] || back.reflectors != table.reflectors ||
        back.stations != table.stations) {
      std::abort();
    }
  }
  return 0;
}
