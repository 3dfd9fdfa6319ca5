#include "abbe/study/comparison/comparison_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "abbe/geometry/decompositions.h"
#include "abbe/study/comparison/campaigns_for_test.h"
#include "abbe/study/comparison/compared_errors.h"
#include "abbe/study/comparison/comparison_gauge.h"

namespace abbe {
namespace {

/// A campaign that knows EXX alone.
IdentifiedCampaign only_exx(const Basis& basis, const std::vector<double>& coefficients_um, double u_um) {
  IdentifiedCampaign campaign = mill_campaign("exx");
  ErrorMotion motion;
  motion.axis = campaign.machine.find_axis("X");
  motion.basis = basis;
  for (const double value : coefficients_um) motion.coefficients.push_back(1e-3 * value);
  campaign.errors = {};
  campaign.errors.errors.motions = {motion};
  const auto p = static_cast<Eigen::Index>(campaign.errors.errors.parameter_count());
  campaign.errors.covariance = Eigen::MatrixXd::Zero(p, p);
  for (Eigen::Index i = 1; i < p - 3; ++i) campaign.errors.covariance(i, i) = 1e-6 * u_um * u_um;
  return campaign;
}

Basis legendre(int order, double from = 0, double to = 760) {
  return {.kind = BasisKind::legendre, .order = order, .from = from, .to = to};
}

ComparisonModel model_of(const IdentifiedCampaign& first, const IdentifiedCampaign& second) {
  return comparison_model(common_machine({first, second}), first, second);
}

TEST(ComparisonModel, TakesTheFunctionsOfTheCampaignThatHasFewer) {
  const IdentifiedCampaign fine = only_exx(legendre(4), {0, 10, 3, -2, 5}, 0.5);
  const IdentifiedCampaign coarse = only_exx(legendre(2), {0, 10, 3}, 0.5);
  for (const bool swapped : {false, true}) {
    const ComparisonModel model = swapped ? model_of(coarse, fine) : model_of(fine, coarse);
    ASSERT_EQ(model.errors.motions.size(), 1U);
    EXPECT_EQ(model.errors.motions[0].basis.order, 2);
    // Legendre polynomials are orthogonal.
    const Eigen::VectorXd change = model.campaigns[1].values - model.campaigns[0].values;
    EXPECT_LT(change.head(3).cwiseAbs().maxCoeff(), 2e-5);
    const double left = model.list.front().beyond[swapped ? 1 : 0];
    EXPECT_NEAR(left, 7e-3, 0.05e-3);  // |P3| and |P4| are 1 at the lower end, with signs -1 and 1
    EXPECT_EQ(model.list.front().beyond[swapped ? 0 : 1], 0);
  }
}

TEST(ComparisonModel, AShapeThatOnlyOneCanDescribeIsNoChange) {
  ComparedPair pair;
  compare_errors(model_of(only_exx(legendre(4), {0, 10, 3, 0, 30}, 0.5), only_exx(legendre(2), {0, 10, 3}, 0.5)),
                 {.level = 0.05, .one_gauge = false}, pair);
  ASSERT_FALSE(pair.errors.empty());
  EXPECT_NE(pair.errors[0].verdict, ChangeVerdict::changed) << pair.errors[0].probability;
  EXPECT_GT(pair.errors[0].beyond[0], 25e-3);
}

TEST(ComparisonModel, PolynomialsOverOtherRangesAreTheSameFunctions) {
  // f = P3 over 0 to 760 mm, stated over 100 to 500 mm by its values there.
  const IdentifiedCampaign whole = only_exx(legendre(3), {1, 10, 3, 8}, 0.5);
  const std::vector<double> at = evenly_spaced(100, 500, 4);
  Eigen::MatrixXd functions(4, 4);
  Eigen::VectorXd values(4);
  std::vector<double> row(4);
  const Basis part = legendre(3, 100, 500);
  for (std::size_t i = 0; i < 4; ++i) {
    part.values(at[i], {}, row);
    for (std::size_t k = 0; k < 4; ++k) functions(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = row[k];
    values[static_cast<Eigen::Index>(i)] = 1e3 * whole.errors.errors.evaluate(whole.machine.find_axis("X"), at[i])[0];
  }
  const Eigen::VectorXd c = PartialLu(functions).solve(values);
  const IdentifiedCampaign narrow = only_exx(part, {c[0], c[1], c[2], c[3]}, 0.5);
  const ComparisonModel model = model_of(whole, narrow);
  EXPECT_EQ(model.list[0].from, 100);
  EXPECT_EQ(model.list[0].to, 500);
  EXPECT_LT((model.campaigns[1].values - model.campaigns[0].values).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(model.list[0].beyond[0], 0);
  // The variance of the function at a position is what it was.
  const Eigen::VectorXd before = sampled_functions(whole.errors.errors.motions, {300}).row(0);
  const Eigen::VectorXd after = sampled_functions(model.errors.motions, {300}).row(0);
  EXPECT_NEAR(after.dot(model.campaigns[0].covariance.topLeftCorner(4, 4) * after) /
                  before.dot(whole.errors.covariance.topLeftCorner(4, 4) * before),
              1, 1e-9);
}

TEST(ComparisonModel, TablesAreCutToTheCommonRange) {
  const Basis table{.kind = BasisKind::table_linear, .from = 0, .to = 760, .nodes = {0, 200, 400, 760}};
  const Basis narrow{.kind = BasisKind::table_linear, .from = 100, .to = 300, .nodes = {100, 200, 300}};
  const ComparisonModel model = model_of(only_exx(table, {0, 4, 8, 2}, 1), only_exx(narrow, {2, 4, 6}, 1));
  EXPECT_LT((model.campaigns[1].values - model.campaigns[0].values).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(model.list[0].beyond[0], 0);
  const ComparisonModel apart =
      model_of(only_exx(legendre(2, 0, 300), {0, 1, 1}, 1), only_exx(legendre(2, 400, 700), {0, 1, 1}, 1));
  EXPECT_EQ(apart.apart, std::vector<std::string>{"EXX"});
}

// Two conventions for one machine: its X axis is not square to Y, which is either the squareness error EC0Y or the
// slope of the straightness error EYX.

constexpr double kSquareness = 40e-6;

std::size_t location_index(const IdentifiedCampaign& campaign, const std::string& name) {
  const ErrorSet& errors = campaign.errors.errors;
  for (std::size_t i = 0; i < errors.locations.size(); ++i) {
    if (location_error_name(campaign.machine, errors.locations[i].axis, errors.locations[i].component) == name)
      return i;
  }
  return errors.locations.size();
}

/// The mill with the slope in EYX in place of EC0Y. @param sense  of a slope that does what EC0Y does
IdentifiedCampaign with_slope(const IdentifiedCampaign& from, double sense) {
  IdentifiedCampaign campaign = from;
  ErrorSet& errors = campaign.errors.errors;
  const std::size_t squareness = location_index(campaign, "EC0Y");
  const std::size_t x = campaign.machine.find_axis("X");
  for (ErrorMotion& motion : errors.motions) {
    if (motion.axis == x && motion.component == Component::Y) {
      motion.coefficients[1] += sense * errors.locations[squareness].value * (motion.basis.to - motion.basis.from) / 2;
    }
  }
  errors.locations[squareness].value = 0;
  return campaign;
}

double apart_at_tool(const IdentifiedCampaign& a, const IdentifiedCampaign& b) {
  ErrorMapOptions options;
  options.remove_rigid_motion = true;
  return error_map(a.machine, a.errors.errors, &b.errors.errors,
                   pose_source(stated_grid(a.machine, {&a.errors.errors}).poses), options)
      .statistics.maximum;
}

TEST(ComparisonGauge, OtherConventionsForOneMachineAreNoChange) {
  IdentifiedCampaign first = mill_campaign("first");
  const std::size_t squareness = location_index(first, "EC0Y");
  ASSERT_LT(squareness, first.errors.errors.locations.size());
  first.errors.errors.locations[squareness].value = kSquareness;
  const double sense = apart_at_tool(first, with_slope(first, 1)) < 1e-4 ? 1 : -1;
  IdentifiedCampaign second = with_slope(first, sense);
  // The same machine, to first order.
  ASSERT_LT(apart_at_tool(first, second), 1e-4);
  // What the squareness was known to, the slope is known to: a map of the parameters, and of the covariance.
  const std::size_t x = first.machine.find_axis("X");
  const auto slope = static_cast<Eigen::Index>(first_parameter(first.errors.errors, x, Component::Y)) + 1;
  const auto at = static_cast<Eigen::Index>(first.errors.errors.parameter_count() - 3 -
                                            first.errors.errors.locations.size() + squareness);
  Eigen::MatrixXd moved = Eigen::MatrixXd::Identity(first.errors.covariance.rows(), first.errors.covariance.rows());
  moved(at, at) = 0;
  moved(slope, at) = sense * 380;
  second.errors.covariance = moved * first.errors.covariance * moved.transpose();

  const ComparedCampaigns result = compare_campaigns(request_of({first, second}));
  const ComparedPair& pair = result.pairs.front();
  EXPECT_FALSE(pair.conventions.empty());
  EXPECT_EQ(pair.count(ChangeVerdict::changed), 0U);
  EXPECT_TRUE(result.is_judged());
  const ComparedError& turned = *find_error(pair, "EC0Y");
  EXPECT_NEAR(turned.change, 0, 1e-3 * kSquareness);
  EXPECT_EQ(turned.verdict, ChangeVerdict::not_significant);
  EXPECT_NEAR(std::abs(turned.value[1]), kSquareness, 1e-3 * kSquareness);
  EXPECT_NEAR(find_error(pair, "EYX")->change, 0, 1e-5);
  EXPECT_FALSE(pair.chi_square);

  // The same if the file does not have the squareness at all.
  IdentifiedCampaign without = second;
  without.errors.errors.locations.erase(without.errors.errors.locations.begin() +
                                        static_cast<std::ptrdiff_t>(squareness));
  const Eigen::Index behind = second.errors.covariance.rows() - at - 1;
  Eigen::MatrixXd rest(at + behind, at + behind);
  rest << second.errors.covariance.topLeftCorner(at, at), second.errors.covariance.topRightCorner(at, behind),
      second.errors.covariance.bottomLeftCorner(behind, at), second.errors.covariance.bottomRightCorner(behind, behind);
  without.errors.covariance = rest;
  for (const bool swapped : {false, true}) {
    const ComparedPair other =
        compare_campaigns(swapped ? request_of({without, first}) : request_of({first, without})).pairs.front();
    EXPECT_TRUE(other.only_first.empty());
    EXPECT_TRUE(other.only_second.empty());
    EXPECT_EQ(other.count(ChangeVerdict::changed), 0U);
    ASSERT_NE(find_error(other, "EC0Y"), nullptr);
    EXPECT_NEAR(find_error(other, "EC0Y")->change, 0, 1e-3 * kSquareness);
    EXPECT_NEAR(*find_error(other, "EC0Y")->expanded_uncertainty, *turned.expanded_uncertainty, 1e-9);
  }

  // A change of the machine is still one.
  second.errors.errors.motions.front().coefficients[1] += 20e-3;
  EXPECT_EQ(compare_campaigns(request_of({first, second})).pairs.front().count(ChangeVerdict::changed), 1U);
}

TEST(ComparisonGauge, ReferenceLinesOverOtherRangesAreNoChange) {
  // The parabola of EYX has another reference line over a part of the travel, so another squareness belongs to it.
  IdentifiedCampaign first = mill_campaign("first");
  const std::size_t squareness = location_index(first, "EC0Y"), x = first.machine.find_axis("X");
  const double sense =
      apart_at_tool(first, with_slope(first, 1)) < apart_at_tool(first, with_slope(first, -1)) ? 1 : -1;
  IdentifiedCampaign second = first;
  const auto p = static_cast<Eigen::Index>(first_parameter(first.errors.errors, x, Component::Y));
  const auto at = static_cast<Eigen::Index>(first.errors.errors.parameter_count() - 3 -
                                            first.errors.errors.locations.size() + squareness);
  const Eigen::Index m = first.errors.covariance.rows();
  Eigen::MatrixXd map = Eigen::MatrixXd::Identity(m, m);
  const Basis part = legendre(3, 0, 400);
  const std::vector<double> positions = evenly_spaced(0, 400, 50);
  std::size_t index = 0;
  for (ErrorMotion& motion : second.errors.errors.motions) {
    if (motion.axis != x || motion.component != Component::Y) continue;
    ErrorMotion cut = motion;
    cut.basis = part;
    const Eigen::MatrixXd to = sampled_functions({cut}, positions), from = sampled_functions({motion}, positions);
    map.block(p, p, 4, 4) = CompleteOrthogonal(to).solve_columns(from);
    motion.basis = part;
    ++index;
  }
  ASSERT_EQ(index, 1U);
  // Its slope over 400 mm goes into the squareness, its value at zero into the place of the workpiece.
  Eigen::MatrixXd convention = Eigen::MatrixXd::Identity(m, m);
  convention(at, p + 1) = sense / 200;
  convention(p + 1, p + 1) = 0;
  convention.row(p) << Eigen::RowVectorXd::Zero(m);
  convention(p, p + 2) = -1;  // zero at 0 mm, where P2 is 1, P3 is -1
  convention(p, p + 3) = 1;
  map = convention * map;
  const std::vector<double> before = first.errors.errors.parameters();
  const Eigen::VectorXd after = map * Eigen::Map<const Eigen::VectorXd>(before.data(), m);
  second.errors.errors.set_parameters({after.data(), after.data() + m});
  second.errors.covariance = map * first.errors.covariance * map.transpose();
  ASSERT_GT(std::abs(after[at] - before[static_cast<std::size_t>(at)]), 5e-6);

  const ComparedCampaigns result = compare_campaigns(request_of({first, second}));
  const ComparedPair& pair = result.pairs.front();
  EXPECT_EQ(pair.count(ChangeVerdict::changed), 0U);
  EXPECT_TRUE(result.is_judged());
  EXPECT_EQ(find_error(pair, "EYX")->to, 400);
  EXPECT_NEAR(find_error(pair, "EC0Y")->change, 0, 1e-7);
  EXPECT_NEAR(find_error(pair, "EYX")->change, 0, 1e-5);
  EXPECT_LT(pair.change.statistics.maximum, 5e-5);
}

TEST(ComparisonGauge, AnErrorThatAConventionSetsInOneCampaignIsNoneOfTheOthers) {
  // The roll of X was not seen in the second campaign: a convention set it to zero.
  IdentifiedCampaign first = mill_campaign("first"), second = first;
  const std::size_t x = first.machine.find_axis("X");
  const auto at = static_cast<Eigen::Index>(first_parameter(first.errors.errors, x, Component::B));
  for (ErrorMotion& motion : second.errors.errors.motions) {
    if (motion.axis == x && motion.component == Component::B) motion.coefficients.assign(motion.coefficients.size(), 0);
  }
  second.errors.covariance.middleRows(at, 4).setZero();
  second.errors.covariance.middleCols(at, 4).setZero();
  const ComparedCampaigns result = compare_campaigns(request_of({first, second}));
  const ComparedPair& pair = result.pairs.front();
  EXPECT_EQ(find_error(pair, "EBX")->verdict, ChangeVerdict::only_first);
  EXPECT_EQ(pair.count(ChangeVerdict::changed), 0U);
  EXPECT_LT(pair.change.statistics.maximum, 1e-6);
}

}  // namespace
}  // namespace abbe
