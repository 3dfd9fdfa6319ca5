#pragma once

#include <string>

#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "column_options.h"
#include "step_reading.h"

namespace abbe {

class Subcommand;

/// The two files of a command that compares a scan with a part.
struct ScanFiles {
  std::string scan, part;
  std::string scan_unit, part_unit;  ///< "mm", "m", "inch", or empty
  ColumnOptions columns;             ///< of the scan
  int threads = 0;
  StepReading step;

  PointCloudOptions scan_options() const;
  PointCloudFile read_scan() const;
  MeshFile read_part() const;
};

/// Adds the arguments `scan` and `part` and their options.
void add_scan_files(Subcommand* command, ScanFiles& files);

}  // namespace abbe
