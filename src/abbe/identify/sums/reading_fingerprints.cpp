#include "abbe/identify/sums/reading_fingerprints.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "abbe/geometry/parallel_blocks.h"
#include "abbe/identify/sums/byte_stream.h"
#include "abbe/identify/weighed_observations.h"

namespace abbe {
namespace {

constexpr double kSmallStep = 1e-6;  // mm or rad, or of the typical size of an unknown

/// 1 to 2, another for each parameter.
double step_factor(std::size_t index) { return 1 + std::fmod(0.6180339887498949 * static_cast<double>(index), 1.0); }

}  // namespace

Problem as_stated(const Problem& problem) {
  Problem stated = problem;
  for (SelectedObservations& selected : stated.observations) {
    const auto weighed = std::dynamic_pointer_cast<const WeighedObservations>(selected.observations);
    if (weighed) selected.observations = weighed->stated();
  }
  return stated;
}

ReadingPoint reference_point(const Problem& stated) {
  ReadingPoint point;
  point.machine = stated.errors.parameters();
  for (std::size_t i = 0; i < point.machine.size(); ++i) point.machine[i] += kSmallStep * step_factor(i);
  for (const SelectedObservations& selected : stated.observations) {
    point.setups.push_back(selected.observations->unknown_values());
    const std::vector<SetupUnknown>& unknowns = selected.observations->unknowns();
    for (std::size_t i = 0; i < unknowns.size(); ++i)
      point.setups.back()[i] += kSmallStep * step_factor(i) * unknowns[i].scale;
  }
  return point;
}

std::uint64_t fingerprint_of_readings(const Problem& stated, const ReadingPiece& piece) {
  const Observations& observations = *stated.observations[piece.observations].observations;
  const std::size_t rows = static_cast<std::size_t>(observations.rows());
  Digest digest;
  digest.add(piece.observations);
  digest.add(piece.first);
  digest.add(rows);
  std::vector<double> residuals(rows * Observations::kBlockSize);
  for (std::size_t first = piece.first; first < piece.last; first += Observations::kBlockSize) {
    const std::size_t count = std::min(Observations::kBlockSize, piece.last - first);
    observations.evaluate(first, count, {}, {}, residuals.data(), nullptr, rows * count);
    for (std::size_t k = 0; k < rows * count; ++k) digest.add_number(residuals[k]);
    for (std::size_t k = 0; k < count; ++k)
      for (const double position : observations.positions(first + k)) digest.add_number(position);
  }
  return digest.value();
}

void take_fingerprints(const Problem& stated, const std::vector<ReadingPiece>& pieces, PieceRange range, int threads,
                       std::vector<std::uint64_t>& out) {
  for_each_block(range.count(), threads, [&](std::size_t i) {
    out[range.first + i] = fingerprint_of_readings(stated, pieces[range.first + i]);
  });
}

std::vector<std::uint64_t> fingerprints_of_poses(const std::vector<ReadingPiece>& poses,
                                                 const std::vector<ReadingPiece>& pieces,
                                                 const std::vector<std::uint64_t>& fingerprints) {
  std::vector<std::uint64_t> result;
  for (const ReadingPiece& of_poses : poses) {
    Digest digest;
    digest.add(of_poses.first);
    digest.add(of_poses.last);
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (pieces[i].observations == of_poses.observations) digest.add(fingerprints[i]);
    result.push_back(digest.value());
  }
  return result;
}

}  // namespace abbe
