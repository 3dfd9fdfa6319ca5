#include "abbe/identify/trust/outlier_clusters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "abbe/geometry/angle_units.h"
#include "abbe/identify/function_observations_test.h"
#include "abbe/identify/trust/repeated_readings.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// Readings of three reflectors at random poses of an axis C and an axis X; what is measured does not matter.
class PlacedObservations : public FunctionObservations {
 public:
  PlacedObservations(std::vector<std::vector<double>> positions, std::vector<double> data)
      : FunctionObservations(1, 1, std::move(data), 1e-3,
                             [](std::size_t, std::size_t, const std::vector<Complex>& b) { return b[0]; }),
        positions_(std::move(positions)) {}
  std::vector<double> positions(std::size_t reading) const override { return positions_[reading]; }

 private:
  std::vector<std::vector<double>> positions_;
};

struct PlacedReadings {
  std::unique_ptr<PlacedObservations> observations;
  Problem problem;
  std::vector<ReadingFacts> facts;
};

PlacedReadings placed_readings(std::size_t poses, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> turn(-kTurn / 2, kTurn / 2), travel(0, 1400);
  std::vector<std::vector<double>> positions;
  ReadingFacts facts;
  facts.setup = "tracker";
  facts.labels = {{"reflector", {"R1", "R2", "R3"}, {}}};
  for (std::size_t k = 0; k < poses; ++k) {
    const std::vector<double> at = {turn(generator), travel(generator), 0};
    for (std::uint16_t r = 0; r < 3; ++r) {
      positions.push_back(at);
      facts.labels[0].of_reading.push_back(r);
      facts.time_s.push_back(static_cast<double>(5 * k + r));
    }
  }
  PlacedReadings placed;
  placed.observations = std::make_unique<PlacedObservations>(positions, std::vector<double>(positions.size(), 0.0));
  placed.problem = function_problem({placed.observations.get()});
  placed.problem.machine = test::aguado_table();
  placed.facts = {facts};
  return placed;
}

TEST(OutlierClusters, OutliersAnywhereAreNone) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const PlacedReadings placed = placed_readings(150, seed);
    std::mt19937_64 generator(seed);
    std::vector<Outlier> outliers;
    for (std::size_t k = 0; k < 450; ++k) {
      // A third of the poses as a whole, and single readings.
      const bool whole_pose = (k / 3 * 2654435761U + seed * 97) % 7 < 2;
      if (whole_pose || generator() % 20 == 0) outliers.push_back({0, k, 10, 0});
    }
    EXPECT_THAT(outlier_clusters(placed.problem, outliers, placed.facts), IsEmpty()) << seed;
  }
}

TEST(OutlierClusters, ARegionThatIsThrownOutIsFound) {
  const PlacedReadings placed = placed_readings(200, 3);
  std::vector<Outlier> outliers;
  for (std::size_t k = 0; k < 600; ++k)
    if (placed.observations->positions(k)[0] < -100 * kDegree || k % 97 == 0) outliers.push_back({0, k, 10, 0});
  const std::vector<OutlierCluster> clusters = outlier_clusters(placed.problem, outliers, placed.facts);
  ASSERT_FALSE(clusters.empty());
  EXPECT_THAT(clusters[0].where, HasSubstr("with C from -17"));
  EXPECT_TRUE(clusters[0].is_region_left_out());
  EXPECT_LT(clusters[0].outliers_elsewhere, 20U);
  EXPECT_THAT(cluster_text(clusters[0]), HasSubstr(" readings with C from -17"));
}

TEST(OutlierClusters, AReflectorAndAnHourAreFound) {
  const PlacedReadings placed = placed_readings(200, 4);
  std::vector<Outlier> outliers;
  for (std::size_t k = 1; k < 600; k += 3) outliers.push_back({0, k, 10, 0});
  std::vector<OutlierCluster> clusters = outlier_clusters(placed.problem, outliers, placed.facts);
  ASSERT_EQ(clusters.size(), 1U);
  EXPECT_EQ(clusters[0].where, "of reflector R2 of set-up tracker");
  EXPECT_TRUE(clusters[0].is_region_left_out());

  outliers.clear();
  for (std::size_t k = 540; k < 600; ++k) outliers.push_back({0, k, 10, 0});
  clusters = outlier_clusters(placed.problem, outliers, placed.facts);
  ASSERT_FALSE(clusters.empty());
  EXPECT_EQ(clusters[0].where, "of set-up tracker from 875 to 995 s") << "in whole classes: the outliers begin at 900";
}

TEST(OutlierClusters, OfVeryManyPosesEveryOneIsCounted) {
  // Turns of 360 equal steps while X moves on: poses chosen at equal steps would all stand at the same few angles.
  constexpr std::size_t kPoses = 180000;
  std::vector<std::vector<double>> positions;
  std::vector<Outlier> outliers;
  for (std::size_t k = 0; k < kPoses; ++k) {
    const double step = static_cast<double>(k % 360);
    positions.push_back({(step - 180) * kDegree, 1e-3 * static_cast<double>(k), 0});
    if (k % 360 < 90 || k == kPoses - 1) outliers.push_back({0, k, 10, 0});
  }
  PlacedObservations observations(positions, std::vector<double>(kPoses, 0.0));
  Problem problem = function_problem({&observations});
  problem.machine = test::aguado_table();
  ReadingFacts facts;
  facts.setup = "tracker";
  const std::vector<OutlierCluster> clusters = outlier_clusters(problem, outliers, {facts});
  ASSERT_EQ(clusters.size(), 1U) << "X and the rows say nothing";
  // Of its classes alone, each would be too improbable for a double.
  EXPECT_THAT(clusters[0].where, HasSubstr("with C from -180 to -9"));
  EXPECT_TRUE(clusters[0].is_region_left_out());
  EXPECT_EQ(clusters[0].probability(), 0);
  EXPECT_LT(clusters[0].log_probability, -90000);
  EXPECT_NEAR(static_cast<double>(clusters[0].readings), kPoses / 4.0, kPoses / 360.0);
  EXPECT_GT(clusters[0].outliers, kPoses / 4 - kPoses / 360 - 1);
  EXPECT_EQ(clusters[0].readings + clusters[0].readings_elsewhere, kPoses);
  EXPECT_EQ(clusters[0].outliers + clusters[0].outliers_elsewhere, outliers.size());
}

TEST(OutlierClusters, AFewInARowAreTooSmallARegion) {
  // A beam that was broken for 100 s of 4000: told, but the rest stands.
  const PlacedReadings placed = placed_readings(800, 5);
  std::vector<Outlier> outliers;
  for (std::size_t k = 900; k < 960; ++k) outliers.push_back({0, k, 10, 0});
  const std::vector<OutlierCluster> clusters = outlier_clusters(placed.problem, outliers, placed.facts);
  ASSERT_FALSE(clusters.empty());
  for (const OutlierCluster& cluster : clusters) EXPECT_FALSE(cluster.is_region_left_out()) << cluster.where;
}

/// Readings of one number at poses visited twice.
RepeatedReadings repeats_of(const std::vector<double>& data, std::size_t poses) {
  std::vector<std::vector<double>> positions;
  for (std::size_t k = 0; k < data.size(); ++k) positions.push_back({static_cast<double>(k % poses)});
  const PlacedObservations observations(positions, data);
  ReadingFacts facts;
  facts.measured = {data};
  facts.arm = {1};
  return repeated_readings(observations, facts);
}

std::vector<double> noisy(std::size_t count, double step, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> noise(0, 1e-3);
  std::vector<double> data;
  for (std::size_t k = 0; k < count; ++k) data.push_back(step * std::round(noise(generator) / step));
  return data;
}

TEST(RepeatedReadings, IndependentRepeatsAreNoCopies) {
  // Steps of a hundredth to three of the standard uncertainty: some agree by chance.
  for (const double step : {1e-5, 1e-4, 1e-3, 2e-3, 3e-3}) {
    const RepeatedReadings repeated = repeats_of(noisy(400, step, 6), 200);
    EXPECT_EQ(repeated.pairs, 200U);
    EXPECT_FALSE(repeated.are_copies()) << step << ": " << repeated.identical << " " << repeated.expected;
  }
}

TEST(RepeatedReadings, RowsThatStandTwiceAreCopies) {
  std::vector<double> data = noisy(200, 1e-4, 7);
  data.insert(data.end(), data.begin(), data.end());
  const RepeatedReadings doubled = repeats_of(data, 200);
  EXPECT_EQ(doubled.identical, 200U);
  EXPECT_TRUE(doubled.are_copies());
  EXPECT_EQ(doubled.first, 0U);
  EXPECT_EQ(doubled.second, 200U);
  EXPECT_THAT(copies_text(doubled, ReadingFacts{}), HasSubstr("200 of 200 pairs"));
  // One reading used twice, its digits fine enough to be sure.
  data = noisy(400, 1e-10, 8);
  data[205] = data[5];
  const RepeatedReadings one = repeats_of(data, 200);
  EXPECT_EQ(one.identical, 1U);
  EXPECT_TRUE(one.are_copies());
}

}  // namespace
}  // namespace abbe
