#include <cmath>
#include <tuple>

#include "abbe/formats/study/study_direction.h"
#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/study/study_quantity.h"
#include "abbe/instruments/autocollimator.h"
#include "abbe/instruments/electronic_level.h"

namespace abbe {

std::shared_ptr<Instrument> read_level(TomlTable& table, const InstrumentContext& context) {
  const bool simulated = context.simulated;
  ElectronicLevelSetup setup;
  setup.name = context.name;
  setup.relative = table.boolean_or("relative", false);
  std::tie(setup.body, setup.reference_body) =
      read_bodies(table, {"level_on", Body::workpiece}, {"reference_on", Body::bed});
  if (!setup.relative && setup.reference_body != Body::bed) {
    table.fail("reference_on", "belongs to a level that is read against another", "relative = true");
  }
  setup.up = read_direction(table, "up", Eigen::Vector3d::UnitZ());
  setup.up_tilt_first = read_setup_number(table, "up_tilt_first", Quantity::angle, Knowledge::exact, simulated, 0.0);
  setup.up_tilt_second = read_setup_number(table, "up_tilt_second", Quantity::angle, Knowledge::exact, simulated, 0.0);
  TomlTable noise = table.table("noise");
  setup.noise = read_noise(noise, "inclination", Quantity::angle);
  noise.finish();
  for (TomlTable& entry : table.tables("sensitive")) {
    ElectronicLevelSetup::Axis axis;
    axis.name = entry.text("name");
    axis.direction = read_direction(entry, "direction");
    if (std::abs(axis.direction.normalized().dot(setup.up.normalized())) > 0.99) {
      entry.fail("direction", "is vertical", "a direction across up");
    }
    axis.zero = read_setup_number(entry, "zero", Quantity::angle, Knowledge::open, simulated, 0.0);
    entry.finish();
    setup.axes.push_back(axis);
  }
  if (setup.axes.empty() || setup.axes.size() > 2) {
    table.fail("", "the sensitive directions are missing or too many",
               "one or two [[setup.sensitive]] with name and direction");
  }
  return std::make_shared<ElectronicLevel>(setup);
}

std::shared_ptr<Instrument> read_autocollimator(TomlTable& table, const InstrumentContext& context) {
  const auto angle = [&](const char* base, Knowledge unstated) {
    return read_setup_number(table, base, Quantity::angle, unstated, context.simulated, 0.0);
  };
  AutocollimatorSetup setup;
  setup.name = context.name;
  std::tie(setup.mirror_body, setup.collimator_body) =
      read_bodies(table, {"mirror_on", Body::workpiece}, {"autocollimator_on", Body::bed});
  setup.beam = read_direction(table, "beam");
  setup.first = read_direction(table, "first");
  if (!(setup.beam.cross(setup.first).norm() > 1e-3 * setup.beam.norm() * setup.first.norm())) {
    table.fail("first", "lies along the beam", "a direction across it");
  }
  setup.mirror_tilt_first = angle("mirror_tilt_first", Knowledge::open);
  setup.mirror_tilt_second = angle("mirror_tilt_second", Knowledge::open);
  setup.zero_first = angle("zero_first", Knowledge::exact);
  setup.zero_second = angle("zero_second", Knowledge::exact);
  setup.indication =
      static_cast<AutocollimatorSetup::Indication>(table.word_or("indication", 0, {"mirror-angle", "half-tangent"}));
  TomlTable noise = table.table("noise");
  setup.noise = read_noise(noise, "angle", Quantity::angle);
  noise.finish();
  return std::make_shared<Autocollimator>(setup);
}

}  // namespace abbe
