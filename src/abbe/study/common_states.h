#pragma once

// Internal to study: states of machines that are described more than once.
#include <vector>

#include "abbe/study/comparison/compared_campaigns.h"

namespace abbe {

/// Gives the errors of all campaigns the states of one machine: those of the machine, and what others have besides.
/// @throws InputError naming a state on which errors depend and that two machines define in different ways
void bring_to_common_states(Machine& machine, std::vector<IdentifiedCampaign>& campaigns);

}  // namespace abbe
