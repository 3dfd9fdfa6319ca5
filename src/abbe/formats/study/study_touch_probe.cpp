#include <tuple>

#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/study/study_quantity.h"
#include "abbe/instruments/touch_probe.h"

namespace abbe {
namespace {

SetupNumber read_radius(TomlTable& table, std::string_view base, bool simulated, double otherwise) {
  const SetupNumber radius = read_setup_number(table, base, Quantity::length, Knowledge::exact, simulated, otherwise);
  if (!(radius.value > 0)) table.fail_quantity(base, Quantity::length, "is not above zero", "a radius");
  return radius;
}

TouchProbeSetup::Placement read_placement(TomlTable& table, bool simulated) {
  TouchProbeSetup::Placement placement;
  placement.name = table.text("name");
  placement.position = read_setup_point(table, "position", Knowledge::open, simulated);
  const std::string_view names[] = {"a", "b", "c"};
  for (std::size_t i = 0; i < 3; ++i) {
    placement.angles.coordinate[i] =
        read_setup_number(table, names[i], Quantity::angle, Knowledge::open, simulated, 0.0);
  }
  table.finish();
  return placement;
}

}  // namespace

std::shared_ptr<Instrument> read_touch_probe(TomlTable& table, const InstrumentContext& context) {
  TouchProbeSetup setup;
  setup.name = context.name;
  setup.measure = static_cast<TouchProbeSetup::Measure>(table.word_or("measure", 0, {"centre", "touch"}));
  setup.frame = static_cast<TouchProbeSetup::Frame>(table.word_or("frame", 0, {"probe", "artefact"}));
  std::tie(setup.probe_body, setup.artefact_body) =
      read_bodies(table, {"probe_on", Body::tool}, {"artefact_on", Body::workpiece});
  setup.tip = read_setup_point(table, "tip", Knowledge::exact, context.simulated);
  setup.tip_radius = read_radius(table, "tip_radius", context.simulated, 3);
  setup.scale =
      read_setup_number(table, "scale", Quantity::length_per_length, Knowledge::exact, context.simulated, 0.0);
  TomlTable noise = table.table("noise");
  setup.noise =
      read_noise(noise, setup.measure == TouchProbeSetup::Measure::centre ? "centre" : "travel", Quantity::length);
  noise.finish();
  for (TomlTable& entry : table.tables("placement")) {
    setup.placements.push_back(read_placement(entry, context.simulated));
  }
  // In an artefact that is put somewhere the spheres are the known part; without one they stand where they stand.
  const Knowledge unstated = setup.placements.empty() ? Knowledge::open : Knowledge::exact;
  for (TomlTable& entry : table.tables("sphere")) {
    TouchProbeSetup::Sphere sphere;
    sphere.name = entry.text("name");
    sphere.centre = read_setup_point(entry, "centre", unstated, context.simulated);
    sphere.radius = read_radius(entry, "radius", context.simulated, 12.5);
    entry.finish();
    setup.spheres.push_back(sphere);
  }
  if (setup.spheres.empty()) {
    table.fail("", "the spheres are missing", "[[setup.sphere]] with name and centre_mm = [x, y, z]");
  }
  return std::make_shared<TouchProbe>(setup);
}

}  // namespace abbe
