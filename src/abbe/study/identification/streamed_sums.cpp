#include "abbe/study/identification/streamed_sums.h"

#include <algorithm>
#include <span>
#include <utility>

#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"
#include "abbe/geometry/stopped.h"

namespace abbe {

StreamedSums::StreamedSums(Problem problem, std::uint64_t readings, int threads, const IdentificationJob& job)
    : summer_(std::move(problem)), readings_(readings), threads_(threads), driver_(job.work), progress_(job.progress) {}

SumOfReadings StreamedSums::sum(const SumRequest& request, const std::stop_token& stop) {
  summer_.prepare(request, {0, summer_.piece_count()}, threads_);
  std::vector<SumOfReadings> parts(request.pieces);
  std::size_t done = 0;
  NumberedWork work{.name = "sums over the readings", .blocks = parts.size(), .threads = threads_};
  work.is_followed = true;
  work.for_all = true;
  work.fingerprint = [&] { return work_fingerprint(request); };
  work.compute = [&](std::size_t piece) {
    stop_if_asked(stop);
    parts[piece] = summer_.sum_prepared({piece, piece + 1}, {1, stop, {}});
  };
  work.pack = [&](std::size_t piece, std::vector<std::byte>& bytes) {
    const std::vector<std::byte> sum = to_bytes(parts[piece]);
    bytes.insert(bytes.end(), sum.begin(), sum.end());
  };
  work.unpack = [&](std::size_t piece, std::span<const std::byte> bytes) {
    try {
      parts[piece] = sum_from_bytes(bytes);
    } catch (const SumError& error) {
      throw WorkError(error.what());
    }
    if (!(parts[piece].range == PieceRange{piece, piece + 1})) throw WorkError("a sum is of another piece");
  };
  // Nobody knows how many sums the solver will ask for; this is how far the present one has come.
  work.finished = [&](std::size_t) {
    if (progress_) progress_(++done, parts.size());
  };
  do_work(driver_, work);
  return merge_all(std::move(parts));
}

std::vector<std::uint64_t> StreamedSums::fingerprints(const ReadingPoint& reference, const std::stop_token& stop) {
  if (const std::vector<std::uint64_t>* known = summer_.known_fingerprints(reference)) return *known;
  summer_.prepare_fingerprints(reference);
  std::vector<std::uint64_t> all(summer_.piece_count());
  NumberedWork work{.name = "fingerprints of the readings", .blocks = all.size(), .threads = threads_};
  work.is_followed = true;
  work.for_all = true;
  work.is_kept = false;
  work.fingerprint = [&] {
    Digest digest;
    digest.add_text("fingerprints of the readings");
    digest.add_text(vector_instructions());
    digest.add(readings_);
    digest.add_numbers(reference.machine);
    for (const std::vector<double>& setup : reference.setups) digest.add_numbers(setup);
    return digest.value();
  };
  work.compute = [&](std::size_t piece) {
    stop_if_asked(stop);
    all[piece] = summer_.fingerprint(piece);
  };
  work.pack = [&](std::size_t piece, std::vector<std::byte>& bytes) {
    const auto own = std::as_bytes(std::span(&all[piece], 1));
    bytes.insert(bytes.end(), own.begin(), own.end());
  };
  work.unpack = [&](std::size_t piece, std::span<const std::byte> bytes) {
    const auto own = std::as_writable_bytes(std::span(&all[piece], 1));
    if (bytes.size() != own.size()) throw WorkError("a fingerprint is cut off");
    std::copy(bytes.begin(), bytes.end(), own.begin());
  };
  do_work(driver_, work);
  summer_.set_fingerprints(reference, all);
  return all;
}

/// Of the request, and of all readings and the model: residuals at a point near that of the start.
std::uint64_t StreamedSums::work_fingerprint(const SumRequest& request) const {
  Digest digest;
  digest.add_text("sums of single pieces");
  digest.add_text(vector_instructions());
  digest.add_bytes(to_bytes(request));
  digest.add(readings_);
  if (const std::vector<std::uint64_t>* known = summer_.known_fingerprints(request.reference)) {
    for (const std::uint64_t of_piece : *known) digest.add(of_piece);
  }
  return digest.value();
}

}  // namespace abbe
