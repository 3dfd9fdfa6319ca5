#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/formats/readings/channel_file.h"
#include "abbe/formats/study/report_facts.h"
#include "abbe/formats/study/study_planning.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/identify/robust_loss.h"
#include "abbe/identify/strategies.h"
#include "abbe/instruments/instrument.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/instruments/path_plan.h"
#include "abbe/instruments/setup_quantity.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Random smooth errors of stated size, instead of a file with the true errors.
struct ErrorGenerator {
  std::uint64_t seed = 1;
  int linear_order = 4;                      ///< Legendre order of the error motions of linear axes
  int rotary_order = 4;                      ///< harmonics of the error motions of rotary axes
  std::optional<double> mean_volumetric;     ///< mm; exactly one of these two is given
  std::optional<double> maximum_volumetric;  ///< mm
  bool location_errors = true;               ///< draw squareness, parallelism and axis positions too
  double reversal = 0;                       ///< mm, lost motion of linear axes: drawn from 0.5 to 1.5 times this
  double rotary_reversal = 0;                ///< rad, likewise of rotary axes
};

/// Gross errors put into simulated readings.
struct SimulatedOutliers {
  double fraction = 0;  ///< of the readings, 0 .. 0.5
  double size = 0;      ///< mm, standard deviation in each direction
};

struct Simulation {
  std::optional<std::filesystem::path> errors_file;  ///< true errors; exactly one of file and generator is given
  std::optional<ErrorSet> errors;                    ///< what the file holds, where somebody has it already
  std::optional<ErrorGenerator> generator;
  SimulatedOutliers outliers;
  double interval_s = 2;  ///< time between readings, where poses have no times
  bool noise = true;      ///< false: exact readings; the set-ups' noise then only weights them
};

enum class PlanKind {
  grid,
  line,
  random,
  spiral,
  circle,         ///< one point of an item goes round the other, the linear axes moving
  follow,         ///< the points of an item stay together while the rotary axes go through their grid
  step_diagonal,  ///< as line, but one axis after the other in every step
  poses           ///< from a file
};

/// Axis positions at which simulated readings are taken.
///
/// Axes not named in the file stay fixed at zero, or at the middle of a travel without zero. Limits as in Aguado et
/// al., fig. 5, are fixed axes and restricted ranges: A all axes over their range, B one fixed C, C one fixed X and Z.
struct MeasurementPlan {
  PlanKind kind = PlanKind::grid;
  std::filesystem::path file;        ///< poses: what read_planned_poses() reads
  std::vector<AxisRange> axes;       ///< [axes], chain order; mm or rad
  int points = 0;                    ///< line, random, spiral, circle
  double turns = 1;                  ///< spiral: turns of the ellipse over the two axes of largest range
  std::size_t steps = 0;             ///< step diagonal: how often every axis moves
  std::vector<std::size_t> order;    ///< step diagonal: axes that move, in their order within a step
  std::vector<std::size_t> targets;  ///< indices into Instrument::target_names(); each position is measured with each
  std::size_t station = 0;           ///< index into Instrument::station_names()
  std::size_t repeats = 1;           ///< how often the poses are gone through
  bool there_and_back = false;       ///< every second time in reverse order
  CircleDescription circle;          ///< of kind circle; its count is `points`
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< follow: of the points from each other, mm, machine frame
};

struct SetupData {
  std::filesystem::path file;
  ColumnMapping mapping;
  std::shared_ptr<const InstrumentReadings> readings{};  ///< instead of the file, where somebody has them already
};

/// How a set-up really drifts in a simulation.
struct TrueDrift {
  std::array<std::vector<double>, 6> polynomial;  ///< of x, y, z, rx, ry, rz: coefficients as in DriftingPlace, mm, rad
  double walk_length = 0, walk_angle = 0;         ///< mm/sqrt(s), rad/sqrt(s)
};

/// A set-up that moves slowly against the body on which it stands.
struct DriftPlan {
  std::vector<int> components{0, 1, 2};  ///< as in DriftingPlace
  int degree = 0;                        ///< of the polynomial in time
  bool walks = false;                    ///< a random walk is added
  bool estimate_walk = false;            ///< its intensities are found from the readings
  double walk_length = 0;                ///< mm/sqrt(s), of shifts; where they are estimated: the start
  double walk_angle = 0;                 ///< rad/sqrt(s), of turns
  std::size_t knots = 0;                 ///< most values of the walk
  std::optional<Eigen::Vector3d> about;  ///< mm, point about which it turns; else its place
  std::optional<TrueDrift> truth;        ///< simulation
  bool is_identified() const { return degree > 0 || walks; }
};

/// One instrument at one place in one period of time.
struct Setup {
  std::string name;
  std::string instrument;                    ///< "tracker", "ball-bar", ...: see instrument_words()
  std::shared_ptr<const Instrument> device;  ///< as the study states it
  bool noise_from_data = false;              ///< use the uncertainties in the data
  std::vector<MeasurementPlan> plans;        ///< simulation
  std::vector<SetupData> data;               ///< measurement; exactly one of plans and data is given
  ChannelPlan channels{};                    ///< states by the times of readings, beside those of the study
  std::optional<DriftPlan> drift{};          ///< absent: it stands still
};

/// What is known before the readings of the term of an expansion, whose second coefficient alone is identified
/// (abbe/errors/expansion.h).
struct IdentifiedExpansion {
  SetupNumber coefficient;        ///< of the error motion, mm (per K of its state), with the sign of the axis
  bool is_temperature = false;    ///< the term without a state, for the uncertainty of the temperature
  std::string thermometer{};      ///< of the latter: what it shares with those of the same thermometer; empty: nothing
  double thermometer_effect = 0;  ///< mm, with a sign (abbe/errors/expansion.h)
};

/// One error motion to be identified.
struct IdentifiedMotion {
  std::size_t axis = 0;
  Component component = Component::X;
  /// With the largest order to be tried; a table has its number of intervals as order and no nodes yet.
  Basis basis;
  int smallest_order = 0;        ///< equal to basis.order unless the order is to be selected
  std::size_t state = kNoState;  ///< index into Machine::states
  bool optional = false;         ///< with a state: only taken where held-out blocks of time speak for it
  std::optional<IdentifiedExpansion> expansion{};  ///< of the scale; its basis is that of the expansion
};

struct IdentifiedLocation {
  std::size_t axis = 0;
  Component component = Component::A;
  std::size_t state = kNoState;  ///< index into Machine::states
  bool optional = false;         ///< as that of an error motion
};

/// Prior knowledge of parameters: value with standard uncertainty.
struct ParameterPrior {
  std::string
      parameters;  ///< pattern over parameter names: "EXX[P2]", "E?0C", "tool_*"; `*` any text, `?` one character
  bool is_angle = false;
  double value = 0;                 ///< mm or rad
  double standard_uncertainty = 0;  ///< mm or rad, > 0
};

/// What is identified and how.
struct IdentificationPlan {
  std::vector<IdentifiedMotion> motions;
  std::vector<IdentifiedLocation> locations;
  std::vector<std::size_t> reversals;  ///< axes
  bool tool_offset = false;
  bool estimate_variance_factor = false;  ///< of the stated covariance of the readings, from their residuals
  bool estimate_pose_noise = false;       ///< of a displacement common to all readings at one pose
  bool estimate_block_noise = false;      ///< of a displacement common to all readings in a block of time
  double noise_block_s = 0;               ///< s, length of these blocks
  std::optional<std::filesystem::path> initial_errors;  ///< start values; else zero
  std::vector<ParameterPrior> priors;
  Strategy strategy = Strategy::joint;
  LossKind loss = LossKind::none;
  double loss_scale = 0;  ///< in standard uncertainties; 0: the loss's usual value (95 % efficiency)
  int max_iterations = 50;
  double tolerance = 1e-10;                            ///< relative change of the cost and of the parameters
  double held_out_fraction = 0.1;                      ///< of the readings, not used in the fit
  std::optional<std::filesystem::path> held_out_file;  ///< measurement file for validation instead of a fraction
  /// An error motion is stated up to the end of its range where the gap to the outermost reading is at most this much
  /// of the range of the readings.
  double coverage_margin_percent = 2;
  bool select_order = false;           ///< some motion without a state has smallest_order < basis.order
  bool select_terms = false;           ///< some term with a state is optional, or its order is to be selected
  bool rank_sensors = false;           ///< of the states, by held-out blocks of time
  std::size_t time_blocks = 20;        ///< held out one after the other for that choice
  double ageing_length = 0;            ///< mm/sqrt(s), how errors wander after their measurement; for the errors file
  double ageing_angle = 0;             ///< rad/sqrt(s)
  double time_gap_s = 0;               ///< readings nearer than this to a block take no part in the fit without it
  std::size_t readings_in_memory = 0;  ///< if there are more, they are read again for every sum; 0: all in memory
  int monte_carlo = 0;                 ///< simulated identifications; 0: none
};

/// Where the volumetric error is predicted.
struct MapPlan {
  std::vector<AxisRange> axes;                      ///< [axes], chain order; the grid, first axis varying slowest
  std::optional<std::filesystem::path> poses_file;  ///< instead of the grid
};

struct ReportOptions {
  bool page = true;
  std::string title;                   ///< empty: the study's name
  std::optional<ReportFacts> facts{};  ///< of the customer report; absent: none is wanted
  /// Results of the same machine before a correction, for its figures before and after: a folder of `abbe run`, or an
  /// errors file.
  std::optional<std::filesystem::path> before{};
};

/// A whole job: what is given, what is measured or simulated, what is identified and what is reported. Plain data.
/// Paths are resolved against the study's folder. Defaults are those written here and in docs/formats.md.
struct Study {
  std::string name;
  std::string description;
  std::filesystem::path machine_file;
  Machine machine;
  std::uint64_t seed = 1;
  int threads = 0;                       ///< 0: all
  std::optional<Simulation> simulation;  ///< absent: the readings come from data files
  std::vector<Setup> setups;
  ChannelPlan channels{};  ///< states by the times of readings, of all set-ups
  std::optional<IdentificationPlan> identification;
  std::optional<MapPlan> map;
  std::optional<PlanningStudy> planning;
  ReportOptions report;
  std::filesystem::path output;  ///< results folder; default "results/<name of the study file>"
};

}  // namespace abbe
