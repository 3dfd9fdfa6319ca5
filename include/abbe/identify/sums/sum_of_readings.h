#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "abbe/identify/sums/reading_pieces.h"
#include "abbe/identify/sums/sum_request.h"

namespace abbe {

class ReadingStream;

/// Sums over a range of pieces of the readings of a problem: a value that can be written, read and merged.
///
/// The sums of the pieces stay apart, because the order in which rounded numbers are added changes the last bits: the
/// identification adds all pieces in their order, whoever has summed them, and so gets the bytes of one process.
struct SumOfReadings {
  SumKind kind = SumKind::normal;
  std::uint64_t point = 0;      ///< point_fingerprint() of the request
  std::uint64_t selection = 0;  ///< selection_fingerprint() of the request
  std::string processor;        ///< vector instructions that were used: sums of others differ in the last bits
  std::size_t pieces = 0;       ///< of the whole problem
  PieceRange range;
  std::vector<std::uint64_t> readings;      ///< [range.count()]: of all readings of a piece, used or not
  std::vector<std::vector<double>> values;  ///< [range.count()]: see SumKind; {0} or nothing: no reading is used
};

/// The sum that answers a request, still of no piece: range, readings and values are empty.
SumOfReadings begin_sum(const SumRequest& request);

/// Both ranges as one; one of them may be empty.
/// @param second  begins where the first ends
/// @throws SumError if it does not, or if the sums are of different requests or processors
SumOfReadings merge(SumOfReadings first, SumOfReadings second);

/// The sum of all pieces from parts that have come in any order.
/// @throws SumError if pieces are missing or there twice, or as merge()
SumOfReadings merge_all(std::vector<SumOfReadings> parts);

/// The sum as bytes, as to_bytes() of a request.
std::vector<std::byte> to_bytes(const SumOfReadings& sum);
/// @throws SumError if these are not the bytes of a sum, of another version, cut off or changed
SumOfReadings sum_from_bytes(std::span<const std::byte> bytes);

/// How pieces are summed in this process.
struct SumOptions {
  int threads = 0;         ///< 0: all; the result does not depend on it
  std::stop_token stop{};  ///< looked at before every piece
  /// Called after every piece, one call at a time but from any thread: done of total.
  std::function<void(std::size_t done, std::size_t total)> progress{};
};

/// Sums pieces of the readings of a problem on request: what a process does that works for an identification in
/// another.
///
///     PieceSummer summer(problem);                       // the same study as that of the identification
///     while (receive(request_bytes, range)) send(to_bytes(summer.sum(request_from_bytes(request_bytes), range)));
///
/// Sums are the same for every number of threads and processes, on processors with the same vector instructions.
class PieceSummer {
 public:
  /// @param problem  its machine, structure of errors, and readings; the selection in it counts for nothing
  explicit PieceSummer(const Problem& problem);
  ~PieceSummer();
  PieceSummer(const PieceSummer&) = delete;
  PieceSummer& operator=(const PieceSummer&) = delete;

  std::size_t piece_count() const { return pieces_.size(); }  ///< of the readings

  /// Moves the observations to the request's point.
  /// @param range  of SumRequest::pieces
  /// @throws SumError if the request does not fit the problem; Stopped if that was asked for
  SumOfReadings sum(const SumRequest& request, PieceRange range, const SumOptions& options = {});

  /// The first half of sum(), once for many ranges: the observations move to the request's point.
  /// @param range  of pieces whose fingerprints are needed
  void prepare(const SumRequest& request, PieceRange range, int threads);
  /// The second half, of the last request that was prepared; from several threads at a time.
  /// @throws SumError if none was prepared or there is no such range; Stopped
  SumOfReadings sum_prepared(PieceRange range, const SumOptions& options = {}) const;

  /// Moves the observations to the point at which fingerprints are wanted. @throws SumError if it does not fit
  void prepare_fingerprints(const ReadingPoint& reference);
  /// Fingerprint of the readings of a piece at that point; from several threads at a time.
  std::uint64_t fingerprint(std::size_t piece) const;
  /// Takes over the fingerprints of all pieces at a point, so that they are not computed again.
  /// @throws SumError if there are more or fewer than pieces
  void set_fingerprints(const ReadingPoint& reference, std::vector<std::uint64_t> fingerprints);
  /// Fingerprints of all pieces at a point; null if they are not known.
  const std::vector<std::uint64_t>* known_fingerprints(const ReadingPoint& reference) const;

 private:
  void check(const SumRequest& request) const;
  void check(const ReadingPoint& point) const;
  void select(const SumRequest& request);
  const std::vector<std::uint64_t>& fingerprints(const ReadingPoint& reference, PieceRange range, int threads);

  Problem stated_;                                             // observations as given
  Problem selected_;                                           // as the last request has it
  std::vector<std::shared_ptr<WeighedObservations>> weighed_;  // per observations, null as long as none was asked for
  std::vector<ReadingPiece> pieces_;
  std::uint64_t reference_ = 0;              // of the fingerprints that are known
  std::vector<std::uint64_t> fingerprints_;  // [pieces]
  std::vector<std::uint8_t> is_known_;       // [pieces]
  // Of the request that was prepared last: a sum without values, with the fingerprints of all its pieces.
  SumRequest request_;
  SumOfReadings head_;
  std::unique_ptr<ReadingStream> stream_;
};

/// Gives the sum of all pieces for a request. Whoever writes one decides which process sums which pieces.
///
/// It may throw, for instance SumError where a process has ended, or Stopped; the identification ends with that. The
/// sum is checked before it is used: kind, point, selection, all pieces once, their readings, their sizes.
class Summation {
 public:
  using Sum = std::function<SumOfReadings(const SumRequest& request, const std::stop_token& stop)>;
  /// The sum of a range of pieces, computed by the identification itself, in this process.
  using Here = std::function<SumOfReadings(PieceRange range)>;
  /// For processes that all run the same identification: each computes a share here and gives it to the others.
  using SharedSum =
      std::function<SumOfReadings(const SumRequest& request, const Here& here, const std::stop_token& stop)>;
  /// [pieces] of the readings at a point: what the sums are checked with.
  using Fingerprints =
      std::function<std::vector<std::uint64_t>(const ReadingPoint& reference, const std::stop_token& stop)>;

  Summation() = default;
  // NOLINTBEGIN(google-explicit-constructor): callers pass a function as a summation
  /// @param fingerprints  empty: the sums are checked with fingerprints that take a pass over all readings
  template <class Callable>
  requires std::is_constructible_v<Sum, Callable> Summation(Callable sum, Fingerprints fingerprints = {})
      : sum_([own = Sum(std::move(sum))](const SumRequest& request, const Here&, const std::stop_token& stop) {
          return own(request, stop);
        }),
        fingerprints_(std::move(fingerprints)) {}
  template <class Callable>
  requires std::is_constructible_v<SharedSum, Callable> Summation(Callable sum) : sum_(std::move(sum)) {}
  // NOLINTEND(google-explicit-constructor)

  explicit operator bool() const { return static_cast<bool>(sum_); }
  SumOfReadings operator()(const SumRequest& request, const Here& here, const std::stop_token& stop) const {
    return sum_(request, here, stop);
  }
  const Fingerprints& fingerprints() const { return fingerprints_; }

 private:
  SharedSum sum_;
  Fingerprints fingerprints_;
};

}  // namespace abbe
