#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "abbe/formats/study/study.h"
#include "abbe/identify/problem.h"
#include "abbe/instruments/instrument.h"
#include "abbe/instruments/setup_drift.h"
#include "abbe/plan/readings/planning.h"
#include "abbe/study/identification/not_identified.h"
#include "abbe/study/identification/sensor_selection.h"
#include "abbe/study/job_options.h"
#include "abbe/study/planning/planned_states.h"

namespace abbe {

/// One reading that may be taken: where the machine stands, who looks at what.
struct CandidateReading {
  std::vector<double> pose;    ///< [axes] mm or rad
  std::size_t setup = 0;       ///< index into Study::setups
  std::size_t item = 0;        ///< index into Instrument::items()
  std::vector<double> inputs;  ///< [Instrument::inputs()]
  std::size_t condition = 0;   ///< index into PlannedStates::conditions()
  std::size_t part = 0;        ///< of the measurement, where set-ups drift: parts follow each other
  bool operator<(const CandidateReading& other) const {
    return std::tie(pose, setup, item, inputs, condition, part) <
           std::tie(other.pose, other.setup, other.item, other.inputs, other.condition, other.part);
  }
};

/// Poses under one condition.
struct PosesAt {
  static constexpr std::size_t kEverySetup = static_cast<std::size_t>(-1);
  PoseList poses;
  std::size_t condition = 0;
  std::size_t part = 0;             ///< as CandidateReading::part
  std::size_t setup = kEverySetup;  ///< the one with which they are read
  double time_s = 0;                ///< about when, where set-ups drift
};

/// How the set-ups of a study drift: one for each, null where it stands still; empty if nothing drifts.
using PlannedDrifts = std::vector<std::shared_ptr<const SetupDrift>>;

/// The identification problem of a study as far as it can be set up before anything is measured: all errors zero,
/// instruments where the study says they stand.
///
/// An instrument that can be read anywhere may be read at any pose; one whose points meet follows with the linear axes
/// (PoseFreedom::together). All others, and those with a [[setup.plan]] that are no trackers, may be read where their
/// plans say: a bar on its circles, a laser along its lines. The model owns what it needs of the study.
class PlanningModel {
 public:
  /// @param errors  of zero, with the ranges over which they are to be known; null: those of the study
  /// @param drifts  further unknowns of the set-ups, with their priors
  /// @throws InputError naming what is missing for a plan
  explicit PlanningModel(const Study& study, const ErrorSet* errors = nullptr, PlannedDrifts drifts = {});

  struct Candidates {
    PlanningCandidates rows;
    std::vector<CandidateReading> readings;    ///< [rows.count()]
    std::vector<InstrumentReadings> of_setup;  ///< [setups] the same
    std::size_t hidden = 0;                    ///< without a line of sight
    std::size_t forbidden = 0;                 ///< poses in a forbidden box
  };
  /// What could be read at poses. Rows over the vector of estimates.
  /// @param sight  [poses] the one sight used at each, modulo sight_count(); empty: every one
  Candidates readings_at(const PoseList& poses, const std::vector<std::size_t>& sight = {}) const;
  /// The same at several conditions.
  Candidates readings_at(const std::vector<PosesAt>& tried, const std::vector<std::size_t>& sight = {}) const;
  /// The same without computing rows.
  Candidates seen_at(const std::vector<PosesAt>& tried, const std::vector<std::size_t>& sight = {}) const;
  /// Rows of readings that were candidates, at states of their own, in the order of the set-ups.
  ///
  /// With times, the drift of the set-ups at these times is unknown too, as an identification has it. Its columns are
  /// projected out: the rows, and some of the priors of its walks, are those of the other estimates beside it.
  /// @param states  [readings][states of the machine], or empty
  /// @param time_s  [readings], or empty: nothing drifts
  PlanningCandidates rows_of(const std::vector<CandidateReading>& readings,
                             const std::vector<std::vector<double>>& states,
                             const std::vector<double>& time_s = {}) const;

  /// [poses] true where the functional point stands in a forbidden box.
  std::vector<bool> forbidden(const PoseList& poses) const;

  /// Deviation of the tool's functional point in the workpiece frame, best-fit rigid motion over all poses removed, as
  /// rows over the vector of estimates: [3 poses, p], mm per mm or rad. The poses have states where errors have them.
  Eigen::MatrixXd prediction_rows(const PoseList& poses) const;
  /// Rows of named parameters in um or urad, for goal = "parameters". @throws InputError if a pattern matches nothing
  Eigen::MatrixXd parameter_rows() const;
  /// Knowledge of the kind one always has, [p, p]: every error within 20 um or 60 urad (one with a state at the largest
  /// value of its factor), every number of a set-up within a thousand times that.
  Eigen::MatrixXd weak_prior() const;
  /// Priors of the study, [rows, p].
  const Eigen::MatrixXd& known() const { return known_; }

  const Study& study() const { return study_; }
  const ErrorSet& errors() const { return errors_; }
  /// States at which readings can be taken, and those at which errors will be used.
  const PlannedStates& states() const { return states_; }
  /// State of an estimated parameter, or kNoState.
  std::size_t state_of(std::size_t parameter) const { return state_of_[parameter]; }
  /// Of instruments that may be read at any pose: stations times targets.
  std::size_t sight_count() const { return sights_.size(); }
  /// True if those instruments may be read wherever the axes go, so that poses beside a chosen one can be tried.
  bool sights_stand_anywhere() const { return sights_stand_anywhere_; }
  /// True if some instrument may be read at the poses of its plans only.
  bool has_given_readings() const { return !given_.empty(); }
  std::size_t parameter_count() const { return parameters_.size(); }
  const std::vector<EstimatedParameter>& parameters() const { return parameters_; }

 private:
  struct Sight {
    std::size_t setup, station, target;
  };
  Problem problem(const std::vector<InstrumentReadings>& readings) const;
  void check_setups() const;
  void add_sights(std::size_t setup);
  void add_given(std::size_t setup);
  void see(std::size_t setup, const InstrumentReadings& plan, std::vector<InstrumentReadings>& readings,
           Candidates& result) const;
  void see_poses(const PosesAt& at, const std::vector<std::size_t>& sight, std::vector<InstrumentReadings>& readings,
                 Candidates& result) const;
  void find_states();
  std::vector<InstrumentReadings> no_readings() const;
  InstrumentReadings sight_plan(const Sight& sight, const PoseList& poses, Candidates& result) const;

  Study study_;
  ErrorSet errors_;
  PlannedDrifts drifts_;
  PlannedStates states_;
  std::vector<std::size_t> state_of_;   ///< [p]
  std::vector<double> largest_factor_;  ///< [states of the machine]
  std::vector<std::shared_ptr<const Instrument>> devices_;
  std::vector<Sight> sights_;
  bool sights_stand_anywhere_ = true;
  /// Readings that plans of the study allow, of the set-ups that have no sights.
  std::vector<std::pair<std::size_t, InstrumentReadings>> given_;
  std::vector<EstimatedParameter> parameters_;
  Eigen::MatrixXd known_;
};

/// Uncertainty that a number of readings would give.
struct PlanPoint {
  std::size_t readings = 0;
  bool determined = false;
  double uncertainty = 0;  ///< mm, root mean square of the predicted volumetric standard uncertainty; where determined
  double with_prior = 0;   ///< mm, the same with PlanningModel::weak_prior() added
};

/// A grid that was compared.
struct GridPoint {
  std::string words;  ///< how it is made
  PlanPoint value;
  std::size_t open = 0;    ///< directions that the candidates see and it does not
  std::string open_words;  ///< the errors in them
};

/// The best grids of at least as many readings (up to a fifth more).
struct GridsOfANumber {
  std::size_t tried = 0;
  std::optional<GridPoint> determined;  ///< the best one that determines everything that the candidates see
  std::optional<GridPoint> any;         ///< the best one with the weak prior, whether it determines everything or not
};

/// As many readings as a plan over states has, without its choice of states.
struct PlainStates {
  enum class Kind {
    ends,  ///< a grid at the lowest and at the highest states
    one    ///< a grid at one condition: in a course in one go, from there on
  };
  Kind kind = Kind::ends;
  std::vector<std::size_t> conditions;  ///< indices into PlannedStates::conditions(); of one: the best of some
  GridsOfANumber grids;
};

/// One combination of the set-ups and what it would be worth.
struct SetupChoice {
  std::size_t subset = 0;  ///< bit s: Study::setups[s] takes part
  std::vector<std::string> setups;
  std::size_t readings = 0;
  double time = 0;        ///< s
  double with_prior = 0;  ///< mm, as PlanPoint
  bool possible = false;  ///< false: no time is left for readings, or too few to determine what they can see
};

/// The best conditions for one number of them, and what they would be worth.
struct ConditionsOfANumber {
  std::vector<std::size_t> conditions;  ///< increasing, indices into PlannedStates::conditions()
  std::size_t readings = 0;
  double with_prior = 0;   ///< mm, as PlanPoint; 0: no time is left for readings
  std::size_t open = 0;    ///< directions that all conditions together see and no reading at these does
  std::string open_words;  ///< the errors in them
  bool chosen = false;     ///< by the plan
};

/// Uncertainty at states at which the errors will be used.
struct UncertaintyAtStates {
  std::vector<double> states;  ///< [states of the machine]
  double time_s = 0;           ///< of the course
  double uncertainty = 0;      ///< mm, root mean square of the volumetric standard uncertainty over the poses
};

/// Effect of the drift of set-ups on a plan.
struct PlanBesideDrift {
  std::vector<std::string> setups;  ///< what each of those that drift does; empty: nothing drifts
  bool determined = true;           ///< false: what is asked for cannot be told from the drift
  double still = 0;                 ///< mm, the uncertainty of the same readings if nothing drifted
  std::size_t parts = 0;            ///< of the measurement, among which poses were shared out
  std::size_t poses = 0;            ///< different ones
  std::size_t returned_to = 0;      ///< of these, left and visited again
  std::size_t most_visits = 0;      ///< of one pose
};

/// A plan of readings and what it is worth.
struct StudyPlan {
  ReadingPlan plan;
  std::vector<CandidateReading> readings;  ///< in the order in which they are to be taken
  double time = 0;                         ///< s
  double uncertainty = 0;                  ///< mm, as PlanPoint
  std::size_t candidates = 0, hidden = 0, forbidden = 0;
  std::size_t parameters = 0, seen = 0;
  int refinements = 0;     ///< rounds in which poses beside the chosen ones were tried
  double unseen_part = 0;  ///< largest part of a prediction that lies in directions no candidate sees, 0..1
  std::vector<PlanPoint> curve;
  std::size_t enough = 0;  ///< index into curve; its size: not reached
  std::string enough_words;
  double with_prior = 0;                    ///< mm, of the plan with the weak prior
  std::vector<GridsOfANumber> curve_grids;  ///< [curve]
  GridsOfANumber same_number;               ///< of as many readings as the plan has
  std::size_t grids_tried = 0;              ///< in all
  std::optional<GridPoint> equal_grid;      ///< smallest determined grid found that is as good as the plan
  std::size_t random_tried = 0;
  std::optional<PlanPoint> random_poses;  ///< median of choices of as many candidates at random
  std::vector<SetupChoice> combinations;  ///< those that were compared; empty where setting up costs nothing
  NotIdentified not_identified;           ///< errors of the machine that no predicted uncertainty covers
  /// Where errors have states: when readings are taken, and how much that is worth. Else there is one condition, and
  /// the rest is empty.
  PlannedStates states;
  std::vector<ConditionsOfANumber> condition_curve;
  ConditionsOfANumber conditions;                   ///< of the plan
  std::vector<std::vector<double>> reading_states;  ///< [readings][states of the machine]
  std::vector<UncertaintyAtStates> over_states;
  SensorSelection sensors;
  std::vector<PlainStates> plain_states;  ///< that were compared
  PlanBesideDrift drift;
};

/// Whether readings at the conditions of a plan leave open what the errors do at the states at which they will be used.
/// The uncertainties of such a plan are those with the weak prior.
inline bool leaves_states_open(const StudyPlan& plan) { return plan.conditions.open > 0; }

/// Chooses readings for a study with a [plan] table. Where setting an instrument up takes time, every combination of up
/// to six set-ups is tried, and the best one is planned.
/// @param options  progress in thousandths of the work, called from one thread
/// @throws InputError
/// @throws Stopped
StudyPlan plan_study(const Study& study, const JobOptions& options = {});

/// When each reading is finished, s from the start or on the clock of the course: changes of states, setting up, moves
/// of the slowest axis, settling, reading.
/// @param readings  in their order
std::vector<double> reading_times(const Study& study, const std::vector<CandidateReading>& readings,
                                  const PlannedStates& states = {});

/// Root mean square of the predicted volumetric uncertainty, mm, of readings with the weak prior.
double uncertainty_with_prior(const PlanningModel& model, const PlanningCandidates::Rows& rows,
                              const Eigen::MatrixXd& predictions);

/// Which measured states the planned readings and the errors found from them need: by the error that remains if one is
/// not there. Errors with states are taken to be as large as `initial_errors` of the study has them, or as
/// PlanningModel's weak prior does.
/// @param readings        their rows, as PlanningModel::rows_of() makes them
/// @param reading_states  [readings][states of the machine]
SensorSelection planned_sensors(const PlanningModel& model, const PlanningCandidates& readings,
                                const Eigen::MatrixXd& predictions,
                                const std::vector<std::vector<double>>& reading_states);

/// Errors that take part most in the directions that readings leave open, by their knowledge in PlanningModel's weak
/// prior: "EXX[P1], EYX[P2]".
/// @param rank  of the rows within the space
std::string open_errors(const PlanningModel& model, const PlanningSpace& space, const PlanningCandidates::Rows& rows,
                        std::size_t rank);

/// Looks for the grids that one would really take: for every number of the curve, for the plan's and for larger ones.
/// @param job  no progress; grids are numbered work, and every process gets the result
/// @throws Stopped
void compare_with_grids(const PlanningModel& model, const PlanningSpace& space, const Eigen::MatrixXd& predictions,
                        StudyPlan& result, const JobOptions& job = {});

/// Looks for grids at plain states: the lowest and the highest, or one condition; as many readings as the plan has.
/// @param job  as compare_with_grids()
/// @throws Stopped
void compare_with_plain_states(const PlanningModel& model, const PlanningSpace& space,
                               const Eigen::MatrixXd& predictions, StudyPlan& result, const JobOptions& job = {});

}  // namespace abbe
