#pragma once

// Internal to formats: whether the words of a block belong together, before anything of it is carried out.
#include "abbe/compensate/program/plane_kinematics.h"
#include "abbe/formats/nc/nc_codes.h"
#include "abbe/formats/nc/nc_state.h"

namespace abbe {

/// Whether every word belongs to a code, every code has its words, and one code takes the axis words, as LinuxCNC 2.9
/// asks; and whether a block can stand where a plane is tilted.
/// @param planes  null: the machine is not known
/// @returns the code of motion that the block carries out, by its own word or by the one in force; kNoCode: none
/// @throws InputError
NcCode check_nc_words(const NcCodedBlock& block, const NcState& state, const PlaneKinematics* planes);

/// What stands beside M98 or M99.
/// @param word  M98 or M99
/// @throws InputError
void check_subprogram_words(const NcCodedBlock& block, const NcWord& word);

}  // namespace abbe
