#pragma once

#include <string>
#include <vector>

#include "abbe/instruments/equation_instrument.h"
#include "abbe/instruments/trackers/tracker.h"

namespace abbe {

/// Laser trackers that see reflectors on another body of the machine.
///
///     x = R^T (R_b r + t_b - t),   R = exp(w) R_given
///
/// (R_b, t_b): body of the reflector r seen from the body of the station; (R, t): pose of the station there. A reading
/// is x itself (mm), or its range (mm), azimuth and elevation (rad). Items: every station with every reflector, station
/// by station; targets are the reflectors. Quantities: per station STATION.x, .y, .z (t, mm), .rx, .ry, .rz (w, rad,
/// frame of the body); per reflector REFLECTOR.offset_x, .offset_y, .offset_z (mm).
///
/// The readings as residuals are TrackerObservations: components of one reading are correlated, and angles are taken
/// across the beam. equation() is the same model without these.
class LaserTracker : public EquationInstrument<LaserTracker, 9, 3> {
 public:
  /// @param name    of the set-up
  /// @param stated  what simulated readings say of their uncertainty
  LaserTracker(std::string name, TrackerSetup setup, TrackerMeasure measure,
               StatedUncertainty stated = StatedUncertainty::none);

  /// Stations and reflectors at the present values of the quantities.
  TrackerSetup setup() const;
  TrackerMeasure measure() const { return measure_; }
  StatedUncertainty stated() const { return stated_; }
  /// The index of an item.
  std::size_t item_of(std::size_t station, std::size_t reflector) const {
    return station * given_.reflectors.size() + reflector;
  }

  TrackerReadings tracker_readings(const InstrumentReadings& readings) const;
  InstrumentReadings instrument_readings(const TrackerReadings& readings) const;

  double standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                              std::size_t component) const override;
  /// Poses of the stations that are estimated: find_station_poses(); open offsets where those stated are far off.
  StartedInstrument started(const Machine& machine, const InstrumentReadings& readings) const override;
  /// Mirrored frames, clockwise and zenith angles, swapped angles, and units.
  std::vector<ReadingMistake> usual_mistakes() const override;
  std::size_t fitted_by_start() const override { return 6 * given_.stations.size(); }
  /// Stated true poses and offsets; what is known within an uncertainty is not drawn.
  std::shared_ptr<const Instrument> truth(RandomStream& random) const override;
  std::shared_ptr<const Instrument> as_planned() const override;
  std::optional<MissingNumber> missing_for_plan() const override;
  std::unique_ptr<Observations> observations(const Machine& machine, const ErrorSet& errors,
                                             const InstrumentReadings& readings) const override;
  std::unique_ptr<Observations> observations_in_um(const Machine& machine, const ErrorSet& errors,
                                                   InstrumentReadings readings) const override;
  SimulatedInstrument simulate(const Machine& machine, const ErrorSet& errors, const InstrumentReadings& plan,
                               const InstrumentSimulationOptions& options) const override;
  bool may_miss() const override { return false; }
  bool measures_points() const override { return true; }
  std::shared_ptr<const Instrument> in_coordinates() const override;
  std::vector<ItemLabel> item_labels() const override;
  std::vector<double> deviation_arms(const InstrumentReadings& readings) const override;
  std::string noise_words() const override;
  std::vector<InstrumentPlace> places() const override;
  Eigen::MatrixXd place_slopes(std::size_t place, const std::vector<std::size_t>& quantities) const override;

  std::vector<std::string> target_names() const override;
  const char* target_word() const override { return "reflector"; }
  std::vector<std::string> station_names() const override;
  bool targets_share_poses() const override { return true; }
  std::size_t item_at(const Machine& machine, std::size_t target, std::size_t station,
                      const std::vector<double>& positions) const override;
  std::size_t target_of(std::size_t item) const override { return item % given_.reflectors.size(); }
  std::size_t station_of(std::size_t item) const override { return item / given_.reflectors.size(); }

  template <typename S>
  void equation(std::size_t item, const SeenBody<S>& seen, const S* quantities, const double*, S* reading) const;

 private:
  /// Order of the quantities of an item.
  enum Place { kStation = 0, kTurn = 3, kReflector = 6 };
  void name_components();
  std::size_t reflector_quantity(std::size_t reflector) const { return 6 * given_.stations.size() + 3 * reflector; }
  /// The set-up with the values of the quantities, the stations' rotations as they were given.
  TrackerSetup with_given_rotations() const;

  TrackerSetup given_;
  TrackerMeasure measure_;
  StatedUncertainty stated_;
};

}  // namespace abbe
