#include "abbe/compensate/tables/anchored_lattice.h"

#include <algorithm>

#include "abbe/compensate/point_correction.h"

namespace abbe {
namespace {

constexpr int kTries = 6;
constexpr double kCloser = 0.75;  // the tolerance of the next try

}  // namespace

CorrectionLattice continued_lattice(const CorrectionLattice& lattice,
                                    const std::vector<std::vector<double>>& positions) {
  CorrectionLattice further = lattice;
  std::size_t stride = 1;  // of the input that is continued, in both lattices
  for (std::size_t a = 0; a < positions.size(); ++a) {
    const std::vector<Continuation> places = continuations(lattice.positions[a], positions[a]);
    const std::size_t old_count = lattice.positions[a].size(), new_count = positions[a].size();
    for (std::vector<double>& values : further.corrections) {
      std::vector<double> wider(values.size() / old_count * new_count);
      for (std::size_t k = 0; k < wider.size(); ++k) {
        const Continuation& place = places[k / stride % new_count];
        const std::size_t at = (k / (stride * new_count) * old_count + place.index) * stride + k % stride;
        wider[k] = values[at] + place.share * (values[at + stride] - values[at]);
      }
      values = std::move(wider);
    }
    stride *= new_count;
  }
  further.positions = positions;
  return further;
}

AnchoredLattice build_anchored_lattice(const Machine& machine, const ErrorSet& errors,
                                       const AnchoredLatticeOptions& options) {
  AnchoredLattice best;
  LatticeOptions closer = options.lattice;
  for (int tried = 0; tried < kTries; ++tried) {
    std::vector<AnchoredNodes> nodes;
    std::vector<std::vector<double>> inside;
    const std::vector<std::vector<double>> even = lattice_nodes(machine, errors, closer);
    for (std::size_t a = 0; a < even.size(); ++a) {
      const KnownTravel travel = known_travel(machine, errors, options.lattice.inputs[a]);
      const double interval = (travel.to - travel.from) / static_cast<double>(even[a].size() - 1);
      nodes.push_back(anchored_nodes_within(travel.from, travel.to, options.anchor[a], interval, options.step_multiple,
                                            std::min(options.lattice.most_per_axis, options.lattice.most_nodes)));
    }
    const auto count = [&] {
      double product = 1;
      for (const AnchoredNodes& one : nodes) product *= static_cast<double>(one.positions.size());
      return product;
    };
    while (count() > static_cast<double>(options.lattice.most_nodes)) {
      const auto longest = std::max_element(nodes.begin(), nodes.end(), [](const auto& a, const auto& b) {
        return a.positions.size() < b.positions.size();
      });
      const std::size_t had = longest->positions.size();
      const auto a = static_cast<std::size_t>(longest - nodes.begin());
      const KnownTravel travel = known_travel(machine, errors, options.lattice.inputs[a]);
      *longest = anchored_nodes_within(travel.from, travel.to, options.anchor[a], longest->interval,
                                       options.step_multiple, had - 1);
      if (longest->positions.size() == had) break;
    }
    for (const AnchoredNodes& one : nodes) inside.push_back(one.inside);
    const bool no_news = tried > 0 && std::equal(nodes.begin(), nodes.end(), best.nodes.begin(),
                                                 [](const auto& a, const auto& b) { return a.interval == b.interval; });
    if (!no_news) {
      best.built = lattice_over(machine, errors, options.lattice, std::move(inside));
      best.nodes = std::move(nodes);
      if (best.built.within) break;
    }
    closer.tolerance_mm *= kCloser;
    closer.tolerance_rad *= kCloser;
  }
  std::vector<std::vector<double>> positions;
  for (const AnchoredNodes& one : best.nodes) positions.push_back(one.positions);
  best.lattice = continued_lattice(best.built.lattice, positions);
  return best;
}

}  // namespace abbe
