#pragma once

#include <memory>

#include "abbe/instruments/observations.h"
#include "abbe/instruments/trackers/tracker.h"

namespace abbe {

/// Laser tracker readings as weighted residuals of the machine's errors, the station poses and the reflector offsets.
///
/// Modelled point in the tracker frame: x = R^T (seen - t), with `seen` the reflector seen from the station's body.
/// Unknowns: per estimated station "tracker1.x/.y/.z" (t, mm) and "tracker1.rx/.ry/.rz" (rad), a rotation vector w in
/// the frame of the body, on top of the rotation the station was given with: R = exp(w) R_given. Any rotation can be
/// reached, and there is no singular one below half a turn from the start. Per estimated reflector
/// "reflector1.offset_x/y/z" (mm).
///
/// Residuals per reading: 3. Cartesian: W (measured - x), W upper triangular with W^T W the inverse of the reading's
/// covariance. Range and angles: the same for (range, across the beam in azimuth, across the beam in elevation), where
/// the angles are 2 tan(a/2) components of the direction against the measured one: no jump at a whole turn or at the
/// pole, equal to the angle within a^3/12. Covariances from the noise model are taken at the measured point and stay
/// fixed.
class TrackerObservations : public Observations {
 public:
  /// @throws std::invalid_argument as validate()
  TrackerObservations(const Machine& machine, const ErrorSet& errors, TrackerSetup setup, TrackerReadings readings);
  ~TrackerObservations() override;

  std::string name() const override;
  std::size_t reading_count() const override;
  int rows() const override { return 3; }
  /// x, y, z; or along the beam and across it in azimuth and elevation: lengths all three.
  const std::vector<ReadingComponent>& components() const override;
  const std::vector<SetupUnknown>& unknowns() const override;
  std::vector<double> unknown_values() const override;
  std::vector<double> positions(std::size_t reading) const override;
  std::vector<double> deviation(std::size_t reading) const override;
  void set_parameters(std::span<const double> machine, std::span<const double> setup) override;
  void evaluate(std::size_t first, std::size_t count, std::span<const std::size_t> machine_parameters,
                std::span<const std::size_t> setup_parameters, double* residuals, double* jacobian,
                std::size_t stride) const override;
  std::optional<FactoredColumns> column_factors(std::span<const std::size_t> machine_parameters,
                                                std::span<const std::size_t> setup_parameters) const override;
  void evaluate_factored(std::size_t first, std::size_t count, std::span<const std::size_t> machine_parameters,
                         std::span<const std::size_t> setup_parameters, double* residuals,
                         const JacobianFactors& factors) const override;
  bool displacement_rows(std::size_t first, std::size_t count, double* rows_out) const override;
  std::vector<FurtherReadings> further_readings(const Machine& machine, const ErrorSet& errors) const override;
  std::optional<double> length_of_deviation(std::size_t reading) const override;

  /// The set-up with the present values of the unknowns.
  TrackerSetup setup() const;
  const TrackerReadings& readings() const;
  /// Distance measured - modelled of one reading in the tracker frame, not weighted, mm.
  Eigen::Vector3d distance(std::size_t reading) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace abbe
