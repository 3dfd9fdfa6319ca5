#pragma once

// What a ball bar reads on a mill that is out of square:
//
//   #include <abbe/geometry/angle_units.h>
//   #include <abbe/instruments/ball_bar.h>
//   #include <abbe/instruments/instrument.h>
//   #include <abbe/instruments/instrument_simulation.h>
//   #include <abbe/machine/chain.h>
//
//   #include <cmath>
//   #include <cstdio>
//
//   int main() {
//     const abbe::Machine mill = abbe::parse_chain("w X' Y' b Z t").machine;
//     abbe::ErrorSet errors;  // squareness of Y to X: 20 um/m
//     errors.locations.push_back({.axis = mill.find_axis("Y"), .component = abbe::Component::C, .value = 20e-6});
//     abbe::BallBarSetup setup;
//     setup.balls = {{"table", abbe::SetupPoint::exact({0, 0, 0})}};  // mm, in the frame of the workpiece
//     const auto bar = std::make_shared<const abbe::BallBar>(setup);
//
//     abbe::InstrumentReadings plan;  // a circle of 150 mm in eight poses
//     for (int k = 0; k < 8; ++k)
//       plan.append({150 * std::cos(k * abbe::kTurn / 8), 150 * std::sin(k * abbe::kTurn / 8), 0}, 0);
//     abbe::InstrumentSimulationOptions options;
//     options.noise_factor = 0;
//     const abbe::InstrumentReadings read = bar->simulate(mill, errors, plan, options).readings;
//     for (std::size_t k = 0; k < 4; ++k)
//       std::printf("%3zu deg %+.2f um\n", 45 * k, 1e3 * (read.measured[0][k] - 150));
//     return 0;
//   }
//
// It prints:
//
//     0 deg +0.00 um
//    45 deg -1.50 um
//    90 deg +0.00 um
//   135 deg +1.50 um
//
// instruments holds measurement equations and their interface to the identification:
//   ball_bar.h, interferometer.h, ...   a header for each instrument; trackers/ and polygon/ have several each
//   equation_instrument.h               what they derive from: one equation, derivatives follow
//   measurement_plan.h                  poses of a measurement: grids, lines, diagonals, spirals
//   instrument_simulation.h             readings of a machine with errors, with noise and outliers
//   observations.h                      readings as weighted residuals
//   point_scan.h, virtual_scan.h        displacement probes that scan a part

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "abbe/errors/chain_plan.h"
#include "abbe/errors/poses.h"
#include "abbe/instruments/observations.h"
#include "abbe/instruments/reading_mistakes.h"
#include "abbe/instruments/setup_drift.h"
#include "abbe/instruments/setup_quantity.h"

namespace abbe {

/// "bed", "workpiece" or "tool".
const char* body_name(Body body);

class Instrument;

/// What a reading is taken on: a ball, a line, a run, a face. Several items share one instrument.
struct InstrumentItem {
  std::string name;
  Body from = Body::tool;               ///< body that is seen
  Body to = Body::workpiece;            ///< body from which it is seen
  std::vector<std::size_t> quantities;  ///< indices into Instrument::quantities() on which its readings depend
};

/// Readings of one instrument, structure of arrays.
struct InstrumentReadings {
  PoseList poses;                                ///< axis commands, [axes][count], mm or rad
  std::vector<std::uint16_t> item;               ///< [count] index into Instrument::items()
  std::vector<std::vector<double>> inputs;       ///< [Instrument::inputs()][count]: known numbers of each reading
  std::vector<std::vector<double>> measured;     ///< [components][count], mm or rad; a plan has none
  std::vector<std::vector<double>> uncertainty;  ///< [components][count] standard uncertainties, or empty: noise model
  /// [components (components + 1) / 2][count] or empty: variances, then covariances (xx, yy, zz, xy, xz, yz), where the
  /// data state them; `uncertainty` is then empty.
  std::vector<std::vector<double>> covariance;
  std::vector<double> time_s;                 ///< [count] or empty
  std::vector<std::string> point_name;        ///< [count] name of the point in the input, or empty: it gives none
  std::shared_ptr<const SetupDrift> drift{};  ///< null: the set-up stands still; else `time_s` is needed

  std::size_t count() const { return item.size(); }
  /// Adds one reading to a plan (nothing measured yet).
  void append(const std::vector<double>& positions, std::size_t on_item, const std::vector<double>& known = {});
  /// @param same_clock  the times of both count from the same moment; else those of `more` count from the last one
  void append(const InstrumentReadings& more, bool same_clock = false);
  /// The readings of those indices, in that order.
  InstrumentReadings subset(const std::vector<std::size_t>& readings) const;
};

/// Two points that come together (a ball in its nest, a probe at its sphere) or stay at a given distance when an item
/// is measured.
struct MeetingPoints {
  Eigen::Vector3d on_from = Eigen::Vector3d::Zero();  ///< mm, frame of the item's `from` body
  Eigen::Vector3d on_to = Eigen::Vector3d::Zero();    ///< mm, frame of its `to` body
};

/// A place of the set-up that several quantities describe together: a placement, a clamping, a beam.
struct InstrumentPlace {
  std::string name;
  Body body = Body::workpiece;                 ///< in whose frame the rest is
  Eigen::Vector3d position{0, 0, 0};           ///< mm
  std::optional<Eigen::Matrix3d> rotation{};   ///< columns: its axes
  std::optional<Eigen::Vector3d> direction{};  ///< unit, of what has a direction alone: an axis, a normal, a beam
  std::vector<std::size_t> quantities{};       ///< indices into Instrument::quantities() on which it depends
};

/// At which other poses an instrument could be read without moving it.
enum class PoseFreedom {
  anywhere,    ///< wherever the axes go: a tracking interferometer, a level
  along_line,  ///< along the axes that already moved: a beam, a straightedge
  together,    ///< where the meeting points keep their displacement, the linear axes following: a nest, a probe
  at_distance  ///< where the meeting points keep their distance: a bar
};

/// A grouping of the items of an instrument: by station, by reflector.
struct ItemLabel {
  std::string kind;                    ///< "station"
  std::vector<std::string> names;      ///< of the stations
  std::vector<std::uint16_t> of_item;  ///< [Instrument::items()] index into names
};

/// Fit of the position of a station to its readings, with the nominal machine.
struct StartFit {
  std::string place;                  ///< "station1"
  std::vector<std::size_t> readings;  ///< indices
  bool found = false;                 ///< false: no position explains half of the readings
  bool determined = true;             ///< false: too few readings, or a poor arrangement of them
  bool rough = false;                 ///< other numbers of the set-up are open too: a bad fit proves nothing
  double extent_mm = 0;               ///< root mean square distance of the points that were seen from their mean
};

/// An instrument with a set-up that an identification can start from.
struct StartedInstrument {
  std::shared_ptr<const Instrument> instrument;
  std::vector<StartFit> fits{};       ///< of the places that were sought
  std::vector<std::string> warnings;  ///< what there is to say: what is not determined, readings of another reflector
};

/// A number of the set-up that is left to be found from the readings; a plan needs its value.
struct MissingNumber {
  std::string problem, expected;  ///< in words
};

struct InstrumentSimulationOptions;
struct SimulatedInstrument;
class RandomStream;

/// Poses at which readings of one item are modelled, and where its body is seen there.
struct ItemBlock {
  std::size_t item = 0;
  std::size_t count = 0;
  const double* rotation[9];           ///< [count] each, row-major: axes of the body `from` in the frame of `to`
  const double* origin[3];             ///< [count] each: origin of the frame of `from` in the frame of `to`, mm
  std::vector<const double*> inputs;   ///< [Instrument::inputs()] of [count]
  const double* quantities = nullptr;  ///< [Instrument::quantities()] present values
};

/// Modelled readings of a block and their derivatives.
struct ModelledBlock {
  double* value;  ///< value[row * count + k], mm or rad
  /// Null or out, by_motion[(row * 6 + j) * count + k]: derivative by a displacement of the body `from`, frame of `to`:
  /// j = 0..2 shift along x, y, z (per mm); 3..5 turn about x, y, z through the origin of its frame (per rad).
  double* by_motion = nullptr;
  /// Null or out, by_quantity[(row * n + q) * count + k], q < n = number of the item's quantities; 0 of exact ones.
  double* by_quantity = nullptr;
};

/// A measuring instrument with its set-up: everything that the identification needs to know about it.
///
/// An instrument is its measurement equation: what it reads if one body of the machine is seen from another at some
/// pose. Frames: the tool's frame has its origin at the gauge point (with the tool offset error, which belongs to
/// whatever is clamped there) and is parallel to the machine's with all axes at zero; the workpiece's and the bed's as
/// docs/conventions.md says. Write one by deriving from EquationInstrument.
class Instrument : public std::enable_shared_from_this<Instrument> {
 public:
  virtual ~Instrument() = default;

  const std::string& name() const { return name_; }
  /// What a reading consists of, at most six numbers.
  const std::vector<ReadingComponent>& components() const { return components_; }
  /// Known numbers that every reading carries besides the axis commands, as the columns of its file say.
  const std::vector<ReadingComponent>& inputs() const { return inputs_; }
  const std::vector<InstrumentItem>& items() const { return items_; }
  const std::vector<SetupQuantity>& quantities() const { return quantities_; }

  /// Thread-safe; does not allocate.
  virtual void model(const ItemBlock& block, const ModelledBlock& out) const = 0;

  /// Standard uncertainty of one component of a reading where the data state none, mm or rad, > 0.
  virtual double standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                                      std::size_t component) const = 0;

  /// Start values of the quantities where a rough guess is not enough: found from the readings and the nominal machine.
  /// @param notes  remarks for the user are appended to it
  /// @return [quantities()]; as given where nothing needs to be found
  virtual std::vector<double> start_values(const Machine& machine, const InstrumentReadings& readings,
                                           std::vector<std::string>& notes) const;

  /// This instrument with the set-up that an identification starts from: start_values(), unless overridden.
  virtual StartedInstrument started(const Machine& machine, const InstrumentReadings& readings) const;

  /// Mistakes in its files that the fits of started() show; those with the fewest single mistakes come first.
  virtual std::vector<ReadingMistake> usual_mistakes() const { return {}; }
  /// What happened between two parts of the readings that each fit alone, as a verb after a station's name: "moved".
  virtual const char* interruption_words() const { return "moved"; }

  /// How many numbers of the set-up started() fits well enough for the residuals to judge a nominal machine; 0: its fit
  /// is only a rough start.
  virtual std::size_t fitted_by_start() const { return 0; }

  /// This instrument as it really is in a simulation: a number known within an uncertainty is what was stated as true,
  /// or is drawn from that uncertainty.
  virtual std::shared_ptr<const Instrument> truth(RandomStream& random) const;

  /// This instrument for a plan of readings: with the values stated as true, else with the start values.
  virtual std::shared_ptr<const Instrument> as_planned() const;

  /// Which number of the set-up must be given before readings can be planned, and how; nothing if none is missing.
  virtual std::optional<MissingNumber> missing_for_plan() const { return std::nullopt; }

  /// The readings as weighted residuals of these errors; the unknowns stand at the present values. Every instrument
  /// is held by a std::shared_ptr, and the observations share it.
  /// @throws std::invalid_argument as check_readings()
  virtual std::unique_ptr<Observations> observations(const Machine& machine, const ErrorSet& errors,
                                                     const InstrumentReadings& readings) const;

  /// The same, every length weighted as if its standard uncertainty were 1 um, so that residuals are in um.
  virtual std::unique_ptr<Observations> observations_in_um(const Machine& machine, const ErrorSet& errors,
                                                           InstrumentReadings readings) const;

  /// What this instrument, whose quantities are taken as true, would read: see simulate_instrument().
  virtual SimulatedInstrument simulate(const Machine& machine, const ErrorSet& errors, const InstrumentReadings& plan,
                                       const InstrumentSimulationOptions& options) const;

  /// False if every pose with a line of sight has a reading; else poses can lie beside what is measured.
  virtual bool may_miss() const { return true; }

  /// True if a reading is a point: the position of the target in all three directions.
  virtual bool measures_points() const { return false; }
  /// The same instrument with readings of points as coordinates x, y, z; itself if it does not measure points.
  virtual std::shared_ptr<const Instrument> in_coordinates() const { return shared_from_this(); }

  /// What readings are grouped by when patterns are looked for.
  virtual std::vector<ItemLabel> item_labels() const;

  /// [components] change of the deviation with the measured number: 1, or the typical range (mm) of an angle whose
  /// deviation is the length across the beam.
  virtual std::vector<double> deviation_arms(const InstrumentReadings& readings) const;

  /// The standard uncertainty of a reading in words, "10 um + 5 um/m in every direction"; empty: as the study states.
  virtual std::string noise_words() const { return {}; }

  /// Places of the set-up at the present values of the quantities, where these are deviations from a nominal place or
  /// angles; a point that is a quantity itself needs none.
  virtual std::vector<InstrumentPlace> places() const { return {}; }

  /// Derivatives of a place by some quantities: [6, quantities], shift along and turn about x, y, z of its body's
  /// frame, mm or rad per mm or rad. By central differences: a place is smooth on the scale of its quantities.
  virtual Eigen::MatrixXd place_slopes(std::size_t place, const std::vector<std::size_t>& quantities) const;

  /// Nominal points of an item that plans bring together; none where the instrument has no such points.
  virtual std::optional<MeetingPoints> meeting_points(std::size_t item) const;

  /// For proposals of further readings.
  virtual PoseFreedom pose_freedom() const { return PoseFreedom::anywhere; }

  /// Known numbers with which a plan measures an item at every pose: one reading per entry, [inputs()] each.
  virtual std::vector<std::vector<double>> planned_inputs(std::size_t item) const;

  /// What plans and files of readings name: the items, or groups of items among which the pose decides (the mounts of a
  /// prism: which face then stands before the sensors).
  virtual std::vector<std::string> target_names() const;
  /// What a target is called: "item", "reflector". Its plural ends with an s.
  virtual const char* target_word() const { return "item"; }
  /// Names of the places from which targets are seen, where plans have to choose between them.
  virtual std::vector<std::string> station_names() const { return {}; }
  /// True if a plan measures every target at a pose before it goes on to the next; else one target after the other.
  virtual bool targets_share_poses() const { return false; }

  /// The item that a target is at a pose, by the nominal machine.
  /// @param station    index into station_names(), 0 without stations
  /// @param positions  commands in chain order, mm or rad
  /// @throws std::invalid_argument if there is none, in words
  virtual std::size_t item_at(const Machine& machine, std::size_t target, std::size_t station,
                              const std::vector<double>& positions) const;

  /// The target of an item, and the place from which it is seen.
  virtual std::size_t target_of(std::size_t item) const { return item; }
  virtual std::size_t station_of(std::size_t item) const { return static_cast<void>(item), std::size_t{0}; }

  /// The same instrument with other values of its quantities, [quantities()]; knowledge and uncertainties stay.
  virtual std::shared_ptr<const Instrument> with_values(const std::vector<double>& values) const = 0;

 protected:
  explicit Instrument(std::string name) : name_(std::move(name)) {}
  /// @return its index
  std::size_t add(SetupQuantity quantity);
  /// Three coordinates, named NAME.x, NAME.y, NAME.z, mm. @return their indices
  std::array<std::size_t, 3> add(const std::string& name, const SetupPoint& point);
  std::size_t add(InstrumentItem item);
  void set_values(const std::vector<double>& values);

  std::string name_;
  std::vector<ReadingComponent> components_;
  std::vector<ReadingComponent> inputs_;
  std::vector<InstrumentItem> items_;
  std::vector<SetupQuantity> quantities_;
};

/// Checks that readings belong to the instrument: sizes, item indices, finite numbers, positive uncertainties, and that
/// an item's bodies differ.
/// @param measured  false: a plan, nothing measured yet
/// @throws std::invalid_argument naming the reading (counted from 0) and what was expected
void check_readings(const Machine& machine, const Instrument& instrument, const InstrumentReadings& readings,
                    bool measured = true);

}  // namespace abbe
