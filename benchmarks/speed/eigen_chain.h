#pragma once

#include <Eigen/Core>
#include <vector>

#include "five_axis_case.h"

namespace abbe::benchmarks {

/// The baseline: the same model as one writes it with Eigen, one pose at a time, a product of 4x4 matrices.
///
/// Written without waste: basis functions once per axis and pose, one inverse per pose, constant matrices prepared.
class EigenChain {
 public:
  EigenChain(const Machine& machine, const ErrorSet& errors);
  /// workpiece_from_tool at the gauge point.
  /// @param positions  [5], mm or rad, chain order
  Eigen::Matrix4d workpiece_from_tool(const double* positions) const;

 private:
  struct OneAxis {
    bool rotary;
    double sense, centre, scale;  ///< Legendre argument (q - centre) * scale
    double zero_position = 0;
    Eigen::Vector3d direction;
    Eigen::Matrix<double, 6, 9> coefficients;
    Eigen::Matrix4d to_line, from_line;            ///< displaced axis line; rotary: through its point
    Eigen::Matrix4d to_reference, from_reference;  ///< of the error motion
  };
  Eigen::Matrix4d motion(const OneAxis& axis, double position) const;
  std::vector<OneAxis> workpiece_side_, tool_side_;  ///< from the bed outwards
  Eigen::Matrix4d bed_from_workpiece_, bed_from_gauge_;
};

}  // namespace abbe::benchmarks
