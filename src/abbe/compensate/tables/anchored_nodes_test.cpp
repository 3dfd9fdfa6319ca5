#include "abbe/compensate/tables/anchored_nodes.h"

#include <gmock/gmock.h>

#include <cmath>

#include "abbe/compensate/tables/table_nodes.h"

namespace abbe {
namespace {

using testing::ElementsAre;

TEST(AnchoredNodes, NodesPassThroughTheAnchorAndCoverTheTravel) {
  const AnchoredNodes end = anchored_nodes(0, 100, 0, 30);
  EXPECT_THAT(end.positions, ElementsAre(0, 30, 60, 90, 120));
  EXPECT_THAT(end.inside, ElementsAre(0, 30, 60, 90, 100));
  EXPECT_EQ(end.anchor, 0U);
  const AnchoredNodes within = anchored_nodes(-50, 100, 10, 50);
  EXPECT_THAT(within.positions, ElementsAre(-90, -40, 10, 60, 110));
  EXPECT_THAT(within.inside, ElementsAre(-50, -40, 10, 60, 100));
  EXPECT_EQ(within.anchor, 2U);
  const AnchoredNodes outside = anchored_nodes(-50, 100, 160, 50);
  EXPECT_THAT(outside.positions, ElementsAre(-90, -40, 10, 60, 110, 160));
  EXPECT_EQ(outside.anchor, 5U);
  // Whole intervals, written in decimals, need no node further.
  EXPECT_EQ(anchored_nodes(0, 0.3, 0.3, 0.1).positions.size(), 4U);
}

TEST(AnchoredNodes, NodesOfATableGoThroughTheAnchorAndFollowTheFunctionInsideTheTravelOnly) {
  const auto wave = [](double q) { return 0.02 * std::sin(0.01 * q) + 1e-5 * q; };
  const SampledFunctions function = [&](std::span<const double> positions, std::vector<std::vector<double>>& values) {
    values.assign(1, {});
    for (const double q : positions) {
      EXPECT_GE(q, -213);
      EXPECT_LE(q, 487);
      values[0].push_back(wave(q));
    }
  };
  for (const double anchor : {-213.0, 0.0, 31.7, 487.0}) {
    NodeSpacing spacing;
    spacing.from = -213;
    spacing.to = 487;
    spacing.tolerance = {1e-4};
    spacing.step_multiple = 0.001;
    spacing.anchor = anchor;
    const TableNodes nodes = choose_nodes(function, spacing);
    ASSERT_TRUE(nodes.within) << anchor;
    const double step = nodes.positions[1] - nodes.positions[0];
    EXPECT_NEAR(step, 0.001 * std::round(step / 0.001), 1e-9);
    EXPECT_LE(nodes.positions.front(), -213 + 1e-3);
    EXPECT_GT(nodes.positions.front(), -213 - step);
    EXPECT_GE(nodes.positions.back(), 487 - 1e-3);
    double nearest = 1e9, error = 0;
    for (const double q : nodes.positions) nearest = std::min(nearest, std::abs(q - anchor));
    EXPECT_EQ(nearest, 0) << anchor;
    for (double q = -213; q <= 487; q += 0.37) {
      const auto k = std::min(static_cast<std::size_t>((q - nodes.positions[0]) / step), nodes.positions.size() - 2);
      const double share = (q - nodes.positions[k]) / step;
      const double line = nodes.values[0][k] + share * (nodes.values[0][k + 1] - nodes.values[0][k]);
      error = std::max(error, std::abs(line - wave(q)));
    }
    EXPECT_LE(error, 1e-4) << anchor;
    // The chord of so large a step is not much better than asked for.
    EXPECT_GT(error, 4e-5) << anchor;
  }
}

TEST(AnchoredNodes, OnlySoManyNodesAsThereIsRoomFor) {
  const SampledFunctions function = [](std::span<const double> positions, std::vector<std::vector<double>>& values) {
    values.assign(1, {});
    for (const double q : positions) values[0].push_back(std::sin(q));
  };
  NodeSpacing spacing;
  spacing.from = 0;
  spacing.to = 100;
  spacing.tolerance = {1e-6};
  spacing.most = 20;
  spacing.anchor = 33;
  const TableNodes nodes = choose_nodes(function, spacing);
  EXPECT_LE(nodes.positions.size(), 20U);
  EXPECT_FALSE(nodes.within);
}

}  // namespace
}  // namespace abbe
