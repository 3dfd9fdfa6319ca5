#include "abbe/identify/linkage/swing_head_linkage.h"

#include <cmath>
#include <stdexcept>

namespace abbe {
namespace {

/// Sense of Z against the physical height: the focus is below the head in U, above it in P as printed.
double side(LinkageConvention convention) { return convention == LinkageConvention::table_moves ? -1.0 : 1.0; }

std::size_t axis_named(const Machine& machine, const char* name) {
  const std::size_t axis = machine.find_axis(name);
  if (axis == Machine::npos) throw std::invalid_argument(machine.name + " has no axis " + name);
  return axis;
}

}  // namespace

std::array<double, SwingHeadLinkage::kCount> SwingHeadLinkage::values() const {
  return {focus_to_a, a_to_c1, beam_offset, a_offset, origin.x(), origin.y(), origin.z()};
}

SwingHeadLinkage SwingHeadLinkage::of(const std::array<double, kCount>& v) {
  return {v[0], v[1], v[2], v[3], {v[4], v[5], v[6]}};
}

const char* linkage_name(std::size_t index) {
  constexpr std::array<const char*, SwingHeadLinkage::kCount> kNames = {"R_A", "R_C1", "L_tA", "L_AC1",
                                                                        "x0",  "y0",   "z0"};
  return kNames.at(index);
}

Eigen::Vector3d swing_head_focus(const SwingHeadLinkage& linkage, LinkageConvention convention,
                                 const SwingHeadCommand& command) {
  const double s = side(convention);
  const double sin_a = std::sin(command.a), cos_a = std::cos(command.a);
  const double sin_c = std::sin(command.c1), cos_c = std::cos(command.c1);
  const double along = linkage.a_to_c1;
  const double across = linkage.a_offset + linkage.beam_offset * cos_a - s * linkage.focus_to_a * sin_a;
  const double up = linkage.beam_offset * sin_a + s * linkage.focus_to_a * cos_a;
  return Eigen::Vector3d(along * cos_c - across * sin_c, along * sin_c + across * cos_c, up) +
         Eigen::Vector3d(linkage.origin.x() + s * command.x, linkage.origin.y() + s * command.y,
                         command.z + s * linkage.origin.z());
}

Eigen::Vector3d swing_head_beam(const SwingHeadCommand& command) {
  return {std::sin(command.a) * std::sin(command.c1), -std::sin(command.a) * std::cos(command.c1), std::cos(command.a)};
}

SwingHeadCommand swing_head_command(const SwingHeadLinkage& linkage, LinkageConvention convention,
                                    const Eigen::Vector3d& point, const Eigen::Vector3d& beam, int sign,
                                    double held_c1) {
  const double across = std::hypot(beam.x(), beam.y());
  SwingHeadCommand c;
  c.a = std::atan2(sign * across, beam.z());
  c.c1 = across > 0 ? std::atan2(sign * beam.x(), -sign * beam.y()) : held_c1;
  const Eigen::Vector3d missing = point - swing_head_focus(linkage, convention, c);
  const double s = side(convention);
  c.x = s * missing.x();
  c.y = s * missing.y();
  c.z = missing.z();
  return c;
}

void set_linkage(Machine& machine, const SwingHeadLinkage& linkage, LinkageConvention convention) {
  const double s = side(convention);
  Axis& c1 = machine.axes[axis_named(machine, "C1")];
  Axis& a = machine.axes[axis_named(machine, "A")];
  c1.point = {linkage.origin.x(), linkage.origin.y(), s * linkage.origin.z()};
  a.point = c1.point + Eigen::Vector3d(linkage.a_to_c1, linkage.a_offset, 0);
  machine.tool_reference = a.point;
  machine.tool_offset = {0, linkage.beam_offset, s * linkage.focus_to_a};
  machine.tool_direction = Eigen::Vector3d::UnitZ();
}

SwingHeadLinkage linkage_of(const Machine& machine, LinkageConvention convention) {
  const double s = side(convention);
  const Eigen::Vector3d& c1 = machine.axes[axis_named(machine, "C1")].point;
  const Eigen::Vector3d& a = machine.axes[axis_named(machine, "A")].point;
  const Eigen::Vector3d focus = machine.tool_reference + machine.tool_offset;
  // The place of a point along its own axis means nothing: R_C1 is that of the beam.
  return {s * (focus.z() - a.z()), focus.x() - c1.x(), focus.y() - a.y(), a.y() - c1.y(), {c1.x(), c1.y(), s * a.z()}};
}

}  // namespace abbe
