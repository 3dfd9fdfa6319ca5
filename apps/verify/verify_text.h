#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "verify/verify_job.h"

namespace abbe {

/// What was achieved, in one sentence: "Volumetric error at 1000 unseen poses: 61 um before, 2.4 um after, ...".
std::string verify_sentence(const VerifyResult& result);

/// "X -200 to 200 mm, ..."
std::string ranges_text(const Machine& machine, const std::vector<AxisRange>& ranges);

/// Figures of the unseen poses, with the keys of `held_out` in docs/report-data.md.
nlohmann::ordered_json unseen_poses_json(const CompensatedPoses& poses);

/// For people.
void print_verify(const VerifyResult& result);

/// For programs; units in the keys.
nlohmann::ordered_json verify_json(const VerifyOptions& options, const VerifyResult& result);

}  // namespace abbe
