#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "verify/verify_job.h"

namespace abbe {

/// What was achieved, in one sentence: "True volumetric error at 1000 random poses (seed 1): mean 61 um before, ...".
std::string verify_sentence(const VerifyResult& result);

/// Figures of the unseen poses, with the keys of `held_out` in docs/report-data.md.
nlohmann::ordered_json unseen_poses_json(const CompensatedPoses& poses);

/// For people.
void print_verify(const VerifyResult& result);

/// For programs; units in the keys.
nlohmann::ordered_json verify_json(const VerifyResult& result);

}  // namespace abbe
