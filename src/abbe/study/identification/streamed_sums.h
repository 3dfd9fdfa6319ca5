#pragma once

// Internal to study: sums over readings that stay in their files.
#include <cstdint>
#include <stop_token>
#include <vector>

#include "abbe/geometry/numbered_work.h"
#include "abbe/identify/sums/sum_of_readings.h"
#include "abbe/study/study_steps.h"

namespace abbe {

/// Sums of the readings on disk as numbered work, a block for each piece, so that finished ones can be kept in a file
/// and shared by processes.
class StreamedSums {
 public:
  /// @param problem   with observations that nobody else moves
  /// @param readings  fingerprint of the files
  StreamedSums(Problem problem, std::uint64_t readings, int threads, const IdentificationJob& job);

  /// As Summation. @throws Stopped
  SumOfReadings sum(const SumRequest& request, const std::stop_token& stop);
  /// Of all pieces, as Summation::Fingerprints. @throws Stopped
  std::vector<std::uint64_t> fingerprints(const ReadingPoint& reference, const std::stop_token& stop);

 private:
  std::uint64_t work_fingerprint(const SumRequest& request) const;

  PieceSummer summer_;
  std::uint64_t readings_;
  int threads_;
  WorkDriver driver_;
  ProgressCallback progress_;
};

}  // namespace abbe
