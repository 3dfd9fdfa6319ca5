#pragma once

#include <cstdint>
#include <vector>

#include "abbe/identify/sums/reading_pieces.h"

namespace abbe {

/// The problem with its observations as stated, without the weights of WeighedObservations.
Problem as_stated(const Problem& problem);

/// A point near that at which the observations stand: there every parameter and unknown changes the readings, so that
/// models which agree at zero errors are told apart.
ReadingPoint reference_point(const Problem& stated);

/// Fingerprint of the readings of a piece: of all residuals at the present point of the observations, which hold
/// readings, uncertainties and model, and of the axis commands.
std::uint64_t fingerprint_of_readings(const Problem& stated, const ReadingPiece& piece);
/// Those of several pieces.
/// @param out  [pieces.size()]; only those of `range` are set
void take_fingerprints(const Problem& stated, const std::vector<ReadingPiece>& pieces, PieceRange range, int threads,
                       std::vector<std::uint64_t>& out);

/// Fingerprints for pieces of poses, whose readings may stand anywhere in their observations: those of all of these.
/// @param pieces, fingerprints  of the readings
std::vector<std::uint64_t> fingerprints_of_poses(const std::vector<ReadingPiece>& poses,
                                                 const std::vector<ReadingPiece>& pieces,
                                                 const std::vector<std::uint64_t>& fingerprints);

}  // namespace abbe
