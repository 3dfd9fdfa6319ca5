// Readings of an instrument with items, inputs, lengths and angles: any bytes give readings that fit the instrument, or
// an InputError; what was read is written and read back.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>

#include "abbe/formats/readings/instrument_file.h"
#include "abbe/formats/text/input_error.h"
#include "fuzz_machine_data.h"

namespace {

/// Two items, a length and an angle, one known length with every reading.
class AnyInstrument : public abbe::Instrument {
 public:
  AnyInstrument() : Instrument("any") {
    components_ = {{"length", false}, {"pitch", true}};
    inputs_ = {{"depth", false}};
    add(abbe::InstrumentItem{"A", abbe::Body::tool, abbe::Body::workpiece, {}});
    add(abbe::InstrumentItem{"B", abbe::Body::tool, abbe::Body::bed, {}});
  }
  void model(const abbe::ItemBlock&, const abbe::ModelledBlock&) const override {}
  double standard_uncertainty(const abbe::InstrumentReadings&, std::size_t, std::size_t) const override { return 1; }
  std::shared_ptr<const abbe::Instrument> with_values(const std::vector<double>&) const override { return nullptr; }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const abbe::Machine machine = fuzz_machine();
  static const AnyInstrument instrument;
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const abbe::InstrumentReadings readings =
        abbe::parse_instrument_readings(text, "fuzz.csv", machine, instrument, {.mapping = {}, .threads = 1});
    if (readings.count() == 0) return 0;
    abbe::check_readings(machine, instrument, readings);
    const std::string written = abbe::instrument_readings_text(machine, instrument, readings);
    const abbe::InstrumentReadings back =
        abbe::parse_instrument_readings(written, "written.csv", machine, instrument, {.mapping = {}, .threads = 1});
    if (back.count() != readings.count() || back.measured[0] != readings.measured[0]) std::abort();
  } catch (const abbe::InputError&) {
  }
  return 0;
}
