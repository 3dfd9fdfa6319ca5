#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "abbe/identify/problem.h"
#include "abbe/identify/robust_loss.h"
#include "abbe/identify/weighed_observations.h"

namespace abbe {

/// A request or a sum of another process is damaged, or does not fit what it is used for. The message says how.
class SumError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What is summed over the readings of a piece. c: number of columns of its observations, which are the estimated
/// machine parameters and then the estimated unknowns of its set-up.
enum class SumKind : std::uint8_t {
  cost,      ///< [1]: sum of losses
  gradient,  ///< [1 + c]: cost, J'Wr
  normal,    ///< [1 + c + c (c + 1) / 2]: cost, J'Wr, lower triangle of J'WJ by columns
  norms,     ///< [readings]: Mahalanobis norm of every reading, not summed; not used: -1
  factor,    ///< [rows * p]: factor R of W^1/2 J by columns, rows <= p, p the number of all estimates
  poses  ///< [14 + c * c]: sums over poses for variance components; pieces are of poses, see restricted_likelihood.h
};

/// What is estimated of one set-up, from which of its readings, and how these are weighted.
struct SetupSelection {
  std::vector<std::size_t> unknowns;  ///< estimated ones, indices into Observations::unknowns()
  std::vector<std::uint8_t> use;      ///< per reading, as SelectedObservations::use
  bool weighed = false;               ///< with WeighedObservations
  WeighingPoint weights;              ///< of those
};

/// All that a process needs to know, besides machine, errors and readings of the problem, to sum pieces of them.
///
/// It says everything that changes during an identification, so that a process keeps nothing between two requests: the
/// same readings serve all stages of a strategy and all rounds of variance components.
struct SumRequest {
  SumKind kind = SumKind::normal;
  std::size_t pieces = 0;                       ///< number of all pieces, to be shared out
  Loss loss;                                    ///< none for norms and poses
  ReadingPoint point;                           ///< at which the readings are summed
  std::vector<std::size_t> machine_parameters;  ///< estimated ones, indices into ErrorSet::parameters()
  std::vector<SetupSelection> setups;           ///< per observations of the problem
  std::vector<double> covariance;               ///< [p * p] of the estimates, by columns; only for SumKind::poses
  ReadingPoint reference;  ///< at which fingerprints of the readings are taken, see SumOfReadings::readings
};

/// The request as bytes, the same on every machine: name and version of the format, the numbers (little-endian), and a
/// check sum.
std::vector<std::byte> to_bytes(const SumRequest& request);
/// @throws SumError if these are not the bytes of a request, of another version, cut off or changed
SumRequest request_from_bytes(std::span<const std::byte> bytes);

/// Fingerprints of the point, and of everything else that is asked for besides the kind.
std::uint64_t point_fingerprint(const SumRequest& request);
std::uint64_t selection_fingerprint(const SumRequest& request);

/// "cost", "gradient", "normal equations", "norms", "orthogonal factor", "sums over poses".
const char* kind_words(SumKind kind);

}  // namespace abbe
