#include "abbe/formats/readings/tracker_file.h"

#include <fmt/format.h>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/instruments/trackers/laser_tracker.h"

namespace abbe {
namespace {

/// Index of a name among things with names; adds nothing.
template <typename Things>
std::size_t find_name(const Things& things, const std::string& name) {
  for (std::size_t i = 0; i < things.size(); ++i) {
    if (things[i].name == name) return i;
  }
  return things.size();
}

// mm; files state offsets with fewer digits than the study may have.
constexpr double kSameOffset = 1e-3;

/// @param tracker         with what the file says of reflectors and their offsets
/// @param contradictions  in words, where file and study differ; added to
TrackerReadings readings_from_table(const MeasurementTable& table, const std::string& setup, bool noise_from_data,
                                    const std::string& file, TrackerSetup& tracker,
                                    std::vector<std::string>& contradictions) {
  const std::size_t given = tracker.reflectors.size();
  std::vector<std::uint16_t> station_index, reflector_index;
  for (const std::string& name : table.stations) {
    std::size_t index = name.empty() && tracker.stations.size() == 1 ? 0 : find_name(tracker.stations, name);
    if (index == tracker.stations.size()) {
      throw InputError({.file = file, .field = "station"}, fmt::format("station '{}' is not in the study", name),
                       "a station of set-up '" + setup + "'");
    }
    station_index.push_back(static_cast<std::uint16_t>(index));
  }
  for (std::size_t i = 0; i < table.reflectors.size(); ++i) {
    const std::string& name = table.reflectors[i];
    std::size_t index = name.empty() && tracker.reflectors.size() == 1 ? 0 : find_name(tracker.reflectors, name);
    const bool has_offset = !table.reflector_offset.empty();
    if (index == tracker.reflectors.size()) {
      if (!has_offset) {
        throw InputError({.file = file, .field = "reflector"}, fmt::format("reflector '{}' is not in the study", name),
                         "a reflector of set-up '" + setup + "', or offset columns in the file");
      }
      Reflector reflector;
      reflector.name = name;
      reflector.body = tracker.stations.front().body == Body::tool ? Body::workpiece : Body::tool;
      reflector.offset_from_data = true;
      tracker.reflectors.push_back(reflector);
    }
    Reflector& reflector = tracker.reflectors[index];
    const bool from_data = index >= given || reflector.offset_from_data;
    if (has_offset && from_data) reflector.offset = table.reflector_offset[i];
    if (has_offset && !from_data && !reflector.estimate_offset &&
        (table.reflector_offset[i] - reflector.offset).norm() > kSameOffset) {
      contradictions.push_back(fmt::format(
          "the offset of reflector {} is ({}) mm in {} and ({}) mm in the study, which is used (offset = \"from-data\" "
          "uses that of the file)",
          reflector.name, fmt::join(table.reflector_offset[i], ", "), file, fmt::join(reflector.offset, ", ")));
    }
    reflector_index.push_back(static_cast<std::uint16_t>(index));
  }

  TrackerReadings readings = table.readings;
  if (!noise_from_data) {
    readings.stated = StatedUncertainty::none;
    readings.uncertainty = {};
  } else if (readings.stated == StatedUncertainty::none) {
    throw InputError({.file = file}, "the study takes the noise from the data, but the file states no uncertainties",
                     readings.measure == TrackerMeasure::cartesian
                         ? "columns u_x_um, u_y_um, u_z_um or cov_xx_um2, ..."
                         : "columns u_range_um, u_azimuth_arcsec, u_elevation_arcsec or cov_range_range_um2, ...");
  }
  for (std::uint16_t& station : readings.station) station = station_index[station];
  for (std::uint16_t& reflector : readings.reflector) reflector = reflector_index[reflector];
  return readings;
}

/// The registry of instruments gives trackers to the functions below, and nothing else.
const LaserTracker& as_tracker(const Instrument& device) { return static_cast<const LaserTracker&>(device); }

}  // namespace

InstrumentFile read_tracker_file(const std::filesystem::path& path, const Machine& machine,
                                 const std::shared_ptr<const Instrument>& device, const std::string& setup,
                                 bool noise_from_data, const MeasurementOptions& options) {
  const MappedFile file(path);
  return parse_tracker_file(file.text(), path.string(), machine, device, setup, noise_from_data, options);
}

InstrumentFile parse_tracker_file(std::string_view text, const std::string& name, const Machine& machine,
                                  const std::shared_ptr<const Instrument>& device, const std::string& setup,
                                  bool noise_from_data, const MeasurementOptions& options) {
  const LaserTracker& given = as_tracker(*device);
  const MeasurementTable table = parse_measurements(text, name, machine, options);
  TrackerSetup tracker = given.setup();
  InstrumentFile file;
  const TrackerReadings readings =
      readings_from_table(table, setup, noise_from_data, name, tracker, file.contradictions);
  const auto with_file =
      std::make_shared<LaserTracker>(given.name(), std::move(tracker), readings.measure, given.stated());
  file.readings = with_file->instrument_readings(readings);
  file.device = with_file;
  return file;
}

std::string tracker_file_text(const Machine& machine, const Instrument& device, const InstrumentReadings& readings) {
  const LaserTracker& tracker = as_tracker(device);
  const TrackerSetup setup = tracker.setup();
  MeasurementTable table;
  table.readings = tracker.tracker_readings(readings);
  table.stations = tracker.station_names();
  for (const Reflector& reflector : setup.reflectors) {
    table.reflectors.push_back(reflector.name);
    table.reflector_offset.push_back(reflector.offset);
  }
  return measurements_text(machine, table);
}

}  // namespace abbe
