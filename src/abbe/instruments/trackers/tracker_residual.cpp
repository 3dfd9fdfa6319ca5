#include "abbe/instruments/trackers/tracker_residual.h"

#include <cmath>

#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

/// The 27 numbers of a pose in local variables: the loops then run without reloading them.
struct Columns {
  double r[3][3];  ///< r[row][column] of body_from_tracker
  double t[3];
  explicit Columns(const StationPose& station) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) r[i][j] = station.body_from_tracker(i, j);
      t[i] = station.origin[i];
    }
  }
};

void cartesian(const Columns& c, const ResidualInput& in, const ResidualOutput& out) {
  for (std::size_t k = 0; k < in.count; ++k) {
    const double d0 = in.seen[0][k] - c.t[0], d1 = in.seen[1][k] - c.t[1], d2 = in.seen[2][k] - c.t[2];
    const double e0 = in.measured[0][k] - (c.r[0][0] * d0 + c.r[1][0] * d1 + c.r[2][0] * d2);
    const double e1 = in.measured[1][k] - (c.r[0][1] * d0 + c.r[1][1] * d1 + c.r[2][1] * d2);
    const double e2 = in.measured[2][k] - (c.r[0][2] * d0 + c.r[1][2] * d1 + c.r[2][2] * d2);
    out.residual[0][k] = in.weight[0][k] * e0 + in.weight[1][k] * e1 + in.weight[2][k] * e2;
    out.residual[1][k] = in.weight[3][k] * e1 + in.weight[4][k] * e2;
    out.residual[2][k] = in.weight[5][k] * e2;
  }
  if (out.force[0][0] == nullptr) return;
  for (int i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < in.count; ++k) {
      out.force[0][i][k] = in.weight[0][k] * c.r[i][0] + in.weight[1][k] * c.r[i][1] + in.weight[2][k] * c.r[i][2];
      out.force[1][i][k] = in.weight[3][k] * c.r[i][1] + in.weight[4][k] * c.r[i][2];
      out.force[2][i][k] = in.weight[5][k] * c.r[i][2];
    }
  }
}

void polar(const Columns& c, const ResidualInput& in, const ResidualOutput& out) {
  for (std::size_t k = 0; k < in.count; ++k) {
    const double d0 = in.seen[0][k] - c.t[0], d1 = in.seen[1][k] - c.t[1], d2 = in.seen[2][k] - c.t[2];
    const double x = c.r[0][0] * d0 + c.r[1][0] * d1 + c.r[2][0] * d2;
    const double y = c.r[0][1] * d0 + c.r[1][1] * d1 + c.r[2][1] * d2;
    const double z = c.r[0][2] * d0 + c.r[1][2] * d1 + c.r[2][2] * d2;
    const double sa = in.sines[0][k], ca = in.cosines[0][k], se = in.sines[1][k], ce = in.cosines[1][k];
    // A modelled point in the station or exactly behind it has no direction: keep the numbers finite.
    const double range = std::fmax(std::sqrt(x * x + y * y + z * z), 1e-9);
    const double inverse = 1.0 / range;
    const double u0 = x * inverse, u1 = y * inverse, u2 = z * inverse;
    const double along = ce * (ca * u0 + sa * u1) + se * u2;
    const double a = ca * u1 - sa * u0;
    const double b = ce * u2 - se * (ca * u0 + sa * u1);
    const double g = 2.0 / std::fmax(1.0 + along, 1e-9);
    const double e0 = in.measured[0][k] - range, e1 = -g * a, e2 = -g * b;
    const double w00 = in.weight[0][k], w01 = in.weight[1][k], w02 = in.weight[2][k];
    const double w11 = in.weight[3][k], w12 = in.weight[4][k], w22 = in.weight[5][k];
    out.residual[0][k] = w00 * e0 + w01 * e1 + w02 * e2;
    out.residual[1][k] = w11 * e1 + w12 * e2;
    out.residual[2][k] = w22 * e2;
    if (out.force[0][0] == nullptr) continue;
    // d(g a) = g (da - (g a / 2) d(along)); da = (e_azimuth - a u) / range, and so on.
    const double s = g * inverse, ha = 0.5 * g * a, hb = 0.5 * g * b;
    const double r0 = ce * ca, r1 = ce * sa;
    const double p0 = s * (-sa - a * u0 - ha * (r0 - along * u0));
    const double p1 = s * (ca - a * u1 - ha * (r1 - along * u1));
    const double p2 = s * (-a * u2 - ha * (se - along * u2));
    const double q0 = s * (-se * ca - b * u0 - hb * (r0 - along * u0));
    const double q1 = s * (-se * sa - b * u1 - hb * (r1 - along * u1));
    const double q2 = s * (ce - b * u2 - hb * (se - along * u2));
    const double h[3][3] = {
        {w00 * u0 + w01 * p0 + w02 * q0, w00 * u1 + w01 * p1 + w02 * q1, w00 * u2 + w01 * p2 + w02 * q2},
        {w11 * p0 + w12 * q0, w11 * p1 + w12 * q1, w11 * p2 + w12 * q2},
        {w22 * q0, w22 * q1, w22 * q2}};
    for (int row = 0; row < 3; ++row) {
      for (int i = 0; i < 3; ++i) {
        out.force[row][i][k] = c.r[i][0] * h[row][0] + c.r[i][1] * h[row][1] + c.r[i][2] * h[row][2];
      }
    }
  }
}

}  // namespace

Eigen::Matrix3d rotation_vector_axes(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d k = skew(w);
  if (angle < 1e-4) return Eigen::Matrix3d::Identity() + 0.5 * k + k * k / 6.0;
  const double square = angle * angle;
  return Eigen::Matrix3d::Identity() + (1 - std::cos(angle)) / square * k +
         (angle - std::sin(angle)) / (square * angle) * k * k;
}

void tracker_residuals(TrackerMeasure measure, const StationPose& station, const ResidualInput& in,
                       const ResidualOutput& out) {
  const Columns columns(station);
  if (measure == TrackerMeasure::cartesian) {
    cartesian(columns, in, out);
  } else {
    polar(columns, in, out);
  }
}

}  // namespace abbe
