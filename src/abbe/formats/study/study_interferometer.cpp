#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <tuple>

#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/study/study_quantity.h"
#include "abbe/formats/text/toml_vector.h"
#include "abbe/instruments/interferometer.h"

namespace abbe {
namespace {

const std::vector<std::string> kComponentWords = {"length", "straightness_y", "straightness_z", "roll", "pitch", "yaw"};

void read_components(TomlTable& table, InterferometerSetup& setup) {
  if (!table.has("components")) {
    table.texts_or_none("components");
    return;
  }
  setup.components.clear();
  for (const std::string& word : table.texts("components")) {
    const auto found = std::find(kComponentWords.begin(), kComponentWords.end(), word);
    if (found == kComponentWords.end()) {
      table.fail("components", fmt::format("unknown component \"{}\"", word),
                 "some of length, straightness_y, straightness_z, roll, pitch, yaw");
    }
    setup.components.push_back(static_cast<InterferometerComponent>(found - kComponentWords.begin()));
  }
}

bool measures(const InterferometerSetup& setup, InterferometerComponent first, InterferometerComponent last) {
  return std::any_of(setup.components.begin(), setup.components.end(),
                     [&](InterferometerComponent component) { return component >= first && component <= last; });
}

/// Scales and noise of what is measured; those of other components are refused.
void read_scales_and_noise(TomlTable& table, bool simulated, InterferometerSetup& setup) {
  using enum InterferometerComponent;
  const auto scale = [&](const char* base) {
    return read_setup_number(table, base, Quantity::length_per_length, Knowledge::exact, simulated, 0.0);
  };
  TomlTable noise = table.table("noise");
  if (measures(setup, length, length)) {
    setup.length_scale = scale("length_scale");
    setup.length_noise = read_noise(noise, "length", Quantity::length);
    setup.length_noise_per_length = noise.size_or("length", Quantity::length_per_length, 0);
  }
  if (measures(setup, straightness_y, straightness_z)) {
    setup.straightness_scale = scale("straightness_scale");
    setup.straightness_noise = read_noise(noise, "straightness", Quantity::length);
  }
  if (measures(setup, roll, yaw)) {
    setup.angle_scale = scale("angle_scale");
    setup.angle_noise = read_noise(noise, "angle", Quantity::angle);
  }
  noise.finish();
}

/// Positions of the rotary axes while the optics were aligned.
std::vector<double> read_rotary_positions_when_aligned(TomlTable& table, const Machine& machine) {
  std::vector<double> positions(machine.axes.size(), 0.0);
  std::optional<TomlTable> aligned = table.optional_table("aligned_at");
  if (!aligned) return positions;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (machine.axes[i].kind != AxisKind::rotary) continue;
    positions[i] = aligned->number_or(machine.axes[i].name, Quantity::angle, 0);
  }
  aligned->finish();
  return positions;
}

InterferometerRun read_run(TomlTable& table, const InstrumentContext& context) {
  const bool simulated = context.simulated;
  InterferometerRun run;
  run.name = table.text("name");
  std::tie(run.moving_body, run.reference_body) =
      read_bodies(table, {"moving_on", Body::tool}, {"reference_on", Body::workpiece});
  run.optic = read_setup_point(table, "optic", Knowledge::exact, simulated);
  run.origin = read_setup_point(table, "origin", Knowledge::exact, simulated, Eigen::Vector3d::Zero());
  run.direction = vector_of(table.numbers("direction", Quantity::dimensionless, 3));
  if (!(run.direction.norm() > 0)) table.fail("direction", "has no length", "the direction of the beam: [1, 0, 0]");
  run.direction.normalize();
  // Without a word z of the beam is up, for a vertical beam towards Y.
  run.up = std::abs(run.direction.z()) < 0.99 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
  if (const auto up = table.optional_numbers("up", Quantity::dimensionless, 3)) {
    run.up = vector_of(*up);
    if (!(run.up.cross(run.direction).norm() > 1e-6 * run.up.norm())) {
      table.fail("up", "lies along the direction of the beam", "a direction across the beam");
    }
  }
  run.square_with = table.text_or("square_with", "");
  if (run.square_with.empty()) {
    const char* names[] = {"roll", "pitch", "yaw"};
    for (std::size_t i = 0; i < 3; ++i) {
      run.alignment[i] = read_setup_number(table, names[i], Quantity::angle, Knowledge::exact, simulated, 0.0);
    }
  } else {
    run.square_angle = read_setup_number(table, "square_angle", Quantity::angle, Knowledge::exact, simulated, 0.0);
  }
  run.aligned_orientation = nominal_orientation(
      context.machine, read_rotary_positions_when_aligned(table, context.machine), run.moving_body, run.reference_body);
  run.target = static_cast<LengthTarget>(table.word_or("target", 0, {"retroreflector", "plane-mirror"}));
  run.straightness_reflector_moves = table.boolean_or("straightness_reflector_moves", false);
  run.bidirectional = table.boolean_or("bidirectional", false);
  run.dead_path = table.size_or("dead_path", Quantity::length, 0);
  table.finish();
  return run;
}

}  // namespace

std::shared_ptr<Instrument> read_interferometer(TomlTable& table, const InstrumentContext& context) {
  InterferometerSetup setup;
  setup.name = context.name;
  read_components(table, setup);
  read_scales_and_noise(table, context.simulated, setup);
  for (TomlTable& entry : table.tables("run")) {
    InterferometerRun run = read_run(entry, context);
    for (const InterferometerRun& other : setup.runs) {
      if (other.name == run.name)
        entry.fail("name", fmt::format("there are two runs \"{}\"", run.name), "another name");
    }
    setup.runs.push_back(std::move(run));
  }
  if (setup.runs.empty()) {
    table.fail("", "the runs are missing", "[[setup.run]] with name, optic_mm and direction");
  }
  try {
    return std::make_shared<Interferometer>(setup);
  } catch (const std::invalid_argument& error) {
    // What the instrument itself refuses: repeated components, squares without their first run.
    table.fail("", error.what(), "runs that belong together as docs/interferometer.md says");
  }
}

}  // namespace abbe
