#include "abbe/study/identification/place_parts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/trackers/laser_tracker.h"
#include "abbe/study/campaign.h"
#include "abbe/study/example_file_for_test.h"
#include "abbe/study/identification/unexplained_readings.h"

namespace abbe {
namespace {

using testing::IsEmpty;

constexpr const char* kMeasured =
    "verify/second-tracker.study.toml";  // 60 readings with errors of the machine and noise

/// What is known of the reflector's offset.
enum class Offset { exact, slightly_wrong, open, open_and_far };

/// A tracker of an example that tests move.
class MovedTracker {
 public:
  explicit MovedTracker(const std::string& study = kMeasured) : study_(read_study(test::example_file(study))) {
    Campaign campaign = gather_readings(study_);
    tracker_ = std::dynamic_pointer_cast<const LaserTracker>(campaign.setups.front().device);
    readings = std::move(campaign.setups.front().readings);
  }

  void know(Offset offset, RandomStream& random) {
    TrackerSetup setup = tracker_->setup();
    for (Reflector& reflector : setup.reflectors) {
      reflector.estimate_offset = offset == Offset::open || offset == Offset::open_and_far;
      const double off = offset == Offset::exact ? 0 : offset == Offset::open_and_far ? 60 : 1.5;
      reflector.offset += off * direction(random);
    }
    tracker_ = std::make_shared<LaserTracker>(tracker_->name(), setup, tracker_->measure());
  }
  void take_first(std::size_t count) {
    std::vector<std::size_t> kept;
    for (std::size_t k = 0; k < count; ++k) kept.push_back(k);
    readings = readings.subset(kept);
  }
  /// The tracker is moved before it takes reading `from`.
  void move(std::size_t from, const RigidTransform& motion) {
    for (std::size_t k = from; k < readings.count(); ++k) {
      double& range = readings.measured[0][k];
      double& azimuth = readings.measured[1][k];
      double& elevation = readings.measured[2][k];
      const Eigen::Vector3d seen =
          motion * Eigen::Vector3d(range * std::cos(elevation) * std::cos(azimuth),
                                   range * std::cos(elevation) * std::sin(azimuth), range * std::sin(elevation));
      range = seen.norm();
      azimuth = std::atan2(seen.y(), seen.x());
      elevation = std::asin(seen.z() / range);
    }
  }
  JudgedReadings judged() const {
    return judge_readings(study_.machine, *tracker_, readings, tracker_->started(study_.machine, readings));
  }
  std::string words() const {
    const std::vector<UnexplainedReadings> found = judged().unexplained;
    return found.empty() ? "explained" : found.front().words();
  }
  /// The parts of the readings, whether or not they fit as they are; without the first.
  std::vector<std::size_t> parts() const {
    const StartedInstrument started = tracker_->started(study_.machine, readings);
    const std::optional<PlaceParts> found = parts_of_place(study_.machine, *tracker_, readings, started.fits.front());
    return found ? std::vector<std::size_t>(found->begins.begin() + 1, found->begins.end())
                 : std::vector<std::size_t>();
  }
  /// Readings before which it moved, as it is said; empty: something else is said.
  std::vector<std::size_t> moves_found() const {
    const std::vector<UnexplainedReadings> found = judged().unexplained;
    std::vector<std::size_t> moves;
    if (found.size() != 1 || found[0].causes.size() != 1) return moves;
    const std::string words = found[0].causes[0], before = "after reading ";
    if (words.find(" moved ") == std::string::npos) return moves;
    for (std::size_t at = words.find(before); at != std::string::npos; at = words.find(before, at + 1)) {
      moves.push_back(std::stoul(words.substr(at + before.size())) + 1);
    }
    return moves;
  }

  static Eigen::Vector3d direction(RandomStream& random) {
    const Eigen::Vector3d vector(random.normal(), random.normal(), random.normal());
    return vector.normalized();
  }
  /// A turn about the standing axis, or a turn of 0.1 to 2 rad about any axis and a shift of 50 to 300 mm.
  static RigidTransform random_motion(RandomStream& random) {
    if (random.uniform(0, 1) < 0.4) {
      const double angle = (random.uniform(0, 1) < 0.5 ? -1 : 1) * random.uniform(0.25, 3);
      return {rotation_from_vector({0, 0, angle}), {0, 0, 0}};
    }
    return {rotation_from_vector(random.uniform(0.1, 2) * direction(random)),
            random.uniform(50, 300) * direction(random)};
  }

  InstrumentReadings readings;

 private:
  Study study_;
  std::shared_ptr<const LaserTracker> tracker_;
};

constexpr Offset kOffsets[] = {Offset::exact, Offset::slightly_wrong, Offset::open, Offset::open_and_far};

TEST(PlaceParts, ATrackerTurnedHalfWayIsFoundWhateverIsKnownOfTheOffset) {
  RandomStream random(3, 0);
  for (const Offset offset : kOffsets) {
    MovedTracker tracker;
    tracker.know(offset, random);
    for (std::size_t k = 30; k < 60; ++k) tracker.readings.measured[1][k] += 40 * std::numbers::pi / 180;
    EXPECT_THAT(tracker.moves_found(), testing::ElementsAre(30)) << tracker.words();
  }
}

TEST(PlaceParts, RandomMovesAreFoundWhereTheyHappened) {
  std::size_t cases = 0, found = 0, exact = 0;
  std::string missed;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    RandomStream random(17, seed);
    MovedTracker tracker;
    tracker.know(kOffsets[seed % 4], random);
    const auto count = static_cast<std::size_t>(random.uniform(18, 60.99));
    const auto from = static_cast<std::size_t>(random.uniform(9, static_cast<double>(count) - 8.01));
    tracker.take_first(count);
    tracker.move(from, MovedTracker::random_motion(random));
    const std::vector<std::size_t> moves = tracker.parts();
    ++cases;
    if (moves.size() == 1 && moves[0] + 1 >= from && moves[0] <= from + 1) {
      ++found;
      exact += moves[0] == from ? 1U : 0U;
    } else {
      missed +=
          fmt::format("seed {}: {} readings, moved before {}: found {}\n", seed, count, from, fmt::join(moves, ", "));
    }
  }
  RecordProperty("found", static_cast<int>(found));
  EXPECT_GE(static_cast<double>(found), 0.97 * static_cast<double>(cases)) << missed;
  EXPECT_GE(static_cast<double>(exact), 0.9 * static_cast<double>(cases));
}

TEST(PlaceParts, SeveralMovesAreFound) {
  std::size_t found = 0;
  constexpr std::size_t kCases = 12;
  for (std::uint64_t seed = 0; seed < kCases; ++seed) {
    RandomStream random(23, seed);
    MovedTracker tracker;
    tracker.know(kOffsets[seed % 4], random);
    const std::vector<std::size_t> from = {static_cast<std::size_t>(random.uniform(10, 20)),
                                           static_cast<std::size_t>(random.uniform(31, 48))};
    for (const std::size_t k : from) tracker.move(k, MovedTracker::random_motion(random));
    const std::vector<std::size_t> moves = tracker.parts();
    bool same = moves.size() == from.size();
    for (std::size_t i = 0; same && i < from.size(); ++i) same = moves[i] + 1 >= from[i] && moves[i] <= from[i] + 1;
    found += same ? 1U : 0U;
  }
  EXPECT_GE(found, kCases - 1);
}

TEST(PlaceParts, AMoveBeforeTheLastReadingsOfManyIsFound) {
  // Nine tenths fit: the rest stands together.
  MovedTracker tracker;
  tracker.move(52, {rotation_from_vector({0, 0, 0.7}), {0, 0, 0}});
  EXPECT_THAT(tracker.moves_found(), testing::ElementsAre(52)) << tracker.words();
  MovedTracker first;
  first.move(8, {rotation_from_vector({0, 0.4, 0.7}), {100, 0, 0}});
  EXPECT_THAT(first.moves_found(), testing::ElementsAre(8)) << first.words();
}

TEST(PlaceParts, AmongThousandsOfReadingsInBoundedTime) {
  MovedTracker tracker;
  InstrumentReadings many = tracker.readings;
  while (many.count() < 6000) many.append(tracker.readings);
  tracker.readings = many;
  tracker.move(2345, {rotation_from_vector({0.1, 0, 0.7}), {40, 0, 0}});
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THAT(tracker.moves_found(), testing::ElementsAre(2345)) << tracker.words();
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 120);
}

TEST(PlaceParts, GoodReadingsAreNeverSaidToComeFromTwoPlaces) {
  // Subsets of good readings with noise of up to 0.3 mm, some of them with scattered outliers.
  for (std::uint64_t seed = 0; seed < 80; ++seed) {
    RandomStream random(29, seed);
    MovedTracker tracker;
    tracker.know(kOffsets[seed % 4], random);
    tracker.take_first(static_cast<std::size_t>(random.uniform(6, 60.99)));
    const double noise = random.uniform(0, 0.3), outliers = seed % 3 == 0 ? random.uniform(0, 0.15) : 0;
    for (std::size_t k = 0; k < tracker.readings.count(); ++k) {
      tracker.readings.measured[0][k] += noise * random.normal();
      for (const std::size_t c : {1, 2}) tracker.readings.measured[c][k] += noise / 300 * random.normal();
      if (random.uniform(0, 1) < outliers) tracker.readings.measured[1][k] += random.uniform(0.2, 2);
    }
    EXPECT_THAT(tracker.parts(), IsEmpty()) << seed;
  }
}

TEST(PlaceParts, ReadingsThatNothingExplainsAreNotSaidToComeFromSeveralPlaces) {
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    RandomStream random(31, seed);
    MovedTracker tracker;
    tracker.know(kOffsets[seed % 4], random);
    tracker.take_first(static_cast<std::size_t>(random.uniform(12, 60.99)));
    for (std::size_t k = 0; k < tracker.readings.count(); ++k) {
      tracker.readings.measured[1][k] = random.uniform(-3, 3);
      if (seed % 2 == 0) tracker.readings.measured[2][k] = random.uniform(-1.2, 1.2);
    }
    EXPECT_THAT(tracker.parts(), IsEmpty()) << seed;
  }
}

}  // namespace
}  // namespace abbe
