#include "yin/equations.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/geometry/angle.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "yin/constants.h"
#include "yin/printed.h"
#include "yin/reference.h"

namespace abbe {
namespace {

/// Poses over the whole range of A and C1.
std::vector<SwingHeadCommand> test_poses() {
  std::vector<SwingHeadCommand> poses;
  for (int i = -4; i <= 4; ++i) {
    for (int k = -5; k <= 6; ++k)
      poses.push_back({31.0 * i, -17.0 * k, 200.0 + i * k, i * 22.0 * kDegree, k * kDegree * 30});
  }
  return poses;
}

/// (1) by what (12) says of step 5: with A = 0 and C1 = 90 degrees the focus is on the board, h above the centre of C2.
YinEquation check_first(const SwingHeadLinkage& l) {
  const double h = yin::kBoard;
  SwingHeadCommand c;
  c.c1 = std::numbers::pi / 2;
  c.x = l.origin.x() - l.beam_offset - l.a_offset;  // (12)
  c.y = l.origin.y() + l.a_to_c1;
  c.z = l.origin.z() + l.focus_to_a + h;
  const auto off = [&](double r_a) {
    // (1) with R_A of this sign, (2), and (3) as its words define it where X and Y carry the table.
    const Eigen::Vector3d in_c1(l.a_to_c1, l.a_offset + l.beam_offset, r_a);
    const Eigen::Vector3d p = rotation_about(Eigen::Vector3d::UnitZ(), c.c1) * in_c1 +
                              Eigen::Vector3d(l.origin.x() - c.x, l.origin.y() - c.y, c.z - l.origin.z());
    return (p - Eigen::Vector3d(0, 0, h)).norm();
  };
  return {"(1)",
          false,
          "(0, L_tA, R_A)",
          "(0, L_tA, -R_A): the focus is below the axis of A where Z points upwards",
          "(12) puts the focus of step 5 on the board",
          off(l.focus_to_a),
          off(-l.focus_to_a),
          "mm"};
}

YinEquation check_second(const SwingHeadLinkage& l) {
  // The focus moves at right angles to axis and lever, as fast as the lever is long.
  double off = 0;
  for (SwingHeadCommand c : test_poses()) {
    const Eigen::Vector3d axis = rotation_about(Eigen::Vector3d::UnitZ(), c.c1) * Eigen::Vector3d::UnitX();
    SwingHeadLinkage bare = l;
    bare.focus_to_a = bare.beam_offset = 0;
    const Eigen::Vector3d lever =
        yin_printed::chain(l, c).block<3, 1>(0, 3) - yin_printed::chain(bare, c).block<3, 1>(0, 3);
    constexpr double kStep = 1e-4;
    SwingHeadCommand up = c, down = c;
    up.a += kStep;
    down.a -= kStep;
    const Eigen::Vector3d speed =
        (yin_printed::chain(l, up) - yin_printed::chain(l, down)).block<3, 1>(0, 3) / (2 * std::sin(kStep));
    off = std::max(off, (speed - axis.cross(lever)).norm());
  }
  return {"(2)",
          true,
          "Rx(A), (R_C1, L_AC1, 0)",
          "as printed",
          "finite differences: d(focus)/dA = axis x lever, 108 poses",
          off,
          off,
          "mm"};
}

YinEquation check_third(const SwingHeadLinkage& l) {
  // x0, y0, z0 are defined as the positions at which the origin of C1CS is the centre of C2.
  const SwingHeadCommand there = {l.origin.x(), l.origin.y(), l.origin.z(), 0, 0};
  SwingHeadLinkage bare;
  bare.origin = l.origin;
  const double printed = yin_printed::chain(bare, there).block<3, 1>(0, 3).norm();
  const Eigen::Vector3d right(l.origin.x() - there.x, l.origin.y() - there.y, there.z - l.origin.z());
  return {"(3)",
          false,
          "(X + x0, Y + y0, Z + z0)",
          "(x0 - X, y0 - Y, Z - z0) where X and Y carry the table; (X - x0, ...) where they carry the head",
          "x0, y0, z0 are the positions at which both origins coincide",
          printed,
          right.norm(),
          "mm"};
}

YinEquation check_fifth(const SwingHeadLinkage& l) {
  double off = 0;
  for (const SwingHeadCommand& c : test_poses()) {
    const Eigen::Matrix4d product = yin_printed::chain(l, c);
    off = std::max(off, (product.block<3, 1>(0, 3) - yin_printed::focus(l, c)).norm());
    off = std::max(off, 1e3 * (product.block<3, 1>(0, 2) - swing_head_beam(c)).norm());
  }
  return {"(4), (5)",
          true,
          "product of (3), (2), (1)",
          "as printed, with what is wrong in (1) and (3) in it",
          "the matrices multiplied, 108 poses",
          off,
          off,
          "mm"};
}

YinEquation check_sixth_angles(const SwingHeadLinkage& l) {
  double printed = 0, right = 0;
  for (const YinPoint& point : yin_curve()) {
    const SwingHeadCommand six = yin_printed::inverse(l, point.point, point.normal);
    printed = std::max(printed, angle_between(swing_head_beam(six), point.normal));
    for (const int sign : {1, -1}) {
      const SwingHeadCommand c = swing_head_command(l, LinkageConvention::head_moves, point.point, point.normal, sign);
      right = std::max(right, angle_between(swing_head_beam(c), point.normal));
    }
  }
  return {"(6), A and C1",
          false,
          "A = -arccos k, C1 = arctan(i, -j)",
          "A = atan2(hypot(i, j), k) with C1 = atan2(i, -j), or A = -atan2(hypot(i, j), k) with C1 = atan2(-i, j)",
          "put into (5): beams of Table A4",
          printed / kDegree,
          right / kDegree,
          "deg"};
}

YinEquation check_sixth_lengths(const SwingHeadLinkage& l) {
  double off = 0;
  for (const SwingHeadCommand& c : test_poses()) {
    SwingHeadCommand found = c;
    yin_printed::solve_linear(l, yin_printed::chain(l, c).block<3, 1>(0, 3), found);
    off = std::max(off, Eigen::Vector3d(found.x - c.x, found.y - c.y, found.z - c.z).norm());
  }
  return {"(6), X, Y, Z",
          true,
          "inverse of (5) at given A, C1",
          "as printed, with what is wrong in (1) and (3) in it",
          "put into (5), 108 poses",
          off,
          off,
          "mm"};
}

YinEquation check_seventh() {
  // A point of the table that C2 has turned must keep its coordinates in BCS, which turns with the table.
  const Eigen::Vector3d on_table(100, 0, 0);
  const double c2 = std::numbers::pi / 2;
  const Eigen::Vector3d now = rotation_about(Eigen::Vector3d::UnitZ(), c2) * on_table;
  return {"(7)",
          false,
          "Rz(+C2)",
          "Rz(-C2); the printed sign holds only if +C2 turns the table by -C2 about Z, as ISO 841 counts an axis that "
          "carries the workpiece",
          "a point of the table, 100 mm from the axis, C2 = 90 degrees, keeps its place in BCS",
          (rotation_about(Eigen::Vector3d::UnitZ(), c2) * now - on_table).norm(),
          (rotation_about(Eigen::Vector3d::UnitZ(), -c2) * now - on_table).norm(),
          "mm"};
}

YinEquation check_eighth() {
  double off = 0;
  for (int i = 0; i < 60; ++i) {
    const double a = 0.1 * i, b = 0.05 * i - 1.5, g = 0.3 * i;
    const double sa = std::sin(a), ca = std::cos(a), sb = std::sin(b), cb = std::cos(b), sg = std::sin(g),
                 cg = std::cos(g);
    Eigen::Matrix3d printed;
    printed << cb * cg, -cb * sg, sb, ca * sg + sa * sb * cg, ca * cg - sa * sb * sg, -sa * cb, sa * sg - ca * sb * cg,
        sa * cg + ca * sb * sg, ca * cb;
    const Eigen::Matrix3d product = rotation_about(Eigen::Vector3d::UnitX(), a) *
                                    rotation_about(Eigen::Vector3d::UnitY(), b) *
                                    rotation_about(Eigen::Vector3d::UnitZ(), g);
    off = std::max(off, (printed - product).norm());
  }
  return {"(8)",
          true,
          "Rx(alpha) Ry(beta) Rz(gamma)",
          "as printed",
          "the rotations multiplied, 60 triples of angles",
          off / kDegree,
          off / kDegree,
          "deg"};
}

}  // namespace

std::vector<YinEquation> yin_equations() {
  const SwingHeadLinkage l = yin_linkage();
  return {check_first(l),        check_second(l),        check_third(l),  check_fifth(l),
          check_sixth_angles(l), check_sixth_lengths(l), check_seventh(), check_eighth()};
}

}  // namespace abbe
