// Plans of readings while set-ups drift.
#include "abbe/study/planning/planning_drift.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/study/identification/setup_drifts.h"
#include "abbe/study/planning/plan_text.h"
#include "abbe/study/planning/planning_schedule.h"
#include "abbe/study/random_poses.h"
#include "abbe/study/run_study.h"
#include "abbe/study/study_steps.h"

namespace abbe {
namespace {

using Eigen::Index;
using testing::HasSubstr;

const char* const kDriftSlide = R"(name = "column on a slide"
chain = "w b X Z t"
[axis.X]
travel_mm = [0, 1000]
[axis.Z]
travel_mm = [0, 600]
[tool]
reference_mm = [0, 250, 200]
[state.hall]
kind = "measured"
unit = "degC"
)";

/// A tracker that wanders along two axes and creeps along X and about Z.
const char* const kDriftOfTracker = R"([setup.drift]
components = ["x", "z", "rz"]
degree = 2
random_walk_um_per_sqrt_h = 6
random_walk_urad_per_sqrt_h = 2
knots = 12
)";

struct DriftCase {
  std::string drift = kDriftOfTracker;
  std::string plan = "[plan]\nposes = 200\nreadings = 72\nsettle_s = 20\nreading_s = 5\n";
  std::string simulate, in_setup, terms;
  bool find = false;
};

Study drift_case(const std::filesystem::path& folder, const DriftCase& one) {
  std::ofstream(folder / "slide.machine.toml") << kDriftSlide;
  const std::filesystem::path file = folder / "drift.study.toml";
  std::ofstream(file) << fmt::format(R"(name = "drift"
machine = "slide.machine.toml"
seed = 4
{}
[[setup]]
name = "tracker"
instrument = "tracker"
mounted_on = "bed"
noise = {{ xyz_um = 2 }}
{}
[[setup.station]]
name = "station"
{} = {{ position_mm = [1500, -2200, 300], angles_deg = [0.4, -0.8, 70] }}
[[setup.reflector]]
name = "R1"
offset_mm = [0, 0, 0]
[[setup.reflector]]
name = "R2"
offset_mm = [120, 40, -60]
[[setup.reflector]]
name = "R3"
offset_mm = [-80, -50, 90]
{}
[identify]
held_out_fraction = 0
[[identify.motion]]
errors = ["EXX", "EZZ", "EYX", "EBX"]
basis = "legendre"
order = 2
{}
{}
)",
                                     one.simulate, one.drift, one.find ? "true_pose" : "pose", one.in_setup, one.terms,
                                     one.plan);
  Study study = read_study(file);
  study.threads = 1;
  return study;
}

Eigen::MatrixXd predictions_for(const PlanningModel& model) {
  const Study& study = model.study();
  PoseList poses = random_plan(study.machine, study.planning->axes, 100, 99);
  std::vector<std::vector<double>> states;
  const std::vector<std::vector<double>>& used = model.states().used_at();
  for (std::size_t k = 0; k < poses.count(); ++k) states.push_back(used[k % used.size()]);
  give_states(states, poses);
  return model.prediction_rows(poses);
}

/// The readings of a plan, exact, at their times.
InstrumentReadings exact_readings(const Study& study, const Instrument& device, const StudyPlan& plan) {
  InstrumentReadings readings;
  readings.poses.axis.resize(study.machine.axes.size());
  for (const CandidateReading& one : plan.readings) readings.append(one.pose, one.item, one.inputs);
  InstrumentSimulationOptions options;
  options.noise_factor = 0;
  options.threads = 1;
  readings = device.simulate(study.machine, ErrorSet{}, readings, options).readings;
  readings.time_s = reading_times(study, plan.readings, plan.states);
  readings.uncertainty.clear();
  readings.covariance.clear();
  return readings;
}

/// The walk as noise that readings have in common, and the polynomial as columns: a shift of the station acts on a
/// reading as its position does.
TEST(PlanBesideDrift, HasTheInformationOfADenseModelWithCorrelatedNoise) {
  const std::filesystem::path folder = test::empty_folder("plan_drift_dense");
  DriftCase one;
  one.drift = "[setup.drift]\ncomponents = [\"x\", \"z\"]\ndegree = 2\nrandom_walk_um_per_sqrt_h = 6\nknots = 200\n";
  const Study study = drift_case(folder, one);
  // Any readings do, in an order and at times as a plan has them.
  const PlanningSetting setting = planning_setting(study, {0}, 100);
  StudyPlan plan;
  for (std::size_t k = 0; k < 36; ++k) plan.readings.push_back(setting.candidates.readings.at(8 * k + k % 3));
  plan.readings = scheduled_readings(study, plan.states, plan.readings);
  const PlanningModel model(study);
  const std::vector<double> times = reading_times(study, plan.readings, plan.states);
  const auto device = study.setups[0].device->as_planned();
  const InstrumentReadings readings = exact_readings(study, *device, plan);
  Problem still = estimate_everything(study.machine, model.errors(),
                                      {device->observations(study.machine, model.errors(), readings)});
  still.machine_parameters.resize(still.machine_parameters.size() - 3);  // the offset of the tool
  const PlanningCandidates all = candidate_rows(still);
  const std::vector<EstimatedParameter> parameters = estimated_parameters(still);
  const auto p = static_cast<Index>(parameters.size()), n = all.rows.rows();
  ASSERT_EQ(p, static_cast<Index>(model.parameter_count()));
  const double first = times.front(), span = times.back() - times.front();
  const double variance = 6e-3 * 6e-3 / 3600;
  Eigen::MatrixXd noise = Eigen::MatrixXd::Identity(n, n), creep(n, 4);
  Index next = 0;
  for (const char* name : {"station.x", "station.z"}) {
    const auto at = std::find_if(parameters.begin(), parameters.end(), [&](const auto& q) { return q.name == name; });
    ASSERT_NE(at, parameters.end());
    const Eigen::VectorXd shift = all.rows.col(at - parameters.begin());
    for (Index i = 0; i < n; ++i) {
      const double ti = times[static_cast<std::size_t>(i / 3)] - first;
      for (Index j = 0; j < n; ++j) {
        noise(i, j) += shift[i] * shift[j] * variance * std::min(ti, times[static_cast<std::size_t>(j / 3)] - first);
      }
      creep(i, next) = shift[i] * ti / span;
      creep(i, next + 1) = shift[i] * ti / span * ti / span;
    }
    next += 2;
  }
  Eigen::MatrixXd columns(n, p + 4);
  columns << all.rows, creep;
  const Eigen::MatrixXd whole = columns.transpose() * Cholesky(noise).solve_columns(columns);
  const Eigen::MatrixXd information =
      whole.topLeftCorner(p, p) -
      whole.topRightCorner(p, 4) *
          Cholesky(Eigen::MatrixXd(whole.bottomRightCorner(4, 4))).solve_columns(whole.bottomLeftCorner(4, p));
  const PlanningCandidates taken = rows_as_taken(model, plan.readings);
  const Eigen::MatrixXd planned = taken.rows.transpose() * taken.rows;
  for (Index i = 0; i < p; ++i) {
    for (Index j = 0; j < p; ++j) {
      // Compared with what readings see without the drift.
      const double scale = all.rows.col(i).norm() * all.rows.col(j).norm();
      EXPECT_NEAR(planned(i, j), information(i, j), 1e-9 * scale) << i << " " << j;
    }
  }
}

/// The covariance of an identification of exact readings at the poses and times of the plan.
TEST(PlanBesideDrift, PredictsTheCovarianceOfTheIdentification) {
  const std::filesystem::path folder = test::empty_folder("plan_drift_covariance");
  const Study study = drift_case(folder, {});
  const StudyPlan plan = plan_study(study);
  ASSERT_EQ(plan.plan.status, PlanningStatus::done);
  const PlanningModel model(study);
  const auto device = study.setups[0].device->as_planned();
  InstrumentReadings readings = exact_readings(study, *device, plan);
  readings.drift = assumed_drift(*study.setups[0].drift, *device, readings, "tracker");
  Problem problem = estimate_everything(study.machine, model.errors(),
                                        {device->observations(study.machine, model.errors(), readings)});
  problem.machine_parameters.resize(problem.machine_parameters.size() - 3);
  add_walk_priors(*study.setups[0].drift, *readings.drift, 0, problem);
  const Identification found = identify(problem);
  ASSERT_EQ(found.status, IdentifyStatus::converged) << found.message;
  const Eigen::MatrixXd rows = predictions_for(model);
  Eigen::MatrixXd by_found = Eigen::MatrixXd::Zero(rows.rows(), static_cast<Index>(found.parameters.size()));
  for (std::size_t i = 0; i < found.parameters.size(); ++i) {
    for (std::size_t q = 0; q < model.parameter_count(); ++q) {
      if (model.parameters()[q].name == found.parameters[i].name)
        by_found.col(static_cast<Index>(i)) = rows.col(static_cast<Index>(q));
    }
  }
  const double variance = (by_found * found.covariance).cwiseProduct(by_found).sum();
  const PlanningSetting setting = planning_setting(study, {0}, 200);
  const PlanningSpace space(setting.candidates.rows, model.known());
  const auto planned = point_as_taken(model, space, rows, plan.readings);
  ASSERT_TRUE(planned);
  EXPECT_NEAR(planned->uncertainty / std::sqrt(variance / 100), 1, 1e-9);
}

TEST(PlanBesideDrift, ReadingsAreSharedOutOverTheTime) {
  const std::filesystem::path folder = test::empty_folder("plan_drift_choice");
  const Study study = drift_case(folder, {});
  DriftCase without;
  without.drift = "";
  const StudyPlan plan = plan_study(study), still = plan_study(drift_case(folder, without));
  ASSERT_EQ(plan.plan.status, PlanningStatus::done);
  EXPECT_TRUE(still.drift.setups.empty());
  const PlanningModel model(study);
  const PlanningSetting setting = planning_setting(study, {0}, 200);
  const PlanningSpace space(setting.candidates.rows, model.known());
  const auto unprepared = point_as_taken(model, space, setting.predictions, still.readings);
  ASSERT_TRUE(unprepared);
  EXPECT_EQ(still.readings.size(), plan.readings.size());
  EXPECT_LT(plan.uncertainty, 0.9 * unprepared->uncertainty);
  EXPECT_GT(plan.uncertainty, still.uncertainty) << "a drift costs";
  EXPECT_GT(plan.uncertainty, plan.drift.still);
  EXPECT_GT(plan.drift.returned_to, 0U);
  EXPECT_GE(plan.drift.most_visits, 2U);
  for (std::size_t k = 1; k < plan.readings.size(); ++k) EXPECT_GE(plan.readings[k].part, plan.readings[k - 1].part);
  EXPECT_THAT(plan_csv(study, plan), HasSubstr("X_mm,Z_mm,station,reflector,time_s\n"));
  EXPECT_THAT(plan_csv(study, still), HasSubstr("X_mm,Z_mm,station,reflector\n"));
  const std::string text = study_plan_text(study, plan);
  EXPECT_THAT(text,
              HasSubstr("tracker: x, z, rz; polynomial of degree 2; random walk of 6 um and 2 urad after an hour"));
  EXPECT_THAT(text, HasSubstr("if nothing drifted"));
  EXPECT_EQ(plan_json(study, plan)["drift"]["poses_returned_to"], plan.drift.returned_to);
  EXPECT_EQ(plan_json(study, still).count("drift"), 0U);
  // More readings are a longer measurement, in which more drifts; the curve still falls.
  ASSERT_GE(plan.curve.size(), 5U);
  EXPECT_LT(plan.curve.back().uncertainty, plan.curve.front().uncertainty);
}

/// What identifications of simulated readings get wrong is as large as the plan says.
TEST(PlanBesideDrift, SimulatedCampaignsScatterAsPredicted) {
  const std::filesystem::path folder = test::empty_folder("plan_drift_draws");
  const Study planned = drift_case(folder, {});
  const StudyPlan plan = plan_study(planned);
  ASSERT_EQ(plan.plan.status, PlanningStatus::done);
  std::ofstream(folder / "poses.csv") << plan_csv(planned, plan);
  std::ofstream(folder / "truth.errors.toml")
      << "[[motion]]\nname = \"EXX\"\nbasis = \"legendre\"\norder = 2\ncoefficients_um = [0, 5, -3]\n";
  DriftCase one;
  one.simulate = "[simulate]\nerrors = \"truth.errors.toml\"";
  one.in_setup = "[[setup.plan]]\nkind = \"poses\"\nfile = \"poses.csv\"\n";
  one.plan = "";
  one.find = true;
  one.drift += "[setup.drift.true]\nx_um = [25, -10]\nrandom_walk_um_per_sqrt_h = 6\nrandom_walk_urad_per_sqrt_h = 2\n";
  // All six motions wander in the truth; the model has them all.
  one.drift.replace(one.drift.find("[\"x\", \"z\", \"rz\"]"), 16, "[\"x\", \"y\", \"z\", \"rx\", \"ry\", \"rz\"]");
  Study study = drift_case(folder, one);
  const PlanningModel model(planned);
  const Eigen::MatrixXd rows = predictions_for(model);
  DriftCase identified;
  identified.drift = one.drift.substr(0, one.drift.find("[setup.drift.true]"));
  const Study same = drift_case(folder, identified);
  const PlanningModel wide(same);
  const PlanningSetting setting = planning_setting(same, {0}, 200);
  const PlanningSpace space(setting.candidates.rows, wide.known());
  const auto predicted = point_as_taken(wide, space, rows, plan.readings);
  ASSERT_TRUE(predicted);
  constexpr int kCampaigns = 40;
  double squares = 0, of_squares = 0;
  for (int draw = 0; draw < kCampaigns; ++draw) {
    study.seed = 500 + static_cast<std::uint64_t>(draw);
    StudyResult result;
    result.campaign = gather_readings(study);
    prepare_study(study, result);
    const Identification found = identify(result.model.problem, identify_options(study));
    ASSERT_EQ(found.status, IdentifyStatus::converged) << found.message;
    Eigen::VectorXd error = Eigen::VectorXd::Zero(rows.rows());
    for (std::size_t i = 0; i < found.parameters.size(); ++i) {
      const std::string& name = found.parameters[i].name;
      const double truth = name == "EXX[P1]" ? 5e-3 : name == "EXX[P2]" ? -3e-3 : 0;
      for (std::size_t q = 0; q < model.parameter_count(); ++q) {
        if (model.parameters()[q].id.is_machine() && model.parameters()[q].name == name)
          error += rows.col(static_cast<Index>(q)) * (found.estimates[static_cast<Index>(i)] - truth);
      }
    }
    const double square = error.squaredNorm() / 100;
    squares += square / kCampaigns;
    of_squares += square * square / kCampaigns;
  }
  const double scatter = std::sqrt((of_squares - squares * squares) / kCampaigns);
  EXPECT_NEAR(squares, predicted->uncertainty * predicted->uncertainty, 4 * scatter);
}

TEST(PlanBesideDrift, PlansOverStatesHaveItToo) {
  const std::filesystem::path folder = test::empty_folder("plan_drift_states");
  DriftCase one;
  one.terms = "[[identify.motion]]\nerrors = \"EXX\"\nstate = \"hall\"\nbasis = \"legendre\"\norder = 1\n";
  one.plan += "[plan.state.hall]\nvalues = [18, 21, 24]\nchange_min = 20\n";
  one.drift = "[setup.drift]\ndegree = 1\n";
  const Study study = drift_case(folder, one);
  const StudyPlan plan = plan_study(study);
  ASSERT_EQ(plan.plan.status, PlanningStatus::done);
  EXPECT_GT(plan.uncertainty, 1.05 * plan.drift.still);
  const PlanningModel model(study);
  const PlanningCandidates rows = rows_as_taken(model, plan.readings);
  EXPECT_NEAR(uncertainty_with_prior(model, rows.rows, predictions_for(model)), plan.with_prior, 0.1 * plan.with_prior);
  EXPECT_THAT(plan_csv(study, plan), HasSubstr("reflector,time_s,hall_degC\n"));
}

TEST(PlanBesideDrift, SaysWhereNothingCanBeToldFromIt) {
  const std::filesystem::path folder = test::empty_folder("plan_drift_open");
  DriftCase one;
  one.plan = "[plan]\nposes = 200\nreadings = 10\n";
  one.drift = "[setup.drift]\ncomponents = [\"x\", \"y\", \"z\", \"rx\", \"ry\", \"rz\"]\ndegree = 3\n";
  const Study study = drift_case(folder, one);
  const StudyPlan plan = plan_study(study);
  EXPECT_EQ(plan.plan.status, PlanningStatus::not_determined);
  EXPECT_FALSE(plan.drift.determined);
  EXPECT_THAT(study_plan_text(study, plan), HasSubstr("do not separate it from the errors"));
}

}  // namespace
}  // namespace abbe
