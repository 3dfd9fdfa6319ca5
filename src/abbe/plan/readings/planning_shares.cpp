#include "abbe/plan/readings/planning_shares.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"
#include "abbe/geometry/numbered_work.h"
#include "abbe/plan/readings/planning.h"
#include "abbe/plan/readings/planning_space.h"

namespace abbe {
namespace {

/// In front of the bytes of a process.
struct GivenBy {
  std::uint64_t rank, size;
};

void append(std::span<const std::byte> added, std::vector<std::byte>& all) {
  all.insert(all.end(), added.begin(), added.end());
}

}  // namespace

GatheredBytes gather(const WorkInStep& in_step, std::uint64_t fingerprint, std::span<const std::byte> own) {
  std::vector<std::byte> given;
  const GivenBy here{in_step.rank, own.size()};
  if (!own.empty()) append(std::as_bytes(std::span(&here, 1)), given);
  append(own, given);
  GatheredBytes all;
  all.bytes = in_step.merged(
      fingerprint, std::move(given),
      [](std::vector<std::byte>& bytes, std::span<const std::byte> following) { append(following, bytes); });
  all.parts.resize(in_step.processes);
  for (std::span<const std::byte> left = all.bytes; !left.empty();) {
    GivenBy by{};
    if (left.size() < sizeof(by)) throw WorkError("what a process has given is cut off");
    std::memcpy(&by, left.data(), sizeof(by));
    left = left.subspan(sizeof(by));
    if (left.size() < by.size) throw WorkError("what a process has given is cut off");
    all.parts.at(by.rank) = left.first(by.size);
    left = left.subspan(by.size);
  }
  return all;
}

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

PlanShares::PlanShares(const WorkInStep& in_step, std::uint64_t fingerprint, std::size_t blocks)
    : in_step_(in_step), fingerprint_(fingerprint) {
  constexpr std::size_t kMostTogether = 32, kTurns = 128;
  together_ = std::clamp<std::size_t>(blocks / (in_step.processes * kTurns), 1, kMostTogether);
  const std::size_t turn = in_step.processes * together_, before = in_step.rank * together_, last = blocks % turn;
  own_count_ = blocks / turn * together_ + std::min(together_, last - std::min(last, before));
}

std::vector<std::byte> PlanShares::merged(std::vector<std::byte> own, const WorkInStep::Merge& merge) const {
  return any() ? in_step_.merged(fingerprint_, std::move(own), merge) : own;
}

void PlanShares::complete(std::span<const Piece> pieces) const {
  if (!any()) return;
  std::vector<std::byte> own;
  for (const Piece& piece : pieces)
    if (piece.owner == in_step_.rank) pack_numbers(piece.numbers, own);
  GatheredBytes all = gather(in_step_, fingerprint_, own);
  for (const Piece& piece : pieces)
    if (piece.owner != in_step_.rank) unpack_numbers(all.parts.at(piece.owner), piece.numbers);
}

}  // namespace abbe
