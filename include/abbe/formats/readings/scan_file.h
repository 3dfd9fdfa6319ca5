#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>

#include "abbe/formats/text/csv_reader.h"
#include "abbe/instruments/point_scan.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// What is written for each point.
enum class ScanFormat { csv, ply };

/// Format by the extension. @throws InputError unless it is .csv or .ply
ScanFormat scan_format(const std::filesystem::path& path);

struct ScanOptions {
  ColumnMapping mapping;
  bool check_travel = true;  ///< refuse commands outside an axis's travel
  /// Indications outside of this range are no measurement (mm): the probe's range of measurement.
  double lowest_indication = -std::numeric_limits<double>::infinity();
  double highest_indication = std::numeric_limits<double>::infinity();
  int decimals = 9;  ///< of a coordinate in mm in CSV, 0 to 12: 9 are a picometre
  int threads = 0;   ///< 0: all; the result does not depend on it
  std::function<void(std::size_t done, std::size_t total)> progress;  ///< in bytes of the readings
};

/// What became of the readings.
struct ScanSummary {
  std::size_t readings = 0;      ///< rows of the file
  std::size_t points = 0;        ///< written
  std::size_t out_of_range = 0;  ///< left out: indication outside of the probe's range
  std::size_t not_covered = 0;   ///< left out: position outside the range in which an error motion is known
  /// mm, corners of the box around the points; meaningless without points
  Eigen::Vector3d lowest = Eigen::Vector3d::Zero(), highest = Eigen::Vector3d::Zero();
};

/// Points of a scan: reads a CSV with the axis commands (`X_mm`, `C_deg`) and `indication_mm` (or _um) and writes the
/// points in the workpiece frame as CSV (x_mm,y_mm,z_mm) or PLY (binary, double), in the order of the readings.
///
/// Neither the readings nor the points are ever in memory as a whole: the file is passed in runs of lines of about 1
/// MiB, which the threads read, transform and format side by side. The output appears whole or not at all.
/// @throws InputError for what is wrong in the readings and for an output that cannot be written
ScanSummary scan_points(const std::filesystem::path& readings, const Machine& machine, const PointScan& scan,
                        const std::filesystem::path& output, const ScanOptions& options = {});

/// The same from text to pieces of the output, as often as there is one.
/// @param file   name for messages
/// @param write  called with one piece after the other, from any of the threads
ScanSummary scan_points(std::string_view text, const std::string& file, const Machine& machine, const PointScan& scan,
                        ScanFormat format, const ScanOptions& options,
                        const std::function<void(std::string_view)>& write,
                        const std::function<void(std::size_t)>& passed = {});

/// Header of the PLY file, of the same length for any number of points.
std::string scan_ply_header(std::size_t points);

}  // namespace abbe
