#pragma once

#include "abbe/machine/test_piece.h"

namespace abbe {

/// Test pieces of sizes that a user gave: cone_frustum() and s_shape(), whose refusals become messages.
/// @throws InputError for sizes that make no test piece
TestPiece test_piece_of(const ConeFrustum& frustum);
TestPiece test_piece_of(const SShape& shape);

}  // namespace abbe
