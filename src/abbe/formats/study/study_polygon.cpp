#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <tuple>

#include "abbe/formats/study/study_direction.h"
#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/study/study_quantity.h"
#include "abbe/formats/text/toml_vector.h"
#include "abbe/instruments/polygon/polygon_placement.h"

namespace abbe {
namespace {

constexpr std::int64_t kMostFaces = 360;
constexpr std::size_t kMostMounts = 20, kMostSteps = 9;  // with 360 faces fewer items than 16 bits count

/// A number of one face: what the face does not state is that of all faces.
SetupNumber read_face_number(TomlTable& table, const char* base, Quantity quantity, const SetupNumber& all,
                             bool simulated) {
  SetupNumber number = read_setup_number(table, base, quantity, all.knowledge, simulated, all.value);
  if (number.knowledge == Knowledge::within && number.standard_uncertainty == 0) {
    number.standard_uncertainty = all.standard_uncertainty;
  }
  return number;
}

/// The errors of a face; `distance` is still its error.
PolygonGaugeSetup::Face read_polygon_face(TomlTable& table, const PolygonGaugeSetup::Face& all, bool simulated) {
  return {read_face_number(table, "azimuth_error", Quantity::angle, all.azimuth_error, simulated),
          read_face_number(table, "tilt", Quantity::angle, all.tilt, simulated),
          read_face_number(table, "distance_error", Quantity::length, all.distance, simulated)};
}

void read_prism(TomlTable table, bool simulated, PolygonGaugeSetup& setup) {
  const std::size_t faces = static_cast<std::size_t>(table.integer("faces", 4, kMostFaces));
  if (faces % 4 != 0) {
    table.fail("faces", "is not divisible by four, so that no face looks along y while one looks along x",
               "4, 8, 12, 24, 36, ...");
  }
  const double distance = table.number("distance", Quantity::length), height = table.number("height", Quantity::length);
  if (!(distance > 0))
    table.fail_quantity("distance", Quantity::length, "is not above zero", "of a face from the axis");
  if (!(height > 0)) table.fail_quantity("height", Quantity::length, "is not above zero", "the height of the prism");
  setup.polygon = regular_polygon(faces, distance, height);
  const char* tops[] = {"top_tilt_x", "top_tilt_y"};
  for (std::size_t i = 0; i < 2; ++i) {
    setup.top[i] = read_setup_number(table, tops[i], Quantity::angle, Knowledge::exact, simulated, 0.0);
  }
  const PolygonGaugeSetup::Face open{SetupNumber::open(0), SetupNumber::open(0), SetupNumber::open(0)};
  setup.faces.assign(faces, read_polygon_face(table, open, simulated));
  const PolygonGaugeSetup::Face all = setup.faces.front();
  std::vector<bool> stated(faces, false);
  for (TomlTable& entry : table.tables("face")) {
    const std::size_t j = static_cast<std::size_t>(entry.integer("number", 1, static_cast<std::int64_t>(faces))) - 1;
    if (stated[j]) entry.fail("number", fmt::format("face {} is stated twice", j + 1), "each face once");
    stated[j] = true;
    setup.faces[j] = read_polygon_face(entry, all, simulated);
    entry.finish();
  }
  for (PolygonGaugeSetup::Face& face : setup.faces) {
    face.distance.value += distance;
    if (face.distance.truth) *face.distance.truth += distance;
    if (!(face.distance.value > 0)) table.fail("", "a face has no distance from the axis", "small distance errors");
  }
  table.finish();
}

/// The sensors stand where the paper's stand around a prism of this size, unless the file says otherwise.
void read_sensors(TomlTable& table, PolygonGaugeSetup& setup) {
  setup.bench =
      regular_campaign(setup.polygon.faces.size(), setup.polygon.faces.front().distance, setup.polygon.top.height, {0})
          .bench;
  std::optional<TomlTable> sensors = table.optional_table("sensor");
  if (!sensors) return;
  const struct {
    const char* key;
    PolygonSensor& sensor;
  } named[] = {{"autocollimator_x", setup.bench.autocollimator_x},
               {"autocollimator_y", setup.bench.autocollimator_y},
               {"displacement_x", setup.bench.displacement_x},
               {"displacement_y", setup.bench.displacement_y},
               {"displacement_z", setup.bench.displacement_z}};
  for (const auto& [key, sensor] : named) {
    std::optional<TomlTable> entry = sensors->optional_table(key);
    if (!entry) continue;
    if (const auto position = entry->optional_numbers("position", Quantity::length, 3)) {
      sensor.position = vector_of(*position);
    }
    if (const auto angles = entry->optional_numbers("angles", Quantity::angle, 3)) sensor.angles = vector_of(*angles);
    entry->finish();
  }
  sensors->finish();
}

PolygonReading read_reading(const TomlTable& table, const std::string& word) {
  std::string names;
  for (std::size_t i = 0; i < kPolygonReadings; ++i) {
    const auto reading = static_cast<PolygonReading>(i);
    if (word == reading_name(reading)) return reading;
    names += (i == 0 ? "some of " : ", ") + std::string(reading_name(reading));
  }
  table.fail("measured", fmt::format("unknown reading \"{}\"", word), names);
}

/// A zero is what is indicated where the prism nominally stands.
void read_zeros(TomlTable& table, bool simulated, const PolygonGaugeSetup& setup, PolygonGaugeSetup::Step& step) {
  std::optional<TomlTable> zeros = table.optional_table("zero");
  for (const PolygonReading reading : step.measured) {
    const Quantity quantity = is_angle(reading) ? Quantity::angle : Quantity::length;
    SetupNumber zero = SetupNumber::open(0);
    if (zeros) zero = read_setup_number(*zeros, reading_name(reading), quantity, Knowledge::open, simulated, 0.0);
    const double nominal =
        polygon_reading(reading, setup.polygon, {}, setup.bench, regular_position(setup.polygon.faces.size(), 0), {});
    zero.value -= nominal;
    if (zero.truth) *zero.truth -= nominal;
    step.zeros.push_back(zero);
  }
  if (zeros) zeros->finish();
}

/// One autocollimator, one displacement sensor, put up one after the other in several places.
PolygonGaugeSetup::Step read_step(TomlTable& table) {
  using enum PolygonReading;
  PolygonGaugeSetup::Step step;
  step.name = table.text("name");
  if (table.has("autocollimator")) {
    if (table.word("autocollimator", {"x", "y"}) == 0) {
      step.measured = {autocollimator_x_about_z, autocollimator_x_about_y};
    } else {
      step.measured = {autocollimator_y_about_z, autocollimator_y_about_x};
    }
  }
  if (table.has("displacement")) {
    const PolygonReading along[] = {displacement_x, displacement_y, displacement_z};
    step.measured.push_back(along[table.word("displacement", {"x", "y", "z"})]);
  }
  if (step.measured.empty()) {
    table.fail("", "nothing is measured", "autocollimator = \"x\" or \"y\", displacement = \"x\", \"y\" or \"z\"");
  }
  return step;
}

void read_steps(TomlTable& table, bool simulated, PolygonGaugeSetup& setup) {
  std::vector<TomlTable> entries = table.tables("step");
  if (entries.empty()) {
    if (const std::vector<std::string> words = table.texts_or_none("measured"); !words.empty()) {
      setup.steps.front().measured.clear();
      for (const std::string& word : words) setup.steps.front().measured.push_back(read_reading(table, word));
    }
    read_zeros(table, simulated, setup, setup.steps.front());
    return;
  }
  for (const char* key : {"measured", "zero"}) {
    if (table.has(key))
      table.fail(key, "is given together with steps", "autocollimator, displacement and zero in each step");
  }
  if (entries.size() > kMostSteps) table.fail("", "there are too many steps", fmt::format("at most {}", kMostSteps));
  setup.steps.clear();
  for (TomlTable& entry : entries) {
    setup.steps.push_back(read_step(entry));
    PolygonGaugeSetup::Step& step = setup.steps.back();
    read_zeros(entry, simulated, setup, step);
    entry.finish();
    const auto has_angle = [](const PolygonGaugeSetup::Step& one) { return is_angle(one.measured.front()); };
    const PolygonGaugeSetup::Step& first = setup.steps.front();
    if (step.measured.size() != first.measured.size() || has_angle(step) != has_angle(first)) {
      entry.fail("", "measures other kinds of readings than the first step",
                 "autocollimator in every step or in none, and likewise displacement");
    }
  }
}

void read_mounts(TomlTable& table, bool simulated, PolygonGaugeSetup& setup) {
  setup.mounts.clear();
  const char* keys[] = {"tilt_x", "tilt_y", "turn", "x", "y", "z"};
  for (TomlTable& entry : table.tables("mount")) {
    PolygonGaugeSetup::Mount mount;
    mount.name = entry.text("name");
    mount.turned_by = static_cast<std::size_t>(
        entry.integer_or("turned_by_faces", 0, 0, static_cast<std::int64_t>(setup.polygon.faces.size()) - 1));
    for (std::size_t i = 0; i < 6; ++i) {
      mount.numbers[i] = read_setup_number(entry, keys[i], i < 3 ? Quantity::angle : Quantity::length, Knowledge::open,
                                           simulated, 0.0);
    }
    entry.finish();
    setup.mounts.push_back(mount);
  }
  if (setup.mounts.empty() || setup.mounts.size() > kMostMounts) {
    table.fail("", "the mounts of the prism are missing or too many",
               fmt::format("1 to {} [[setup.mount]] with name and turned_by_faces", kMostMounts));
  }
}

/// Commands at which face 1 looks along x: as plans hold axes that they do not name, unless stated.
std::vector<double> read_commands_when_aligned(TomlTable& table, const Machine& machine) {
  std::optional<TomlTable> aligned = table.optional_table("aligned_at");
  std::vector<double> positions;
  for (const Axis& axis : machine.axes) {
    const bool has_zero = axis.endless || (axis.travel_min <= 0 && axis.travel_max >= 0);
    positions.push_back(has_zero ? 0 : 0.5 * (axis.travel_min + axis.travel_max));
    const Quantity quantity = axis.kind == AxisKind::rotary ? Quantity::angle : Quantity::length;
    if (aligned) positions.back() = aligned->number_or(axis.name, quantity, positions.back());
  }
  if (aligned) aligned->finish();
  return positions;
}

void read_placement(TomlTable& table, const Machine& machine, PolygonGaugeSetup& setup) {
  PolygonPlacement placement;
  const std::string name = table.text("rotary_axis");
  placement.axis = machine.find_axis(name);
  if (placement.axis == Machine::npos || machine.axes[placement.axis].kind != AxisKind::rotary) {
    std::string names;
    for (const Axis& axis : machine.axes) {
      if (axis.kind == AxisKind::rotary) names += (names.empty() ? "" : ", ") + axis.name;
    }
    table.fail("rotary_axis", fmt::format("the machine has no rotary axis {}", name),
               names.empty() ? "a machine with one" : "one of " + names);
  }
  std::tie(placement.table_body, placement.sensor_body) =
      read_bodies(table, {"prism_on", Body::workpiece}, {"sensors_on", Body::bed});
  if (const auto centre = table.optional_numbers("centre", Quantity::length, 3)) placement.centre = vector_of(*centre);
  placement.top = read_direction(table, "top", machine.axes[placement.axis].direction);
  const bool across_x = std::abs(placement.top.normalized().x()) < 0.5;
  placement.toward_x =
      read_direction(table, "toward_x", across_x ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY());
  placement.aligned_at = read_commands_when_aligned(table, machine);
  try {
    place_polygon(machine, placement, setup);
  } catch (const std::invalid_argument& error) {
    table.fail("", error.what(), "centre_mm, top and toward_x as docs/polygon.md says");
  }
}

}  // namespace

std::shared_ptr<Instrument> read_polygon(TomlTable& table, const InstrumentContext& context) {
  PolygonGaugeSetup setup;
  setup.name = context.name;
  read_prism(table.table("prism"), context.simulated, setup);
  read_sensors(table, setup);
  read_placement(table, context.machine, setup);
  read_mounts(table, context.simulated, setup);
  read_steps(table, context.simulated, setup);
  bool angles = false, lengths = false;
  for (const PolygonReading reading : setup.steps.front().measured) {
    angles = angles || is_angle(reading);
    lengths = lengths || !is_angle(reading);
  }
  TomlTable noise = table.table("noise");
  if (angles) setup.noise.angle = read_noise(noise, "angle", Quantity::angle);
  if (lengths) setup.noise.length = read_noise(noise, "displacement", Quantity::length);
  noise.finish();
  try {
    return std::make_shared<PolygonGauge>(setup);
  } catch (const std::invalid_argument& error) {
    // What the instrument itself refuses: beams beside the faces, readings named twice.
    table.fail("", error.what(), "a set-up that can be measured as docs/polygon.md says");
  }
}

}  // namespace abbe
