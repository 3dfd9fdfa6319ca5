#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/formats/readings/channel_file.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/instruments/trackers/tracker.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Readings of an instrument that sees points, in the order of the file, and the names in it.
struct MeasurementTable {
  TrackerReadings readings;             ///< station and reflector are indices into the names below
  std::vector<std::string> stations;    ///< in order of appearance; one unnamed ("") if the file has no column
  std::vector<std::string> reflectors;  ///< likewise; "offset1", ... where only offsets are given
  std::vector<Eigen::Vector3d>
      reflector_offset;  ///< [reflectors.size()] mm, or empty if the file has no offset columns
};

struct MeasurementOptions {
  ColumnMapping mapping;
  bool check_travel = true;  ///< refuse commands outside an axis's travel
  int threads = 0;           ///< 0: all
  ChannelUse channels{};     ///< states by the times of the readings; not of files of poses
};

/// Reads a measurement CSV: see docs/formats.md. Every row counts or is an error; rows keep their order. @throws
/// InputError
MeasurementTable read_measurements(const std::filesystem::path& path, const Machine& machine,
                                   const MeasurementOptions& options = {});
/// The same from text. @param file  name for messages
MeasurementTable parse_measurements(std::string_view text, const std::string& file, const Machine& machine,
                                    const MeasurementOptions& options = {});

/// CSV text of a table, mm and deg, uncertainties in um and arcsec; shortest decimals. Reads back to the same bits for
/// lengths, to one unit in the last place for angles.
std::string measurements_text(const Machine& machine, const MeasurementTable& table);

/// Poses from a CSV with one column per axis. @throws InputError
PoseList read_poses(const std::filesystem::path& path, const Machine& machine, const MeasurementOptions& options = {});
PoseList parse_poses(std::string_view text, const std::string& file, const Machine& machine,
                     const MeasurementOptions& options = {});

}  // namespace abbe
