#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/report/customer/customer_report.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::Pair;

CustomerFigure figure_of(const char* symbol, CustomerValue value, std::optional<double> tolerance) {
  CustomerFigure figure;
  figure.symbol = symbol;
  figure.unit = "µm";
  figure.states = {value};
  figure.tolerance = tolerance;
  return figure;
}

CustomerReport report_with(std::vector<CustomerFigure> figures) {
  CustomerReport report;
  report.states = {{"measured", ""}};
  report.figures = std::move(figures);
  return report;
}

constexpr std::optional<double> kNone = std::nullopt;

TEST(CustomerVerdict, SaysWhatIsProvenOfWhichFigures) {
  // U = 2, u = 1, g = 1.65.
  const CustomerReport report =
      report_with({figure_of("A", {5.0, 2.0}, 10), figure_of("E", {9.0, 2.0}, 10), figure_of("R", {12.0, 2.0}, 10),
                   figure_of("M", {3.0, 2.0}, 10), figure_of("B", {3.0, 2.0}, kNone)});
  EXPECT_THAT(customer_verdict(report, 0),
              ElementsAre(Pair(Conformity::nonconformity_proven, "Nonconformity with the specification is proven: R."),
                          Pair(Conformity::not_proven, "Neither conformity nor nonconformity is proven: E."),
                          Pair(Conformity::proven, "Conformity with the specification is proven: A, M.")));
  EXPECT_EQ(exceeded_tolerances(report), "R");
}

TEST(CustomerVerdict, WithoutToleranceUncertaintyOrValueThereIsNoneAndAReason) {
  EXPECT_THAT(customer_verdict(report_with({figure_of("A", {5.0, 2.0}, kNone)}), 0),
              ElementsAre(Pair(Conformity::not_judged, "No verdict: no tolerance is stated.")));
  const CustomerReport report = report_with(
      {figure_of("A", {5.0, kNone}, 10), figure_of("R", {kNone, kNone}, 10), figure_of("V_max", {5.0, 1.0, true}, 10)});
  EXPECT_THAT(customer_verdict(report, 0),
              ElementsAre(Pair(Conformity::not_judged, "No verdict: not evaluated (R)."),
                          Pair(Conformity::not_judged, "No verdict: the measurement uncertainty is not known (A)."),
                          Pair(Conformity::not_judged,
                               "No verdict: the uncertainty does not cover all errors of the machine (V_max).")));
  EXPECT_EQ(exceeded_tolerances(report), "R") << "what is not known satisfies no tolerance";
}

TEST(CustomerVerdict, AStateCanHaveNoneAtAll) {
  CustomerReport report = report_with({figure_of("A", {50.0, 2.0}, 10)});
  report.states[0].no_verdict = "it is predicted";
  EXPECT_THAT(customer_verdict(report, 0), ElementsAre(Pair(Conformity::not_judged, "No verdict: it is predicted.")));
  EXPECT_EQ(exceeded_tolerances(report), "");
}

TEST(CustomerVerdict, TheLastJudgedStateIsHowTheMachineIsNow) {
  CustomerReport report;
  report.states = {{"before", ""}, {"after", ""}};
  CustomerFigure figure = figure_of("A", {50.0, 2.0}, 10);
  figure.states.push_back({5.0, 2.0});
  report.figures = {figure};
  EXPECT_EQ(customer_conformity(report, 0, 0), Conformity::nonconformity_proven);
  EXPECT_EQ(customer_conformity(report, 0, 1), Conformity::proven);
  EXPECT_EQ(exceeded_tolerances(report), "");
}

}  // namespace
}  // namespace abbe
