#include "yin/printed.h"

#include <algorithm>
#include <cmath>

#include "abbe/geometry/rotation.h"

namespace abbe::yin_printed {
namespace {

Eigen::Matrix4d from_laser_to_a(const SwingHeadLinkage& l) {  // (1)
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<3, 1>(0, 3) << 0, l.beam_offset, l.focus_to_a;
  return m;
}

Eigen::Matrix4d from_a_to_c1(const SwingHeadLinkage& l, double a) {  // (2)
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<3, 3>(0, 0) = rotation_about(Eigen::Vector3d::UnitX(), a);
  m.block<3, 1>(0, 3) << l.a_to_c1, l.a_offset, 0;
  return m;
}

Eigen::Matrix4d from_c1_to_c2(const SwingHeadLinkage& l, const SwingHeadCommand& c) {  // (3)
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<3, 3>(0, 0) = rotation_about(Eigen::Vector3d::UnitZ(), c.c1);
  m.block<3, 1>(0, 3) << c.x + l.origin.x(), c.y + l.origin.y(), c.z + l.origin.z();
  return m;
}

}  // namespace

Eigen::Vector3d focus(const SwingHeadLinkage& l, const SwingHeadCommand& c) {
  const double sa = std::sin(c.a), ca = std::cos(c.a), s1 = std::sin(c.c1), c1 = std::cos(c.c1);
  return {c.x + l.origin.x() + l.a_to_c1 * c1 - l.a_offset * s1 - l.beam_offset * ca * s1 + l.focus_to_a * sa * s1,
          c.y + l.origin.y() + l.a_to_c1 * s1 + l.a_offset * c1 + l.beam_offset * ca * c1 - l.focus_to_a * sa * c1,
          c.z + l.origin.z() + l.focus_to_a * ca + l.beam_offset * sa};
}

void solve_linear(const SwingHeadLinkage& l, const Eigen::Vector3d& p, SwingHeadCommand& c) {
  const double sa = std::sin(c.a), ca = std::cos(c.a), s1 = std::sin(c.c1), c1 = std::cos(c.c1);
  c.x = p.x() - l.origin.x() - l.a_to_c1 * c1 + l.a_offset * s1 + l.beam_offset * ca * s1 - l.focus_to_a * sa * s1;
  c.y = p.y() - l.origin.y() - l.a_to_c1 * s1 - l.a_offset * c1 - l.beam_offset * ca * c1 + l.focus_to_a * sa * c1;
  c.z = p.z() - l.origin.z() - l.focus_to_a * ca - l.beam_offset * sa;
}

Eigen::Matrix4d chain(const SwingHeadLinkage& linkage, const SwingHeadCommand& command) {
  return from_c1_to_c2(linkage, command) * from_a_to_c1(linkage, command.a) * from_laser_to_a(linkage);
}

SwingHeadCommand inverse(const SwingHeadLinkage& linkage, const Eigen::Vector3d& point, const Eigen::Vector3d& beam) {
  SwingHeadCommand c;
  c.a = -std::acos(std::clamp(beam.z(), -1.0, 1.0));
  c.c1 = std::atan2(beam.x(), -beam.y());
  solve_linear(linkage, point, c);
  return c;
}

}  // namespace abbe::yin_printed
