#include "abbe/study/customer/customer_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "abbe/formats/text/input_error.h"
#include "abbe/identify/trust/prediction.h"
#include "abbe/study/identification/trust.h"
#include "abbe/study/run_study.h"

namespace abbe {
namespace {

using testing::Contains;
using testing::HasSubstr;

Study accepted_mill() { return read_study(ABBE_SOURCE_DIR "/examples/customer_report/mill.study.toml"); }

const CustomerFigure& figure_named(const CustomerReport& report, const std::string& symbol) {
  for (const CustomerFigure& figure : report.figures) {
    if (figure.symbol == symbol) return figure;
  }
  throw std::out_of_range(symbol);
}

class CustomerStudy : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    study = new Study(accepted_mill());
    result = new StudyResult(run_study(*study, {.map = false}));
  }
  static void TearDownTestSuite() {
    delete result;
    delete study;
  }
  static Study* study;
  static StudyResult* result;
};
Study* CustomerStudy::study = nullptr;
StudyResult* CustomerStudy::result = nullptr;

TEST_F(CustomerStudy, TheRangeOfAnErrorMotionHasTheUncertaintyOfThatDifference) {
  const CustomerFigure figure = figure_named(study_customer_report(*study, *result), "EXX");
  const ErrorSet& errors = result->identification.errors;
  const Eigen::MatrixXd covariance = machine_covariance(result->identification, errors.parameter_count());
  // By another route: differences of the error set itself, and derivatives by its parameters.
  const std::size_t x = study->machine.find_axis("X");
  double low = 1, high = -1, low_at = 0, high_at = 0;
  for (int i = 0; i <= 120; ++i) {
    const double q = 760.0 * i / 120, value = errors.evaluate(x, q)[0];
    if (value < low) low = value, low_at = q;
    if (value > high) high = value, high_at = q;
  }
  EXPECT_NEAR(*figure.states[0].value, 1e3 * (high - low), 1e-9);
  Eigen::VectorXd gradient(static_cast<Eigen::Index>(errors.parameter_count()));
  const std::vector<double> parameters = errors.parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    ErrorSet moved = errors;
    std::vector<double> changed = parameters;
    changed[p] += 1;  // linear in the coefficients
    moved.set_parameters(changed);
    gradient[static_cast<Eigen::Index>(p)] =
        moved.evaluate(x, high_at)[0] - moved.evaluate(x, low_at)[0] - (high - low);
  }
  EXPECT_NEAR(*figure.states[0].expanded_uncertainty, 2e3 * std::sqrt(gradient.dot(covariance * gradient)), 1e-6);
}

TEST_F(CustomerStudy, LocationErrorsAndVolumetricErrorAreThoseOfTheResult) {
  const CustomerReport report = study_customer_report(*study, *result);
  const LocationError& first = result->identification.errors.locations.front();
  const CustomerFigure& squareness = figure_named(report, "EC0Y");
  EXPECT_NEAR(*squareness.states[0].value, 1e6 * first.value, 1e-9);
  EXPECT_NEAR(*squareness.states[0].expanded_uncertainty, 2e6 * first.standard_uncertainty, 1e-9);
  const CustomerFigure& largest = figure_named(report, "V_max");
  EXPECT_NEAR(*largest.states[0].value, 1e3 * result->volumetric->predicted_before->maximum, 1e-6);
  EXPECT_GT(*largest.states[0].expanded_uncertainty, 0);
  EXPECT_NEAR(*largest.states[1].value, 1e3 * result->volumetric->predicted_after->maximum, 1e-6);
}

TEST_F(CustomerStudy, VerdictsAreOnTheMeasuredMachineOnly) {
  const CustomerReport report = study_customer_report(*study, *result);
  EXPECT_FALSE(report.is_simulated);
  const auto verdict = customer_verdict(report, 0);
  EXPECT_THAT(verdict, Contains(testing::Pair(Conformity::not_proven, HasSubstr("V_max"))));
  EXPECT_THAT(verdict, Contains(testing::Pair(Conformity::proven, HasSubstr("EXX, EYY, EZZ, EC0Y, EB0Z, EA0Z"))));
  EXPECT_THAT(customer_verdict(report, 1), Contains(testing::Pair(Conformity::not_judged, HasSubstr("predicted"))));
  EXPECT_EQ(exceeded_tolerances(report), "");
}

TEST_F(CustomerStudy, EachAxisHasATableOfItsErrorsAtPositions) {
  const CustomerReport report = study_customer_report(*study, *result);
  ASSERT_EQ(report.tables.size(), 3U);
  for (const CustomerTable& table : report.tables) {
    EXPECT_EQ(table.headers.size(), 7U);
    ASSERT_EQ(table.rows.size(), 11U);
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), 7U);
  }
  EXPECT_EQ(report.tables[0].rows.back()[0], "760");
  EXPECT_EQ(report.tables[2].rows.front()[0], "−460");
  EXPECT_EQ(report.drawings.size(), 1U) << "there is no rotary axis";
}

TEST_F(CustomerStudy, ADistrustedResultHasNoVerdictAndSaysWhy) {
  StudyResult doubtful = *result;
  doubtful.distrusted.push_back({DistrustKind::misfit, "the residuals are too large", {}});
  const CustomerReport report = study_customer_report(*study, doubtful);
  EXPECT_THAT(report.refusals, Contains(HasSubstr("the residuals are too large")));
  EXPECT_THAT(customer_verdict(report, 0), Contains(testing::Pair(Conformity::not_judged, HasSubstr("must not be"))));
  doubtful.misfit_accepted = true;
  const CustomerReport accepted = study_customer_report(*study, doubtful);
  EXPECT_TRUE(accepted.refusals.empty());
  EXPECT_THAT(accepted.notes, Contains(HasSubstr("the residuals are too large"))) << "not hidden";
}

TEST_F(CustomerStudy, WithoutAResultThereAreNoFigures) {
  StudyResult failed = *result;
  failed.identification.status = IdentifyStatus::no_convergence;
  const CustomerReport report = study_customer_report(*study, failed);
  EXPECT_TRUE(report.figures.empty());
  EXPECT_FALSE(report.refusals.empty());
}

TEST_F(CustomerStudy, AnUncertaintyThatCoversAPartOfTheErrorsProvesNothingOfTheVolume) {
  StudyResult partial = *result;
  partial.not_identified.errors.emplace_back();
  partial.not_identified.names.emplace_back("EXY");
  const CustomerReport report = study_customer_report(*study, partial);
  EXPECT_THAT(customer_verdict(report, 0),
              Contains(testing::Pair(Conformity::not_judged, HasSubstr("does not cover all errors of the machine"))));
}

TEST_F(CustomerStudy, AResultBeforeACorrectionStandsBesideTheMeasuredOne) {
  StudyResult corrected = *result;
  EarlierResult& before = corrected.before.emplace();
  before.errors = identified_errors_file(*study, *result);
  for (ErrorMotion& motion : before.errors.errors.motions) {
    const bool is_exx = motion.axis == study->machine.find_axis("X") && motion.component == Component::X;
    for (double& coefficient : motion.coefficients) coefficient *= is_exx ? 10 : 1;
  }
  const CustomerReport report = study_customer_report(*study, corrected);
  ASSERT_EQ(report.states.size(), 2U);
  EXPECT_EQ(report.states[0].name, "Before correction");
  const CustomerFigure& positioning = figure_named(report, "EXX");
  EXPECT_NEAR(*positioning.states[0].value, 10 * *positioning.states[1].value, 1e-9);
  EXPECT_NEAR(*positioning.states[0].expanded_uncertainty, *positioning.states[1].expanded_uncertainty, 1e-9);
  EXPECT_THAT(customer_verdict(report, 0), Contains(testing::Pair(Conformity::nonconformity_proven, HasSubstr("EXX"))));
  EXPECT_THAT(customer_verdict(report, 1), Contains(testing::Pair(Conformity::proven, HasSubstr("EXX"))));
  EXPECT_EQ(exceeded_tolerances(report), "") << "the machine is as it is after";

  before.errors.distrusted = {"the residuals are too large"};
  const CustomerReport doubtful = study_customer_report(*study, corrected);
  EXPECT_THAT(customer_verdict(doubtful, 0), Contains(testing::Pair(Conformity::not_judged, HasSubstr("must not be"))));
  EXPECT_THAT(doubtful.notes, Contains(HasSubstr("before: not to be trusted: the residuals are too large")));
}

TEST_F(CustomerStudy, FiguresBeforeWithoutUncertaintyProveNothing) {
  StudyResult corrected = *result;
  corrected.before.emplace().errors.errors = result->identification.errors;
  for (LocationError& location : corrected.before->errors.errors.locations) location.standard_uncertainty = 0;
  for (ErrorMotion& motion : corrected.before->errors.errors.motions) motion.standard_uncertainty.clear();
  const CustomerReport report = study_customer_report(*study, corrected);
  EXPECT_FALSE(figure_named(report, "EXX").states[0].expanded_uncertainty);
  EXPECT_FALSE(figure_named(report, "V_max").states[0].expanded_uncertainty);
  EXPECT_THAT(customer_verdict(report, 0), Contains(testing::Pair(Conformity::not_judged, HasSubstr("not known"))));
}

TEST(CustomerReportOfAStudy, OfSimulatedReadingsHasNoVerdict) {
  Study study = read_study(ABBE_SOURCE_DIR "/examples/three_axis/dials.study.toml");
  study.report.facts.emplace();
  const StudyResult result = run_study(study, {.map = false});
  const CustomerReport report = study_customer_report(study, result);
  EXPECT_TRUE(report.is_simulated);
  EXPECT_THAT(customer_verdict(report, 0), Contains(testing::Pair(Conformity::not_judged, HasSubstr("simulated"))));
}

TEST(CustomerReportOfAStudy, ItsTolerancesAreCheckedBeforeAnythingIsComputed) {
  Study study = accepted_mill();
  study.report.facts->tolerances = {{"EXX_mm", 0.01, {.file = "a.study.toml", .line = 3}}};
  try {
    run_study(study);
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("a.study.toml:3: there is no such figure in this unit"));
  }
  study.identification.reset();
  EXPECT_THROW(check_customer_report(study), InputError);
  study.report.facts.reset();
  EXPECT_NO_THROW(check_customer_report(study));
}

}  // namespace
}  // namespace abbe
