// How the processes share sums over readings (docs/scale.md).
#include <utility>

#include "abbe/geometry/digest.h"
#include "messages_of_work.h"
#include "mpi_group.h"

namespace abbe {
namespace {

std::uint64_t key_of(const SumOfReadings& sum) {
  Digest digest;
  digest.add_text("sum of readings");
  digest.add(sum.point);
  digest.add(sum.selection);
  return digest.value();
}

/// Sums stay apart until the first process adds them, so that none is rounded in another order.
void append(std::vector<std::byte>& all, std::span<const std::byte> following) {
  all.insert(all.end(), following.begin(), following.end());
}

}  // namespace

Summation MpiGroup::summation() {
  if (size_ == 1) return {};
  return [this](const SumRequest& request, const Summation::Here& here, const std::stop_token& stop) {
    return sum(request, here, stop);
  };
}

SumOfReadings MpiGroup::sum(const SumRequest& request, const Summation::Here& here, const std::stop_token& stop) {
  const PieceRange range =
      share_of_pieces(request.pieces, static_cast<std::size_t>(rank_), static_cast<std::size_t>(size_));
  SumOfReadings own = here(range);
  if (!is_first()) {
    std::vector<std::byte> bytes;
    if (range.count() > 0) put_bytes(to_bytes(own), bytes);
    return sum_from_bytes(give(key_of(own), std::move(bytes), append, stop));
  }
  const std::vector<std::byte> others = given_by_all(key_of(own), {}, append, stop);
  std::vector<SumOfReadings> parts;
  parts.push_back(std::move(own));
  for (std::span<const std::byte> left = others; !left.empty();) parts.push_back(sum_from_bytes(take_bytes(left)));
  SumOfReadings all = merge_all(std::move(parts));
  send_down(to_bytes(all));
  return all;
}

}  // namespace abbe
