#pragma once

#include <string>

namespace abbe::benchmarks {

/// LinuxCNC's EmcPose: mm and degrees.
struct LinuxcncPose {
  double x, y, z, a, b, c, u, v, w;
};

/// LinuxCNC's shipped xyzac-trt-kins in this process: its module is opened and given the few functions of rtapi and HAL
/// that it asks for.
class LinuxcncKinematics {
 public:
  LinuxcncKinematics();
  /// Why it cannot be used; empty if it can.
  const std::string& problem() const { return problem_; }
  int inverse(const LinuxcncPose& world, double* joints) const { return inverse_(&world, joints, &none_, &none_); }
  int forward(const double* joints, LinuxcncPose& world) const { return forward_(joints, &world, &none_, &none_); }

 private:
  std::string problem_;
  int (*inverse_)(const LinuxcncPose*, double*, const unsigned long*, unsigned long*) = nullptr;
  int (*forward_)(const double*, LinuxcncPose*, const unsigned long*, unsigned long*) = nullptr;
  mutable unsigned long none_ = 0;
};

}  // namespace abbe::benchmarks
