// How the processes share sums over readings (docs/scale.md).
#include <utility>

#include "abbe/geometry/digest.h"
#include "abbe/study/study_steps.h"
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

Summation MpiGroup::summation(const Study& study) {
  if (size_ == 1) return {};
  // Made when the first sum is asked for, after the study has read the same readings.
  const auto summer = std::make_shared<std::optional<PieceSummer>>();
  return [this, study, summer](const SumRequest& request, const std::stop_token& stop) {
    if (!*summer) summer->emplace(prepared_problem(study));
    return sum(**summer, request, study.threads, stop);
  };
}

SumOfReadings MpiGroup::sum(PieceSummer& summer, const SumRequest& request, int threads, const std::stop_token& stop) {
  const PieceRange range =
      share_of_pieces(request.pieces, static_cast<std::size_t>(rank_), static_cast<std::size_t>(size_));
  SumOfReadings own = summer.sum(request, range, {.threads = threads, .stop = stop});
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
