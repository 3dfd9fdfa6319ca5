#pragma once

// Internal to formats: arcs of an NC program.
#include "abbe/compensate/program/program_move.h"
#include "abbe/formats/nc/nc_codes.h"
#include "abbe/formats/nc/nc_modes.h"
#include "abbe/formats/nc/nc_position.h"

namespace abbe {

/// Fails for a centre or a radius of an arc that does not belong to its plane, or to both, or to none.
/// @throws InputError
void check_arc_words(const NcCodedBlock& block, const NcModes& modes);

/// The arc of a block: its kind, plane, centre and turns; start and end are not filled in.
///
/// @param motion    20 or 30
/// @param position  where it begins
/// @param target    where it ends
/// @throws InputError where no arc goes from there to there
ProgramMove arc_of_block(const NcCodedBlock& block, NcCode motion, const NcModes& modes, const NcPosition& position,
                         const NcPlace& target);

}  // namespace abbe
