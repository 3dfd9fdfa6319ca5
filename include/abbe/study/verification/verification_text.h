#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/study/verification/verification.h"

namespace abbe {

/// What was achieved, in one sentence: "True volumetric error at 1000 random poses (seed 1): mean 61 um before, ...".
std::string verification_sentence(const Verification& result);

/// Figures of the unseen poses, with the keys of `held_out` in docs/report-data.md.
nlohmann::ordered_json unseen_poses_json(const CompensatedPoses& poses);

/// For people: all figures, in complete lines.
std::string verification_text(const Verification& result);

/// For programs, "abbe-verify/1"; units in the keys.
nlohmann::ordered_json verification_json(const Verification& result);

}  // namespace abbe
