#include <fmt/format.h>

#include <numbers>

#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/study/study_pose.h"
#include "abbe/formats/text/toml_vector.h"
#include "abbe/instruments/trackers/laser_tracker.h"

namespace abbe {
namespace {

constexpr double kMicrometresPerMillimetre = 1e3;
constexpr double kMicrometresPerMetre = 1e6;  // of mm per mm

TrackerStation read_station(TomlTable& table, bool simulated) {
  TrackerStation station;
  station.name = table.text("name");
  const StatedPose pose = read_station_pose(table, simulated);
  station.body_from_tracker = pose.body_from_station;
  station.pose_is_known = pose.is_known;
  station.estimate_pose = pose.estimate;
  station.true_pose = pose.truth;
  const auto limits = [&](const char* name, Quantity quantity, double& smallest, double& largest) {
    const auto values = table.optional_numbers(name, quantity, 2);
    if (!values) return;
    smallest = (*values)[0];
    largest = (*values)[1];
    if (smallest >= largest) table.fail_quantity(name, quantity, "is not increasing", "[smallest, largest]");
  };
  limits("elevation", Quantity::angle, station.elevation_min, station.elevation_max);
  limits("range", Quantity::length, station.range_min, station.range_max);
  table.finish();
  return station;
}

Reflector read_reflector(TomlTable& table, bool simulated) {
  Reflector reflector;
  reflector.name = table.text("name");
  reflector.body = read_body(table, "mounted_on", Body::tool);
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

TrackerNoise read_tracker_noise(TomlTable table) {
  const bool isotropic = table.has("xyz", Quantity::length);
  const double xyz = table.size_or("xyz", Quantity::length, 0);
  const double xyz_slope = table.size_or("xyz", Quantity::length_per_length, 0);
  const double range = table.size_or("range", Quantity::length, 0);
  const double range_slope = table.size_or("range", Quantity::length_per_length, 0);
  const double angle = table.size_or("angle", Quantity::angle, 0);
  table.finish();
  const std::string expected = "xyz_um with xyz_um_per_m, or range_um with range_um_per_m and angle_arcsec";
  if (isotropic) {
    if (range > 0 || range_slope > 0 || angle > 0)
      table.fail("", "xyz is given together with range or angle", expected);
    if (xyz <= 0) table.fail_quantity("xyz", Quantity::length, "is not above zero", "a standard deviation");
    return TrackerNoise::isotropic(xyz * kMicrometresPerMillimetre, xyz_slope * kMicrometresPerMetre);
  }
  if (range <= 0 || angle <= 0) table.fail("", "the noise is missing or zero", expected);
  return {range * kMicrometresPerMillimetre, range_slope * kMicrometresPerMetre, 0, angle * kMicrometresPerMetre};
}

template <typename Named>
void refuse_same_name(const TomlTable& table, const std::vector<Named>& items) {
  for (std::size_t i = 0; i + 1 < items.size(); ++i) {
    if (items[i].name == items.back().name) {
      table.fail("name", fmt::format("another one is called \"{}\"", items.back().name), "different names");
    }
  }
}

}  // namespace

std::shared_ptr<Instrument> read_tracker(TomlTable& table, const InstrumentContext& context) {
  const bool simulated = context.simulated;
  const Body mounted_on = read_body(table, "mounted_on", Body::workpiece);
  const auto measure = static_cast<TrackerMeasure>(table.word_or("measure", 0, {"xyz", "range-angles"}));
  TrackerNoise noise;
  if (context.noise_from_data && table.has("noise")) {
    table.fail("noise", "is given together with noise_from_data = true", "only one of them");
  }
  if (!context.noise_from_data) noise = read_tracker_noise(table.table("noise"));
  if (table.has("state_uncertainty") && !simulated) {
    table.fail("state_uncertainty", "belongs to a simulation only", "[simulate], or noise_from_data = true");
  }
  const auto stated =
      static_cast<StatedUncertainty>(table.word_or("state_uncertainty", 0, {"none", "standard", "covariance"}));
  TrackerSetup setup;
  for (TomlTable& station : table.tables("station")) {
    setup.stations.push_back(read_station(station, simulated));
    refuse_same_name(station, setup.stations);
  }
  if (setup.stations.empty()) {
    if (simulated) table.fail("", "the stations are missing", "[[setup.station]] with its true_pose");
    TrackerStation station;
    station.name = context.name;
    station.pose_is_known = false;
    setup.stations.push_back(station);
  }
  for (TrackerStation& station : setup.stations) {
    station.body = mounted_on;
    station.noise = noise;
  }
  for (TomlTable& reflector : table.tables("reflector")) {
    setup.reflectors.push_back(read_reflector(reflector, simulated));
    refuse_same_name(reflector, setup.reflectors);
    if (setup.reflectors.back().body == mounted_on) {
      reflector.fail("", "the reflector and the instrument are on the same body, so that no axis moves between them",
                     "another mounted_on for one of them");
    }
  }
  return std::make_shared<LaserTracker>(context.name, std::move(setup), measure, stated);
}

}  // namespace abbe
