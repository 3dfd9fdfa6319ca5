#pragma once

#include <string>

#include "step_reading.h"

namespace abbe {

struct GeometryCheckOptions {
  std::string file;
  std::string unit;  ///< "mm", "m", "inch", or empty where the file states it or mm is assumed
  StepReading step;
  bool json = false;
};

/// Reads a point cloud or a mesh and says what it is. @returns kNegative for a mesh in which inside and outside are not
/// told apart everywhere or of which faces were left out. @throws InputError
int check_geometry(const GeometryCheckOptions& options);

}  // namespace abbe
