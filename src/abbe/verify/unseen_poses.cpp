#include "abbe/verify/unseen_poses.h"

#include <stdexcept>

#include "abbe/geometry/parallel_blocks.h"
#include "abbe/verify/parts/deviation_block.h"

namespace abbe {
namespace {

void check(const Machine& machine, const TrackerSetup& a, const TrackerSetup& b, const PoseList& poses,
           const std::vector<Sight>& sights) {
  bool same = a.stations.size() == b.stations.size() && a.reflectors.size() == b.reflectors.size();
  for (std::size_t s = 0; same && s < a.stations.size(); ++s) same = a.stations[s].body == b.stations[s].body;
  for (std::size_t r = 0; same && r < a.reflectors.size(); ++r) same = a.reflectors[r].body == b.reflectors[r].body;
  if (!same) throw std::invalid_argument("comparison of set-ups with different stations or reflectors");
  if (poses.axis.size() != machine.axes.size()) throw std::invalid_argument("poses do not fit the machine's axes");
  for (const Sight& sight : sights) {
    if (sight.station >= a.stations.size() || sight.reflector >= a.reflectors.size() ||
        a.stations[sight.station].body == a.reflectors[sight.reflector].body) {
      throw std::invalid_argument("comparison: a sight needs a station and a reflector on another body");
    }
  }
}

/// Predicted points in tracker coordinates of one sight in one state.
struct Predictor {
  ChainPlan plan;
  RigidTransform tracker_from_body;
  Eigen::Vector3d start;

  Predictor(const Machine& machine, const TrackerState& state, const Sight& sight)
      : plan(machine, *state.errors, state.setup->reflectors[sight.reflector].body,
             state.setup->stations[sight.station].body),
        tracker_from_body(state.setup->stations[sight.station].body_from_tracker.inverse()),
        start(reflector_start(state.setup->reflectors[sight.reflector], *state.errors)) {}

  void predict(const DeviationBlock& block, std::array<std::vector<double>, 3>& p,
               std::vector<std::uint8_t>& covered) const {
    for (std::size_t c = 0; c < 3; ++c) p[c].assign(block.count, start[static_cast<int>(c)]);
    covered.resize(block.count);
    plan.transform(block.position_arrays(), {p[0].data(), p[1].data(), p[2].data()},
                   {p[0].data(), p[1].data(), p[2].data()}, {}, covered.data());
  }
};

}  // namespace

SampleStatistics compare_predictions(const Machine& machine, const TrackerState& truth, const TrackerState& identified,
                                     const PoseList& poses, const std::vector<Sight>& sights, int threads) {
  check(machine, *truth.setup, *identified.setup, poses, sights);
  const PoseSource source = pose_source(poses);
  std::vector<double> distances(poses.count() * sights.size());
  std::vector<std::uint8_t> covered(distances.size());
  for (std::size_t s = 0; s < sights.size(); ++s) {
    const Predictor first(machine, truth, sights[s]), second(machine, identified, sights[s]);
    for_each_block(block_count(source), threads, [&](std::size_t index) {
      DeviationBlock block;
      load_block(source, index, block);
      first.predict(block, block.point, block.covered);
      second.predict(block, block.seen, block.also_covered);
      for (std::size_t k = 0; k < block.count; ++k) {
        const Eigen::Vector3d a(block.point[0][k], block.point[1][k], block.point[2][k]);
        const Eigen::Vector3d b(block.seen[0][k], block.seen[1][k], block.seen[2][k]);
        const std::size_t at = s * poses.count() + block.first + k;
        distances[at] = (first.tracker_from_body * a - second.tracker_from_body * b).norm();
        covered[at] = block.covered[k] && block.also_covered[k] ? 1 : 0;
      }
    });
  }
  return sample_statistics(distances, covered);
}

}  // namespace abbe
