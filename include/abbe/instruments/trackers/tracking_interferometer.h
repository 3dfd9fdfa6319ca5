#pragma once

#include <string>
#include <vector>

#include "abbe/instruments/equation_instrument.h"

namespace abbe {

/// Tracking interferometers that measure length only, from several stations.
struct TrackingInterferometerSetup {
  struct Station {
    std::string name = "station1";
    Body body = Body::workpiece;
    SetupPoint position;  ///< mm, frame of `body`: centre about which the interferometer turns
  };
  struct Reflector {
    std::string name = "reflector1";
    Body body = Body::tool;
    SetupPoint offset;  ///< mm, frame of `body`; tool: from the gauge point
  };
  /// Readings with one beam that was not interrupted.
  struct Run {
    std::string name = "run1";
    std::size_t station = 0, reflector = 0;
    SetupNumber dead_path = SetupNumber::open(0);  ///< mm, true distance where the indication is zero
  };
  std::string name = "tracking1";
  std::vector<Station> stations;
  std::vector<Reflector> reflectors;
  std::vector<Run> runs;        ///< at least one
  SetupNumber length_scale;     ///< indicated / true - 1 (pure number): wavelength and its compensation
  double noise = 0.2e-3;        ///< mm, standard uncertainty of one indicated length
  double noise_per_length = 0;  ///< further part, mm per mm of length, dead path included
};

/// Indicated change of the distance between a station and a reflector.
///
///     L = (1 + s) (|R r + t - p| - d)
///
/// (R, t): body of the reflector r seen from the body of the station p; d: dead path, the distance where the indication
/// is zero. Every interruption of the beam begins a run with a new dead path; runs of one station share its position,
/// runs with one reflector its offset. Items: the runs. Component: length (mm). The orientation of an interferometer
/// that turns about a stationary reference sphere does not enter.
/// Quantities: NAME.length_scale, STATION.x .., REFLECTOR.x .., RUN.dead_path. Source: Schwenke et al., CIRP
/// Annals 54 (2005) 475; derivation in docs/tracking-interferometer.md.
class TrackingInterferometer : public EquationInstrument<TrackingInterferometer, 8, 1> {
 public:
  /// @throws std::invalid_argument: no run, a run without its station or reflector, both on one body
  explicit TrackingInterferometer(const TrackingInterferometerSetup& setup);

  double standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                              std::size_t component) const override;
  /// Positions of stations and dead paths that are open, from the lengths alone: see find_tracking_start().
  std::vector<double> start_values(const Machine& machine, const InstrumentReadings& readings,
                                   std::vector<std::string>& notes) const override;
  /// The same, with how well they explain the lengths.
  StartedInstrument started(const Machine& machine, const InstrumentReadings& readings) const override;
  /// Units, the sign, and optical for geometric lengths.
  std::vector<ReadingMistake> usual_mistakes() const override;
  const char* interruption_words() const override { return "moved, or its beam was interrupted"; }
  /// Reflector and station.
  std::optional<MeetingPoints> meeting_points(std::size_t item) const override;

  const TrackingInterferometerSetup& setup() const { return setup_; }

  template <typename S>
  void equation(std::size_t, const SeenBody<S>& seen, const S* quantities, const double*, S* reading) const;

 private:
  /// Order of the quantities of an item.
  enum Place { kReflector = 0, kStation = 3, kDeadPath = 6, kScale = 7 };
  TrackingInterferometerSetup setup_;
};

}  // namespace abbe
