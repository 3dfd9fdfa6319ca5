#include <tuple>

#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/study/study_quantity.h"
#include "abbe/formats/text/toml_vector.h"
#include "abbe/instruments/grid_encoder.h"

namespace abbe {

std::shared_ptr<Instrument> read_grid_encoder(TomlTable& table, const InstrumentContext& context) {
  const bool simulated = context.simulated;
  GridEncoderSetup setup;
  setup.name = context.name;
  std::tie(setup.head_body, setup.grid_body) =
      read_bodies(table, {"head_on", Body::tool}, {"grid_on", Body::workpiece});
  setup.head = read_setup_point(table, "head", Knowledge::exact, simulated);
  setup.scale_x = read_setup_number(table, "scale_x", Quantity::length_per_length, Knowledge::exact, simulated, 0.0);
  setup.scale_y = read_setup_number(table, "scale_y", Quantity::length_per_length, Knowledge::exact, simulated, 0.0);
  setup.squareness = read_setup_number(table, "squareness", Quantity::angle, Knowledge::exact, simulated, 0.0);
  if (!context.noise_from_data) {
    TomlTable noise = table.table("noise");
    setup.noise = read_noise(noise, "xy", Quantity::length);
    setup.noise_per_length = noise.size_or("xy", Quantity::length_per_length, 0);
    noise.finish();
  }
  for (TomlTable& entry : table.tables("placement")) {
    GridEncoderSetup::Placement placement;
    placement.name = entry.text("name");
    placement.position = vector_of(entry.numbers("position", Quantity::length, 3));
    placement.shift_x = read_setup_number(entry, "shift_x", Quantity::length, Knowledge::open, simulated, 0.0);
    placement.shift_y = read_setup_number(entry, "shift_y", Quantity::length, Knowledge::open, simulated, 0.0);
    // A tilt of the plate is read to second order only.
    placement.angles = {read_setup_number(entry, "a", Quantity::angle, Knowledge::exact, simulated, 0.0),
                        read_setup_number(entry, "b", Quantity::angle, Knowledge::exact, simulated, 0.0),
                        read_setup_number(entry, "c", Quantity::angle, Knowledge::open, simulated, 0.0)};
    entry.finish();
    setup.placements.push_back(placement);
  }
  if (setup.placements.empty()) {
    table.fail("", "it is not said where the grid is", "[[setup.placement]] with name and position_mm = [x, y, z]");
  }
  return std::make_shared<GridEncoder>(setup);
}

}  // namespace abbe
