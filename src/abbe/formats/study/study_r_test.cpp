#include <tuple>

#include "abbe/formats/study/study_direction.h"
#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/study/study_quantity.h"
#include "abbe/instruments/r_test.h"

namespace abbe {
namespace {

constexpr std::size_t kMostProbes = 4;

RTestSetup::Probe read_probe(TomlTable& table, bool simulated) {
  RTestSetup::Probe probe;
  probe.name = table.text("name");
  probe.direction = read_direction(table, "direction");
  probe.tilt_first = read_setup_number(table, "tilt_first", Quantity::angle, Knowledge::exact, simulated, 0.0);
  probe.tilt_second = read_setup_number(table, "tilt_second", Quantity::angle, Knowledge::exact, simulated, 0.0);
  probe.zero = read_setup_number(table, "zero", Quantity::length, Knowledge::exact, simulated, 0.0);
  probe.tip = static_cast<RTestSetup::Tip>(table.word_or("tip", 0, {"flat", "ball"}));
  if (probe.tip == RTestSetup::Tip::ball) {
    probe.tip_radius = table.size_or("tip_radius", Quantity::length, 0);
    probe.offset_first = read_setup_number(table, "offset_first", Quantity::length, Knowledge::exact, simulated, 0.0);
    probe.offset_second = read_setup_number(table, "offset_second", Quantity::length, Knowledge::exact, simulated, 0.0);
  }
  table.finish();
  return probe;
}

}  // namespace

std::shared_ptr<Instrument> read_r_test(TomlTable& table, const InstrumentContext& context) {
  RTestSetup setup;
  setup.name = context.name;
  std::tie(setup.nest_body, setup.sphere_body) =
      read_bodies(table, {"nest_on", Body::workpiece}, {"spheres_on", Body::tool});
  setup.nest = read_setup_point(table, "nest", Knowledge::open, context.simulated);
  setup.sphere_radius =
      read_setup_number(table, "sphere_radius", Quantity::length, Knowledge::exact, context.simulated, 11.0);
  if (!(setup.sphere_radius.value > 0)) {
    table.fail_quantity("sphere_radius", Quantity::length, "is not above zero", "the radius of the sphere");
  }
  TomlTable noise = table.table("noise");
  setup.noise = read_noise(noise, "indication", Quantity::length);
  noise.finish();
  for (TomlTable& entry : table.tables("probe")) setup.probes.push_back(read_probe(entry, context.simulated));
  if (setup.probes.empty() || setup.probes.size() > kMostProbes) {
    table.fail("", "the nest has no probes or too many", "one to four [[setup.probe]] with name and direction");
  }
  setup.spheres = read_named_points(table, "sphere", Knowledge::exact, context.simulated);
  return std::make_shared<RTest>(setup);
}

}  // namespace abbe
