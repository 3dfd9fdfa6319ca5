#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <set>

#include "abbe/formats/study_instrument.h"
#include "abbe/formats/study_parts.h"
#include "abbe/formats/toml_vector.h"

namespace abbe {
namespace {

constexpr double kMicrometresPerMillimetre = 1e3;
constexpr double kMicrometresPerMetre = 1e6;  // of mm per mm

StudyPose read_pose(TomlTable table) {
  StudyPose pose;
  pose.position = vector_of(table.numbers("position", Quantity::length, 3));
  if (const auto angles = table.optional_numbers("angles", Quantity::angle, 3)) pose.angles = vector_of(*angles);
  table.finish();
  return pose;
}

SetupStation read_station(TomlTable& table, bool simulated) {
  SetupStation station;
  station.name = table.text("name");
  bool find = !table.has("pose");
  if (table.has("pose") && table.is_text("pose")) {
    find = true;
    if (table.text("pose") != "find") table.fail("pose", "unknown word", "\"find\" or { position_mm, angles_deg }");
  } else if (auto pose = table.optional_table("pose")) {
    station.pose = read_pose(*pose);
  }
  station.estimate_pose = table.boolean_or("estimate_pose", true);
  if (!station.estimate_pose && find) {
    table.fail("estimate_pose", "a pose that is not estimated has to be given", "pose = { position_mm, angles_deg }");
  }
  if (auto pose = table.optional_table("true_pose")) {
    if (!simulated) table.fail("true_pose", "belongs to a simulation only", "[simulate]");
    station.true_pose = read_pose(*pose);
  }
  const auto limits = [&](const char* name, Quantity quantity, std::array<double, 2>& range) {
    const auto values = table.optional_numbers(name, quantity, 2);
    if (!values) return;
    range = {(*values)[0], (*values)[1]};
    if (range[0] >= range[1]) table.fail_quantity(name, quantity, "is not increasing", "[smallest, largest]");
  };
  limits("elevation", Quantity::angle, station.elevation);
  limits("range", Quantity::length, station.range);
  if (simulated && !station.pose && !station.true_pose) {
    table.fail("", "a simulation needs the true pose",
               "true_pose = { position_mm = [x, y, z], angles_deg = [a, b, c] }");
  }
  table.finish();
  return station;
}

SetupReflector read_reflector(TomlTable& table, bool simulated) {
  SetupReflector reflector;
  reflector.name = table.text("name");
  reflector.mounted_on = read_body(table, "mounted_on", Body::tool);
  if (table.has("offset")) {
    if (!table.is_text("offset") || table.text("offset") != "from-data") {
      table.fail("offset", "is not \"from-data\"", "offset = \"from-data\", or a vector offset_mm = [x, y, z]");
    }
    if (simulated) table.fail("offset", "a simulation has no data", "offset_mm = [x, y, z]");
    reflector.offset_from_data = true;
  } else {
    reflector.offset = vector_of(table.numbers("offset", Quantity::length, 3));
  }
  reflector.estimate_offset = table.boolean_or("estimate_offset", false);
  if (const auto u = table.optional_numbers("offset_standard_uncertainty", Quantity::length, 3)) {
    reflector.offset_standard_uncertainty = vector_of(*u);
    if (reflector.offset_standard_uncertainty.minCoeff() < 0) {
      table.fail_quantity("offset_standard_uncertainty", Quantity::length, "is negative", "lengths not below zero");
    }
  }
  if (const auto offset = table.optional_numbers("true_offset", Quantity::length, 3)) {
    if (!simulated) table.fail_quantity("true_offset", Quantity::length, "belongs to a simulation only", "[simulate]");
    reflector.true_offset = vector_of(*offset);
  }
  if (const auto direction = table.optional_numbers("view_direction", Quantity::dimensionless, 3)) {
    reflector.view_direction = vector_of(*direction);
    if (reflector.view_direction.norm() == 0) table.fail("view_direction", "has no length", "a direction [x, y, z]");
    reflector.view_direction.normalize();
    reflector.view_half_angle = table.number("view_half_angle", Quantity::angle);
    if (reflector.view_half_angle <= 0 || reflector.view_half_angle > std::numbers::pi) {
      table.fail_quantity("view_half_angle", Quantity::angle, "is out of range", "above 0, up to 180 degrees");
    }
  }
  table.finish();
  return reflector;
}

TrackerNoise read_noise(TomlTable table) {
  const bool isotropic = table.has("xyz", Quantity::length);
  const double xyz = table.size_or("xyz", Quantity::length, 0);
  const double xyz_slope = table.size_or("xyz", Quantity::length_per_length, 0);
  const double range = table.size_or("range", Quantity::length, 0);
  const double range_slope = table.size_or("range", Quantity::length_per_length, 0);
  const double angle = table.size_or("angle", Quantity::angle, 0);
  table.finish();
  const std::string expected = "xyz_um with xyz_um_per_m, or range_um with range_um_per_m and angle_arcsec";
  if (isotropic) {
    if (range > 0 || range_slope > 0 || angle > 0) table.fail("", "xyz stands beside range or angle", expected);
    if (xyz <= 0) table.fail_quantity("xyz", Quantity::length, "is not above zero", "a standard deviation");
    return TrackerNoise::isotropic(xyz * kMicrometresPerMillimetre, xyz_slope * kMicrometresPerMetre);
  }
  if (range <= 0 || angle <= 0) table.fail("", "the noise is missing or zero", expected);
  return {range * kMicrometresPerMillimetre, range_slope * kMicrometresPerMetre, 0, angle * kMicrometresPerMetre};
}

SetupData read_data(TomlTable& table, const std::filesystem::path& folder) {
  SetupData data;
  data.file = folder / table.text("file");
  data.mapping.ignore = table.texts_or_none("ignore");
  data.mapping.ignored_by = "`ignore`";
  if (auto columns = table.optional_table("columns")) {
    for (const std::string& ours : columns->keys()) data.mapping.columns.emplace(ours, columns->text(ours));
  }
  table.finish();
  return data;
}

template <typename Named>
void refuse_same_name(const TomlTable& table, const std::vector<Named>& items) {
  for (std::size_t i = 0; i + 1 < items.size(); ++i) {
    if (items[i].name == items.back().name) {
      table.fail("name", fmt::format("another one is called \"{}\"", items.back().name), "different names");
    }
  }
}

void read_tracker(TomlTable& table, bool simulated, Setup& setup) {
  setup.mounted_on = read_body(table, "mounted_on", Body::workpiece);
  setup.measure = static_cast<TrackerMeasure>(table.word_or("measure", 0, {"xyz", "range-angles"}));
  if (!setup.noise_from_data) setup.noise = read_noise(table.table("noise"));
  if (table.has("state_uncertainty") && !simulated) {
    table.fail("state_uncertainty", "belongs to a simulation only", "[simulate], or noise_from_data = true");
  }
  setup.stated =
      static_cast<StatedUncertainty>(table.word_or("state_uncertainty", 0, {"none", "standard", "covariance"}));
  for (TomlTable& station : table.tables("station")) {
    setup.stations.push_back(read_station(station, simulated));
    refuse_same_name(station, setup.stations);
  }
  if (setup.stations.empty()) {
    if (simulated) table.fail("", "the stations are missing", "[[setup.station]] with its true_pose");
    setup.stations.push_back({setup.name, std::nullopt, true, std::nullopt});
  }
  for (TomlTable& reflector : table.tables("reflector")) {
    setup.reflectors.push_back(read_reflector(reflector, simulated));
    refuse_same_name(reflector, setup.reflectors);
    if (setup.reflectors.back().mounted_on == setup.mounted_on) {
      reflector.fail("", "the reflector and the instrument are on the same body, so that no axis moves between them",
                     "another mounted_on for one of them");
    }
  }
}

/// The readings of a file name their item, so that every item needs a name of its own.
void refuse_same_items(const TomlTable& table, const Instrument& device) {
  std::set<std::string> names;
  for (const InstrumentItem& item : device.items()) {
    if (!names.insert(item.name).second) {
      table.fail("", fmt::format("two items are called \"{}\"", item.name), "different names");
    }
  }
}

/// Names of what can be measured at a position, and of where it can be measured from.
PlanNames plan_names(const Setup& setup) {
  PlanNames names;
  names.key = setup.device ? "items" : "reflectors";
  names.one = setup.device ? "item" : "reflector";
  if (setup.device) names.targets = setup.device->target_names();
  for (const SetupReflector& reflector : setup.reflectors) names.targets.push_back(reflector.name);
  for (const SetupStation& station : setup.stations) names.stations.push_back(station.name);
  return names;
}

}  // namespace

Setup read_setup(TomlTable& table, const std::filesystem::path& folder, const Machine& machine, bool simulated,
                 bool planned) {
  Setup setup;
  setup.name = table.file_name("name");
  std::vector<std::string_view> words = instrument_words();
  words.insert(words.begin(), "tracker");
  const std::size_t instrument = table.word("instrument", words);
  setup.instrument = words[instrument];
  setup.noise_from_data = table.boolean_or("noise_from_data", false);
  if (setup.noise_from_data) {
    if (simulated) table.fail("noise_from_data", "a simulation has no data", "[setup.noise]");
    if (instrument == 0 && table.has("noise")) {
      table.fail("noise", "stands beside noise_from_data = true", "only one of them");
    }
  }
  if (instrument == 0) {
    read_tracker(table, simulated, setup);
  } else {
    setup.device = read_instrument(instrument - 1, table, {setup.name, machine, simulated});
    refuse_same_items(table, *setup.device);
  }
  const PlanNames names = plan_names(setup);
  for (TomlTable& plan : table.tables("plan")) {
    if (!simulated) table.fail("plan", "belongs to a simulation only", "[simulate], or [[setup.data]]");
    if (names.targets.empty()) table.fail("", "the reflectors are missing", "[[setup.reflector]]");
    setup.plans.push_back(read_plan(plan, folder, machine, names));
  }
  for (TomlTable& data : table.tables("data")) {
    if (simulated) table.fail("data", "stands beside [simulate]", "only one of them");
    setup.data.push_back(read_data(data, folder));
  }
  if (setup.plans.empty() && setup.data.empty() && !planned) {
    table.fail("", "the readings are missing", simulated ? "[[setup.plan]]" : "[[setup.data]] with a file");
  }
  table.finish();
  return setup;
}

}  // namespace abbe
