#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/study/study_quantity.h"
#include "abbe/instruments/trackers/tracking_interferometer.h"

namespace abbe {
namespace {

using Described = TrackingInterferometerSetup;

template <typename Named>
std::size_t find_named(const std::vector<Named>& list, const std::string& name) {
  return static_cast<std::size_t>(
      std::find_if(list.begin(), list.end(), [&](const Named& one) { return one.name == name; }) - list.begin());
}

template <typename Named>
void refuse_twice(TomlTable& table, const std::vector<Named>& list, const std::string& name) {
  if (find_named(list, name) < list.size()) {
    table.fail("name", fmt::format("the name \"{}\" is there twice", name), "another name");
  }
}

/// Index of what `key` names.
template <typename Named>
std::size_t read_name_of(TomlTable& table, const char* key, const std::vector<Named>& list) {
  const std::string name = table.text(key);
  const std::size_t found = find_named(list, name);
  if (found < list.size()) return found;
  std::string names;
  for (const Named& one : list) names += (names.empty() ? "one of " : ", ") + one.name;
  table.fail(key, fmt::format("there is no {} \"{}\"", key, name), names);
}

}  // namespace

std::shared_ptr<Instrument> read_tracking_interferometer(TomlTable& table, const InstrumentContext& context) {
  Described setup;
  const bool simulated = context.simulated;
  setup.name = context.name;
  setup.length_scale =
      read_setup_number(table, "length_scale", Quantity::length_per_length, Knowledge::exact, simulated, 0.0);
  TomlTable noise = table.table("noise");
  setup.noise = read_noise(noise, "length", Quantity::length);
  setup.noise_per_length = noise.size_or("length", Quantity::length_per_length, 0);
  noise.finish();
  for (TomlTable& entry : table.tables("station")) {
    Described::Station station;
    station.name = entry.text("name");
    refuse_twice(entry, setup.stations, station.name);
    station.body = read_body(entry, "mounted_on", Body::workpiece);
    station.position = read_setup_point(entry, "position", Knowledge::open, simulated, Eigen::Vector3d::Zero());
    entry.finish();
    setup.stations.push_back(station);
  }
  for (TomlTable& entry : table.tables("reflector")) {
    Described::Reflector reflector;
    reflector.name = entry.text("name");
    refuse_twice(entry, setup.reflectors, reflector.name);
    reflector.body = read_body(entry, "mounted_on", Body::tool);
    reflector.offset = read_setup_point(entry, "offset", Knowledge::exact, simulated);
    entry.finish();
    setup.reflectors.push_back(reflector);
  }
  if (setup.stations.empty()) table.fail("", "the stations are missing", "[[setup.station]] with name");
  if (setup.reflectors.empty()) {
    table.fail("", "the reflectors are missing", "[[setup.reflector]] with name and offset_mm");
  }
  for (TomlTable& entry : table.tables("run")) {
    Described::Run run;
    run.name = entry.text("name");
    refuse_twice(entry, setup.runs, run.name);
    run.station = read_name_of(entry, "station", setup.stations);
    run.reflector = read_name_of(entry, "reflector", setup.reflectors);
    refuse_same_body(entry, setup.stations[run.station].body, setup.reflectors[run.reflector].body);
    run.dead_path = read_setup_number(entry, "dead_path", Quantity::length, Knowledge::open, simulated, 0.0);
    entry.finish();
    setup.runs.push_back(run);
  }
  if (setup.runs.empty()) {
    table.fail("", "the runs are missing",
               "[[setup.run]] with name, station and reflector, one per uninterrupted beam");
  }
  return std::make_shared<TrackingInterferometer>(setup);
}

}  // namespace abbe
