#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"

namespace abbe {

/// A circle of radius 100 mm in one plane, driven with two linear axes about the middle of their travel; A, B and C
/// stand at 0. The bar sits between the tool point and a socket on the workpiece where the tool nominally is at the
/// centre.
struct WangCircle {
  std::string plane;              ///< "XY", "YZ", "ZX"
  std::vector<double> deviation;  ///< bar length less 100 mm as indicated, [360] by degrees, mm
  double circular = 0;            ///< ISO 230-4 circular deviation G about the least-squares centre, mm
  bool converged = false;         ///< G exists
};

/// What a ball bar would read with these errors, in three planes.
std::vector<WangCircle> wang_ball_bar(const ErrorSet& errors);

}  // namespace abbe
