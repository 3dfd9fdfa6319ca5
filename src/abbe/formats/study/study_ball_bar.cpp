#include <tuple>

#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/study/study_quantity.h"
#include "abbe/instruments/ball_bar.h"

namespace abbe {

std::shared_ptr<Instrument> read_ball_bar(TomlTable& table, const InstrumentContext& context) {
  BallBarSetup setup;
  setup.name = context.name;
  std::tie(setup.spindle_body, setup.table_body) =
      read_bodies(table, {"spindle_ball_on", Body::tool}, {"balls_on", Body::workpiece});
  setup.spindle_ball = read_setup_point(table, "spindle_ball", Knowledge::exact, context.simulated);
  setup.length_deviation =
      read_setup_number(table, "length_deviation", Quantity::length, Knowledge::exact, context.simulated, 0.0);
  TomlTable noise = table.table("noise");
  setup.noise = read_noise(noise, "length", Quantity::length);
  setup.noise_per_length = noise.size_or("length", Quantity::length_per_length, 0);
  noise.finish();
  setup.balls = read_named_points(table, "ball", Knowledge::open, context.simulated);
  return std::make_shared<BallBar>(setup);
}

}  // namespace abbe
