#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "abbe/instruments/observations.h"

namespace abbe {

/// Readings of one set of observations that were taken at the same pose (equal axis commands, wherever they stand in
/// the data) or belong together otherwise, and what a displacement common to them does to their residuals.
///
/// With Z the rows of Observations::displacement_rows() of all used readings of a pose, [residuals, 3], the residuals
/// depend on the displacement along the directions Z u_j only, u_j and d_j the eigenvectors and eigenvalues of Z'Z.
class PoseGroups {
 public:
  struct Group {
    std::vector<std::size_t> readings;                   ///< ascending
    bool used = false;                                   ///< a reading that is not used is a group of its own
    Eigen::Vector3d squares = Eigen::Vector3d::Zero();   ///< d_j, 1/mm^2; exactly 0 along what is not seen
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< u_j, a column each
  };

  /// @param use     per reading, as SelectedObservations::use
  /// @param common  per reading, as SelectedObservations::common
  PoseGroups(const Observations& observations, const std::vector<std::uint8_t>& use,
             const std::vector<std::size_t>& common = {});

  /// Takes the derivatives anew at the present point of the observations.
  void update();

  const std::vector<Group>& groups() const { return groups_; }
  std::size_t group_of(std::size_t reading) const { return group_of_[reading]; }
  /// Z of one reading, [rows, 3] row-major, 1/mm.
  const double* displacement(std::size_t reading) const { return &displacement_[3 * rows_ * reading]; }
  std::size_t rows() const { return rows_; }
  /// The largest number of used readings at one pose that see a displacement.
  std::size_t most_readings() const;

 private:
  const Observations* observations_;
  std::size_t rows_;
  std::vector<Group> groups_;
  std::vector<std::size_t> group_of_;
  std::vector<double> displacement_;
};

}  // namespace abbe
