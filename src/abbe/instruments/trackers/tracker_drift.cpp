#include "abbe/instruments/trackers/tracker_drift.h"

namespace abbe {

using Eigen::Vector3d;

void move_reflectors(const ReadingDrift& drift, std::size_t first, std::span<const std::uint16_t> at,
                     double (*seen)[Observations::kBlockSize], double (*unmoved)[Observations::kBlockSize]) {
  for (std::size_t k = 0; k < at.size(); ++k) {
    for (int c = 0; c < 3; ++c) unmoved[c][k] = seen[c][k];
    const Vector3d moved = drift.seen(first + at[k], {seen[0][k], seen[1][k], seen[2][k]});
    for (int c = 0; c < 3; ++c) seen[c][k] = moved[c];
  }
}

void take_tracker_drift(const ReadingDrift& drift, std::size_t first, std::span<const std::uint16_t> at,
                        const double (*seen)[Observations::kBlockSize], const DriftColumns& columns,
                        double (*force)[3][Observations::kBlockSize]) {
  for (std::size_t k = 0; k < at.size(); ++k) {
    const std::size_t reading = first + at[k];
    const Vector3d point(seen[0][k], seen[1][k], seen[2][k]);
    const Eigen::Matrix3d turn = drift.turn(reading);
    for (std::size_t row = 0; row < 3; ++row) {
      const Vector3d of_row(force[row][0][k], force[row][1][k], force[row][2][k]);
      const Eigen::Matrix<double, 6, 1> slopes = drift.slopes(reading, point, of_row, Vector3d::Zero());
      for (std::size_t i = 0; i < columns.unknowns.size(); ++i) {
        if (columns.unknowns[i] < columns.first) continue;
        const std::size_t unknown = columns.unknowns[i] - columns.first;
        columns.target[i * columns.stride + row * at.size() + k] =
            drift.weight(unknown, reading) * slopes[drift.component_of(unknown)];
      }
      const Vector3d back = turn * of_row;
      for (int c = 0; c < 3; ++c) force[row][c][k] = back[c];
    }
  }
}

}  // namespace abbe
