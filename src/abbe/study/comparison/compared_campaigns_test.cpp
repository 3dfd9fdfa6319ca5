#include "abbe/study/comparison/compared_campaigns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/text/message_of.h"
#include "abbe/identify/distributions.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/comparison/campaigns_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

std::vector<std::string> changed_errors(const ComparedPair& pair) {
  std::vector<std::string> names;
  for (const ComparedError& error : pair.errors) {
    if (error.verdict == ChangeVerdict::changed) names.push_back(error.name);
  }
  return names;
}

TEST(ComparedCampaigns, WithoutAChangeOneIsFoundAtTheStatedRateOnly) {
  constexpr std::size_t kDraws = 200;
  const IdentifiedCampaign truth = mill_campaign("mill");
  std::size_t families = 0, tests = 0, below_half = 0, whole_below_half = 0;
  double share = 0;
  for (std::size_t k = 0; k < kDraws; ++k) {
    const ComparedCampaigns result =
        compare_campaigns(request_of({drawn(truth, 5, 2 * k), drawn(truth, 5, 2 * k + 1)}));
    const ComparedPair& pair = result.pairs.front();
    EXPECT_TRUE(result.is_judged());
    families += changed_errors(pair).empty() ? 0U : 1U;
    whole_below_half += pair.probability < 0.5 ? 1U : 0U;
    share += *pair.share / kDraws;
    for (const ComparedError& error : pair.errors) {
      if (!error.chi_square) continue;
      ++tests;
      below_half += error.probability < 0.5 ? 1U : 0U;
    }
  }
  // Binomial: 10 of 200 at 5 %, three standard deviations to either side.
  EXPECT_GE(families, 1U);
  EXPECT_LE(families, 19U);
  // Probabilities of true hypotheses are uniform. The tests of a draw depend on each other, so more room is left.
  EXPECT_NEAR(static_cast<double>(below_half) / static_cast<double>(tests), 0.5, 0.05);
  EXPECT_NEAR(static_cast<double>(whole_below_half) / kDraws, 0.5, 0.11);
  EXPECT_GT(share, 0.001);
  EXPECT_LT(share, 0.05);
}

TEST(ComparedCampaigns, AKnownChangeIsFoundWithItsAmountAndNothingElse) {
  constexpr std::size_t kDraws = 100;
  const IdentifiedCampaign march = mill_campaign("march");
  IdentifiedCampaign october = march;
  // Another scale of X, 12 um over the travel, and another squareness.
  const std::size_t x = october.machine.find_axis("X");
  std::vector<double> parameters = october.errors.errors.parameters();
  parameters[first_parameter(october.errors.errors, x, Component::X) + 1] += 6e-3;
  october.errors.errors.set_parameters(parameters);
  ASSERT_EQ(october.errors.errors.locations[0].component, Component::C);
  october.errors.errors.locations[0].value += 15e-6;
  std::size_t found = 0, others = 0, covered = 0;
  for (std::size_t k = 0; k < kDraws; ++k) {
    const ComparedCampaigns result =
        compare_campaigns(request_of({drawn(march, 8, 2 * k), drawn(october, 8, 2 * k + 1)}));
    const ComparedPair& pair = result.pairs.front();
    const std::vector<std::string> names = changed_errors(pair);
    const auto is_found = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
    const bool both = is_found("EXX") && is_found("EC0Y");
    found += both ? 1U : 0U;
    others += names.size() > (both ? 2U : 1U) ? 1U : 0U;
    const ComparedError& scale = *find_error(pair, "EXX");
    // P1 is -1 and 1 at the ends; with noise the change can be largest in between, at a few places.
    EXPECT_GT(std::abs(scale.change), 3e-3);
    EXPECT_EQ(scale.rank, 4U);
    EXPECT_GE(scale.adjusted, scale.probability);
    EXPECT_LT(pair.probability, 0.01);
    EXPECT_GT(scale.at_tool, 1e-3);
    const ComparedError& squareness = *find_error(pair, "EC0Y");
    covered += std::abs(squareness.change - 15e-6) <= *squareness.expanded_uncertainty ? 1U : 0U;
    if (k > 0) continue;
    EXPECT_THAT(evaluation_text(result.report), HasSubstr("2 of 12 errors changed: "));
    EXPECT_EQ(result.report.details["pairs"][0]["errors"][0]["verdict"], "changed");
  }
  // 6 um and 15 urad are five standard uncertainties or more.
  EXPECT_GE(found, 95U);
  EXPECT_LE(others, 12U);   // 5 of 100 at most are expected
  EXPECT_GE(covered, 88U);  // 95.4 of 100 are expected
  EXPECT_LT(covered, 100U);
}

TEST(ComparedCampaigns, TheSameFileTwiceHasNotChangedAtAll) {
  const ComparedCampaigns result = compare_campaigns(request_of({mill_campaign("a"), mill_campaign("b")}));
  const ComparedPair& pair = result.pairs.front();
  EXPECT_TRUE(result.is_judged());
  EXPECT_TRUE(changed_errors(pair).empty());
  ASSERT_FALSE(pair.errors.empty());
  for (const ComparedError& error : pair.errors) {
    EXPECT_EQ(error.change, 0) << error.name;
    EXPECT_EQ(error.probability, 1) << error.name;
    EXPECT_LT(error.at_tool, 1e-12) << error.name;
    ASSERT_TRUE(error.chi_square);
    EXPECT_EQ(*error.chi_square, 0) << error.name;
  }
  EXPECT_TRUE(pair.conventions.empty());
  EXPECT_EQ(*pair.chi_square, 0);
  EXPECT_LT(pair.change.statistics.maximum, 1e-12);
  EXPECT_EQ(*pair.share, 0);
  // Both contribute to the uncertainty of a change.
  const ErrorsFile file = mill_campaign("a").errors;
  const ComparedError& squareness = *find_error(pair, "EC0Y");
  const auto at = static_cast<Eigen::Index>(file.errors.parameter_count() - 3 - file.errors.locations.size());
  double variance = 0;
  for (std::size_t i = 0; i < file.errors.locations.size(); ++i) {
    if (location_error_name(result.machine, file.errors.locations[i].axis, file.errors.locations[i].component) ==
        "EC0Y") {
      const Eigen::Index k = at + static_cast<Eigen::Index>(i);
      variance = file.covariance(k, k);
    }
  }
  EXPECT_NEAR(*squareness.expanded_uncertainty, 2 * std::sqrt(2 * variance), 1e-12);
}

TEST(ComparedCampaigns, AnErrorOfOneCampaignIsNeverComparedWithZero) {
  IdentifiedCampaign without = mill_campaign("b");
  const std::size_t x = without.machine.find_axis("X");
  ErrorSet& errors = without.errors.errors;
  const auto first = static_cast<Eigen::Index>(first_parameter(errors, x, Component::C));
  const auto motion = std::find_if(errors.motions.begin(), errors.motions.end(), [&](const ErrorMotion& one) {
    return one.axis == x && one.component == Component::C;
  });
  const auto size = static_cast<Eigen::Index>(motion->coefficients.size());
  errors.motions.erase(motion);
  const Eigen::MatrixXd whole = without.errors.covariance;
  const Eigen::Index behind = whole.rows() - first - size;
  Eigen::MatrixXd rest(first + behind, first + behind);
  rest << whole.topLeftCorner(first, first), whole.topRightCorner(first, behind), whole.bottomLeftCorner(behind, first),
      whole.bottomRightCorner(behind, behind);
  without.errors.covariance = rest;
  const ComparedCampaigns result = compare_campaigns(request_of({mill_campaign("a"), without}));
  const ComparedPair& pair = result.pairs.front();
  EXPECT_EQ(pair.only_first, std::vector<std::string>{"ECX"});
  EXPECT_TRUE(pair.only_second.empty());
  EXPECT_EQ(find_error(pair, "ECX"), nullptr);
  EXPECT_TRUE(changed_errors(pair).empty());
  EXPECT_TRUE(result.is_judged());
  EXPECT_LT(pair.change.statistics.maximum, 1e-12);
  EXPECT_THAT(evaluation_text(result.report), HasSubstr("identified in A only"));
  const ComparedPair other = compare_campaigns(request_of({without, mill_campaign("a")})).pairs.front();
  EXPECT_EQ(other.only_second, std::vector<std::string>{"ECX"});
}

TEST(ComparedCampaigns, WithoutUncertaintiesTheChangeIsStatedAndItsSignificanceIsNotKnown) {
  IdentifiedCampaign bare = mill_campaign("bare");
  bare.errors.covariance.resize(0, 0);
  for (ErrorMotion& motion : bare.errors.errors.motions) motion.standard_uncertainty.clear();
  for (LocationError& location : bare.errors.errors.locations) location.standard_uncertainty = 0;
  IdentifiedCampaign other = mill_campaign("other");
  other.errors.errors.locations.front().value += 10e-6;
  const ComparedCampaigns result = compare_campaigns(request_of({bare, other}));
  EXPECT_FALSE(result.is_judged());
  const ComparedPair& pair = result.pairs.front();
  const LocationError& location = other.errors.errors.locations.front();
  const ComparedError& changed =
      *find_error(pair, location_error_name(result.machine, location.axis, location.component));
  EXPECT_NEAR(changed.change, 10e-6, 1e-15);
  EXPECT_EQ(changed.verdict, ChangeVerdict::not_known);
  EXPECT_FALSE(changed.expanded_uncertainty || changed.chi_square || pair.chi_square || pair.share);
  EXPECT_GT(pair.change.statistics.maximum, 1e-4);
  EXPECT_THAT(evaluation_text(result.report), HasSubstr("bare.errors.toml states no uncertainties"));
  // Standard uncertainties alone count as independent, and that is said.
  other.errors.covariance.resize(0, 0);
  const ComparedCampaigns stated = compare_campaigns(request_of({other, other}));
  EXPECT_TRUE(stated.is_judged());
  EXPECT_THAT(evaluation_text(stated.report), HasSubstr("without correlations"));
}

TEST(ComparedCampaigns, ACovarianceThatIsSingularHasTheRankOfWhatVaries) {
  IdentifiedCampaign first = mill_campaign("first");
  const std::size_t y = first.machine.find_axis("Y");
  const auto at = static_cast<Eigen::Index>(first_parameter(first.errors.errors, y, Component::Y));
  // The three shapes of EYY are known as one combination only, apart from the other errors.
  Eigen::MatrixXd& covariance = first.errors.covariance;
  const Eigen::Vector3d tied(2e-3, -1e-3, 0.5e-3);
  covariance.middleRows(at + 1, 3).setZero();
  covariance.middleCols(at + 1, 3).setZero();
  covariance.block<3, 3>(at + 1, at + 1) = tied * tied.transpose();
  IdentifiedCampaign second = first;
  std::vector<double> parameters = first.errors.errors.parameters();
  const auto place = static_cast<std::size_t>(at);
  for (std::size_t k = 0; k < 3; ++k) parameters[place + 1 + k] += 1.5 * tied[static_cast<Eigen::Index>(k)];
  second.errors.errors.set_parameters(parameters);
  const auto compared = [&] {
    return *find_error(compare_campaigns(request_of({first, second})).pairs.front(), "EYY");
  };
  const ComparedError along = compared();
  EXPECT_EQ(along.rank, 1U);
  // (1.5 u)^2 over two variances.
  ASSERT_TRUE(along.chi_square);
  EXPECT_NEAR(*along.chi_square, 1.125, 1e-9);
  EXPECT_NEAR(along.probability, chi_square_exceedance(1.125, 1), 1e-9);
  // A change in another direction is explained by no uncertainty.
  parameters[place + 2] += 1e-3;
  second.errors.errors.set_parameters(parameters);
  EXPECT_EQ(compared().verdict, ChangeVerdict::not_known);
}

TEST(ComparedCampaigns, ThreeAreComparedWithTheFirstAndWithTheOneBefore) {
  std::vector<IdentifiedCampaign> campaigns;
  for (std::uint64_t k = 0; k < 3; ++k) {
    campaigns.push_back(drawn(mill_campaign(std::string("at") + std::to_string(k)), 3, k));
  }
  campaigns[2].errors.errors.locations.front().value += 100e-6;
  const ComparedCampaigns result = compare_campaigns(request_of(campaigns));
  ASSERT_EQ(result.pairs.size(), 3U);
  const auto pair_is = [&](std::size_t i, std::size_t first, std::size_t second) {
    return result.pairs[i].first == first && result.pairs[i].second == second;
  };
  EXPECT_TRUE(pair_is(0, 0, 1) && pair_is(1, 0, 2) && pair_is(2, 1, 2));
  const LocationError& location = campaigns[2].errors.errors.locations.front();
  const std::string name = location_error_name(result.machine, location.axis, location.component);
  const auto change = [&](std::size_t i) { return find_error(result.pairs[i], name)->change; };
  EXPECT_NEAR(change(1), change(0) + change(2), 1e-15);
  EXPECT_TRUE(changed_errors(result.pairs[0]).empty());
  EXPECT_EQ(changed_errors(result.pairs[1]), std::vector<std::string>{name});
  EXPECT_EQ(changed_errors(result.pairs[2]), std::vector<std::string>{name});
  const std::string text = evaluation_text(result.report);
  EXPECT_THAT(text, HasSubstr("Changes against at0 (A)"));
  EXPECT_THAT(text, HasSubstr("Changes from each campaign to the next"));
  const nlohmann::ordered_json json = evaluation_json(result.report);
  EXPECT_TRUE(json["figures"].contains("V_max_C_B"));
  EXPECT_EQ(json["pairs"].size(), 3U);
  EXPECT_EQ(comparison_files(result).size(), 6U);
  EXPECT_EQ(comparison_files(result).front().first, "change-B-A.csv");
}

TEST(ComparedCampaigns, ThePageHasTheCurvesOfEveryErrorMotionAndTheMap) {
  CompareRequest request = request_of({mill_campaign("march"), drawn(mill_campaign("october"), 1, 1)});
  EXPECT_TRUE(compare_campaigns(request).report.plots.empty());
  request.page = true;
  const ComparedCampaigns result = compare_campaigns(request);
  std::size_t motions = 0;
  for (const ComparedError& error : result.pairs.front().errors) motions += error.is_motion ? 1 : 0;
  EXPECT_EQ(result.report.plots.size(), 2 * motions);
  EXPECT_EQ(result.report.page["map"]["before_um"]["x"].size(), result.pairs.front().change.count());
  EXPECT_TRUE(result.report.page["map"].contains("expanded_uncertainty_um"));
  EXPECT_LT(evaluation_page(result.report).size(), 3000000U);
  const auto files = comparison_files(result);
  ASSERT_EQ(files.size(), 2U);
  EXPECT_EQ(files[0].first, "change.csv");
  EXPECT_THAT(files[0].second, HasSubstr("change_x_um"));
  EXPECT_EQ(files[1].first, "change.vts");
}

TEST(ComparedCampaigns, AreJudgedByTheTolerancesOfTheRequest) {
  CompareRequest request = request_of({mill_campaign("a"), drawn(mill_campaign("b"), 1, 1)});
  request.tolerances = {"V_max_um=1000"};
  EXPECT_FALSE(compare_campaigns(request).report.exceeds_tolerance());
  request.tolerances = {"V_max_um=0.01"};
  EXPECT_TRUE(compare_campaigns(request).report.exceeds_tolerance());
  request.tolerances = {"V_max_mu=1"};
  EXPECT_THAT(message_of([&] { compare_campaigns(request); }), HasSubstr("--tolerance"));
}

TEST(ComparedCampaigns, StopWhenAsked) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(compare_campaigns(request_of({mill_campaign("a"), mill_campaign("b")}), {.stop = source.get_token()}),
               Stopped);
}

TEST(ComparedCampaigns, MachinesThatAreOthersAreRefused) {
  const auto problem = [](const auto& change) {
    CompareRequest request = request_of({mill_campaign("a"), mill_campaign("b")});
    change(request);
    return message_of([&] { compare_campaigns(request); });
  };
  EXPECT_THAT(problem([](CompareRequest& r) { r.campaigns.pop_back(); }), HasSubstr("campaigns: 1 to compare"));
  EXPECT_THAT(problem([](CompareRequest& r) { r.level = 0; }), HasSubstr("--level-percent"));
  EXPECT_THAT(problem([](CompareRequest& r) { r.campaigns[1].machine.axes[0].name = "U"; }),
              HasSubstr("b.errors.toml: belongs to a machine"));
  EXPECT_THAT(problem([](CompareRequest& r) {
                r.campaigns[1].machine.axes[0].direction = {0, 1, 0};
              }),
              HasSubstr("another direction or point"));
  EXPECT_THAT(problem([](CompareRequest& r) { r.campaigns[1].errors.errors.composition.first_order = true; }),
              HasSubstr("composed in another order"));
  EXPECT_THAT(problem([](CompareRequest& r) {
                r.campaigns[1].machine.axes[0].travel_min = 900;
                r.campaigns[1].machine.axes[0].travel_max = 1000;
              }),
              HasSubstr("travels from 900 to 1000 mm"));
}

TEST(ComparedCampaigns, TravelsMayDifferAndTheCommonRangeCounts) {
  IdentifiedCampaign shorter = mill_campaign("b");
  const std::size_t x = shorter.machine.find_axis("X");
  shorter.machine.axes[x].travel_max = 500;
  const ComparedCampaigns result = compare_campaigns(request_of({mill_campaign("a"), shorter}));
  EXPECT_EQ(result.machine.axes[x].travel_max, 500);
  const ComparedError& error = *find_error(result.pairs.front(), "EXX");
  EXPECT_EQ(error.to, 500);
  EXPECT_NEAR(error.change, 0, 1e-15);
  EXPECT_EQ(error.beyond[0], 0);
  EXPECT_TRUE(changed_errors(result.pairs.front()).empty());
  EXPECT_THAT(evaluation_text(result.report),
              HasSubstr("The travels differ; what they have in common counts: X 0 to 500 mm"));
}

TEST(ReadCampaigns, NamesEachCampaignAndItsMachine) {
  const std::string examples = ABBE_SOURCE_DIR "/examples/";
  const std::string errors = examples + "compensate/mill.errors.toml";
  EXPECT_THAT(message_of([&] { read_campaigns({errors, errors}, ""); }), HasSubstr("--machine: is missing"));
  const CompareRequest request = read_campaigns({errors, errors}, examples + "machines/three-axis-mill.machine.toml");
  ASSERT_EQ(request.campaigns.size(), 2U);
  EXPECT_EQ(request.campaigns[0].name, errors);
  EXPECT_EQ(request.campaigns[1].name, errors + " (2)");
  EXPECT_TRUE(compare_campaigns(request).is_judged());
  EXPECT_THAT(message_of([&] { read_campaigns({examples + "machines"}, ""); }),
              HasSubstr("errors.toml: these results have no such file"));
}

}  // namespace
}  // namespace abbe
