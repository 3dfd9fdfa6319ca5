#include <tuple>

#include "abbe/formats/study/study_direction.h"
#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/study/study_quantity.h"
#include "abbe/instruments/surface_probe.h"

namespace abbe {
namespace {

SurfaceProbeSetup::Clamping read_clamping(TomlTable& table, SurfaceProbeSetup::Standard standard, bool simulated) {
  SurfaceProbeSetup::Clamping clamping;
  clamping.name = table.text("name");
  const std::vector<double> point = table.numbers("point", Quantity::length, 3);
  clamping.point = {point[0], point[1], point[2]};
  clamping.offset = read_setup_point(table, "offset", Knowledge::open, simulated, Eigen::Vector3d::Zero());
  if (standard != SurfaceProbeSetup::Standard::sphere) {
    clamping.direction = read_direction(table, "direction");
    clamping.tilt_first = read_setup_number(table, "tilt_first", Quantity::angle, Knowledge::open, simulated, 0.0);
    clamping.tilt_second = read_setup_number(table, "tilt_second", Quantity::angle, Knowledge::open, simulated, 0.0);
  }
  if (standard == SurfaceProbeSetup::Standard::cylinder) clamping.reversed = table.boolean_or("reversed", false);
  table.finish();
  return clamping;
}

}  // namespace

std::shared_ptr<Instrument> read_surface_probe(TomlTable& table, const InstrumentContext& context) {
  using Standard = SurfaceProbeSetup::Standard;
  SurfaceProbeSetup setup;
  setup.name = context.name;
  setup.standard = static_cast<Standard>(table.word("standard", {"cylinder", "sphere", "plane"}));
  std::tie(setup.probe_body, setup.standard_body) =
      read_bodies(table, {"probe_on", Body::tool}, {"standard_on", Body::workpiece});
  setup.zero = read_setup_point(table, "zero", Knowledge::exact, context.simulated, Eigen::Vector3d::Zero());
  setup.beam = read_direction(table, "beam", -Eigen::Vector3d::UnitZ());
  setup.beam_first = read_setup_number(table, "beam_first", Quantity::angle, Knowledge::exact, context.simulated, 0.0);
  setup.beam_second =
      read_setup_number(table, "beam_second", Quantity::angle, Knowledge::exact, context.simulated, 0.0);
  if (setup.standard != Standard::plane) {
    setup.radius = read_setup_number(table, "radius", Quantity::length, Knowledge::exact, context.simulated);
    if (!(setup.radius.value > 0)) table.fail_quantity("radius", Quantity::length, "is not above zero", "a radius");
  }
  if (setup.standard == Standard::cylinder) {
    setup.taper =
        read_setup_number(table, "taper", Quantity::length_per_length, Knowledge::exact, context.simulated, 0.0);
  }
  TomlTable noise = table.table("noise");
  setup.noise = read_noise(noise, "indication", Quantity::length);
  setup.form = noise.size_or("form", Quantity::length, 0);
  noise.finish();
  for (TomlTable& entry : table.tables("clamping")) {
    setup.clampings.push_back(read_clamping(entry, setup.standard, context.simulated));
  }
  if (setup.clampings.empty()) {
    table.fail("", "there is no standard", "[[setup.clamping]] with name, point_mm and direction");
  }
  return std::make_shared<SurfaceProbe>(setup);
}

}  // namespace abbe
