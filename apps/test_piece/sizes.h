#pragma once

#include "abbe/study/scans/test_piece_sizes.h"

namespace abbe {

class Subcommand;

// Sizes of a test piece: the same options wherever one is named.
void add_cone_frustum_sizes(Subcommand& piece, TestPieceSizes& sizes);
void add_s_shape_sizes(Subcommand& piece, TestPieceSizes& sizes);

}  // namespace abbe
