#include "abbe/plan/readings/planning_shares.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"
#include "abbe/geometry/numbered_work.h"
#include "abbe/plan/readings/planning.h"
#include "abbe/plan/readings/planning_design.h"
#include "abbe/plan/readings/planning_small.h"

namespace abbe {
namespace {

using planning::factorise;
using planning::log_determinant;
using planning::Small;
using planning::trace_of_quotient;

struct BestOfBlock {
  std::size_t block;
  PlanDesign::Best best;
};

}  // namespace

std::uint64_t fingerprint_of_choosing(const PlanningSpace& space, const PlanningOptions& options) {
  Digest digest;
  const auto add_matrix = [&digest](const Eigen::MatrixXd& matrix) {
    digest.add_numbers({matrix.data(), static_cast<std::size_t>(matrix.size())});
  };
  digest.add_text(vector_instructions());
  digest.add(space.count());
  add_matrix(space.estimates_from_seen());
  add_matrix(space.known_rows());
  for (std::size_t i = 0; space.has_costs() && i < space.count(); ++i) digest.add_number(space.cost(i));
  digest.add(static_cast<std::uint64_t>(options.criterion));
  add_matrix(options.functionals);
  for (const std::size_t number : {options.count, options.repeats}) digest.add(number);
  for (const int number : {options.starts, options.most_passes}) digest.add(static_cast<std::uint64_t>(number));
  for (const double number : {options.time_s, options.smallest_gain, options.pass_gain}) digest.add_number(number);
  digest.add(options.seed);
  digest.add_bytes(std::as_bytes(std::span(options.eligible)));
  digest.add_bytes(std::as_bytes(std::span(options.group)));
  for (const std::vector<std::size_t>* list : {&options.most_of_group, &options.start})
    digest.add_bytes(std::as_bytes(std::span(*list)));
  return digest.value();
}

PlanShares::PlanShares(const WorkInStep& in_step, std::uint64_t fingerprint)
    : in_step_(in_step), fingerprint_(fingerprint) {}

std::vector<std::vector<std::byte>> PlanShares::gather(std::span<const std::byte> bytes) const {
  return in_step_.gather(fingerprint_, bytes);
}

void PlanShares::complete(std::span<const Piece> pieces) const {
  if (!any()) return;
  std::vector<std::byte> own;
  for (const Piece& piece : pieces)
    if (piece.owner == in_step_.rank) pack_numbers(piece.numbers, own);
  const std::vector<std::vector<std::byte>> all = gather(own);
  std::vector<std::span<const std::byte>> left(all.begin(), all.end());
  for (const Piece& piece : pieces)
    if (piece.owner != in_step_.rank) unpack_numbers(left.at(piece.owner), piece.numbers);
}

// A block can only become the best one if it is better than every one before it, ties taken into account: the best one
// of those before is at most as far above each of them. So only these few are given. Half a tie is far above rounding.
PlanDesign::Best PlanDesign::best_of_blocks() const {
  std::vector<BestOfBlock> found;
  double least = kImpossible;
  for (std::size_t k = 0; k < shares_.own_count(block_count()); ++k) {
    const Best& one = best_[shares_.own(k)];
    if (!(one.score + one.tie / 2 < least)) continue;
    least = std::min(least, one.score + one.tie);
    found.push_back({shares_.own(k), one});
  }
  if (shares_.any()) {
    const std::vector<std::vector<std::byte>> all = shares_.gather(std::as_bytes(std::span(found)));
    found.clear();
    for (const std::vector<std::byte>& bytes : all) {
      const std::size_t before = found.size();
      found.resize(before + bytes.size() / sizeof(BestOfBlock));
      if (!bytes.empty()) std::memcpy(&found[before], bytes.data(), (found.size() - before) * sizeof(BestOfBlock));
    }
    std::sort(found.begin(), found.end(), [](const BestOfBlock& a, const BestOfBlock& b) { return a.block < b.block; });
  }
  Best best;
  for (const BestOfBlock& one : found)
    if (one.best.score < best.score - one.best.tie) best = one.best;
  return best;
}

std::size_t PlanDesign::owner_of(std::size_t candidate) const {
  const auto after = std::upper_bound(blocks_.begin(), blocks_.end(), candidate);
  return shares_.owner(static_cast<std::size_t>(after - blocks_.begin()) - 1);
}

void PlanDesign::bring_squares(std::span<const std::size_t> places, std::span<Squares> squares) const {
  std::vector<PlanShares::Piece> pieces;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const std::size_t candidate = chosen_[places[k]], owner = owner_of(candidate);
    const std::size_t first = square_[candidate], size = square_[candidate + 1] - first;
    const auto bring = [&](const std::vector<double>& from, Small& to) {
      if (owner == shares_.rank()) std::copy_n(&from[first], size, to.begin());
      pieces.push_back({owner, {to.data(), size}});
    };
    bring(w_, squares[k].w);
    if (by_variance_) bring(g_, squares[k].g);
  }
  shares_.complete(pieces);
}

double PlanDesign::loss_of(const double* w, const double* g, std::size_t n) const {
  Small lower;
  if (!factorise(w, n, -1, lower)) return kImpossible;
  return by_variance_ ? trace_of_quotient(lower, g, n) : -log_determinant(lower, n);
}

std::vector<double> PlanDesign::losses() const {
  std::vector<double> result(chosen_.size(), 0.0);
  std::vector<PlanShares::Piece> pieces;
  for (std::size_t place = 0; place < chosen_.size(); ++place) {
    const std::size_t candidate = chosen_[place], owner = owner_of(candidate), first = square_[candidate];
    pieces.push_back({owner, {&result[place], 1}});
    if (owner != shares_.rank()) continue;
    result[place] = loss_of(&w_[first], by_variance_ ? &g_[first] : nullptr, space_.row_count(candidate));
  }
  shares_.complete(pieces);
  return result;
}

}  // namespace abbe
