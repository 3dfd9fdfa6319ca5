#pragma once

#include <memory>
#include <vector>

#include "abbe/identify/pose_groups.h"

namespace abbe {

/// Variances of readings, where the uncertainties stated for them are not the whole truth.
struct ReadingVariance {
  double factor = 1;  ///< variance factor: multiplies the stated covariance of every reading
  double pose = 0;    ///< mm^2, of each coordinate of a displacement common to all readings at one pose or of one block
  bool operator==(const ReadingVariance&) const = default;
};

/// Variances, and the point at which the derivatives by the common displacement are taken that belong to them.
struct WeighingPoint {
  ReadingVariance variance;
  bool is_known = false;        ///< the point; it counts for nothing without pose variance
  std::vector<double> machine;  ///< of ErrorSet::parameters(), mm or rad
  std::vector<double> setup;    ///< of Observations::unknowns(), mm or rad
  bool operator==(const WeighingPoint&) const = default;
};

/// Other observations, weighted with the covariance factor S + pose Z Z' of all readings at one pose.
///
/// S is the covariance stated for the readings (block diagonal), Z their derivatives by the common displacement
/// (PoseGroups). Residuals and Jacobian are multiplied with the symmetric root of the inverse, in closed form per pose:
/// with z = S^-1/2 Z and z'z = U D U',
///
///     (factor I + pose z z')^-1/2 = (I - z U diag((1 - (1 + pose/factor d)^-1/2) / d) U' z') / sqrt(factor)
///
/// so that they are uncorrelated with variance 1. z is held at the values it had in weigh(): derivatives are exact.
/// Readings that are not used take no part in the weighting of others. Everything not weighted is that of the others.
class WeighedObservations : public Observations {
 public:
  /// @param use     per reading, as SelectedObservations::use
  /// @param common  per reading, as SelectedObservations::common
  WeighedObservations(std::shared_ptr<Observations> observations, const std::vector<std::uint8_t>& use,
                      const std::vector<std::size_t>& common = {});

  /// Sets the variances, and z at the present point.
  /// @param variance  factor > 0, pose >= 0
  void weigh(const ReadingVariance& variance);
  /// The same after a move to that point, if it is known.
  void weigh_at(const WeighingPoint& at);
  /// What weigh() was given last, and where; known if set_parameters() was called before.
  const WeighingPoint& weights() const { return weights_; }
  const PoseGroups& poses() const { return poses_; }
  /// The observations as stated.
  const std::shared_ptr<Observations>& stated() const { return observations_; }

  std::string name() const override { return observations_->name(); }
  std::size_t reading_count() const override { return observations_->reading_count(); }
  int rows() const override { return observations_->rows(); }
  const std::vector<ReadingComponent>& components() const override { return observations_->components(); }
  const std::vector<SetupUnknown>& unknowns() const override { return observations_->unknowns(); }
  std::vector<double> unknown_values() const override { return observations_->unknown_values(); }
  std::vector<double> positions(std::size_t reading) const override { return observations_->positions(reading); }
  std::vector<double> deviation(std::size_t reading) const override { return observations_->deviation(reading); }
  void deviations(std::size_t first, std::size_t count, double* out) const override {
    observations_->deviations(first, count, out);
  }
  void set_parameters(std::span<const double> machine, std::span<const double> setup) override;
  void evaluate(std::size_t first, std::size_t count, std::span<const std::size_t> machine_parameters,
                std::span<const std::size_t> setup_parameters, double* residuals, double* jacobian,
                std::size_t stride) const override;

 private:
  std::shared_ptr<Observations> observations_;
  PoseGroups poses_;
  bool point_is_known_ = false;
  std::vector<double> machine_, setup_;  // the present point
  WeighingPoint weights_;
  std::vector<Eigen::Matrix3d> taken_;  ///< per group: U diag(...) U'
};

}  // namespace abbe
