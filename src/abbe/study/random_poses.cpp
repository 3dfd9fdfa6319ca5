#include "abbe/study/random_poses.h"

#include "abbe/errors/random_stream.h"
#include "abbe/verify/known_range.h"

namespace abbe {
namespace {

/// Stream of the sides from which axes come, beside the seed of the poses.
constexpr std::uint64_t kApproachStream = 77;

}  // namespace

std::vector<AxisRange> unseen_ranges(const Machine& machine, const std::vector<const ErrorSet*>& errors) {
  return common_known_ranges(machine, errors, 2);
}

PoseList random_unseen_poses(const Machine& machine, const std::vector<AxisRange>& ranges, std::size_t count,
                             std::uint64_t seed, bool both_directions) {
  PoseList poses = random_plan(machine, ranges, count, seed);
  if (!both_directions) return poses;
  poses.approach.resize(machine.axes.size());
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    RandomStream random(seed, kApproachStream + i);
    for (std::size_t k = 0; k < poses.count(); ++k) {
      poses.approach[i].push_back(random.uniform() < 0.5 ? std::int8_t{-1} : std::int8_t{1});
    }
  }
  return poses;
}

std::uint64_t unseen_seed(std::uint64_t study_seed) { return study_seed * 7919; }

}  // namespace abbe
