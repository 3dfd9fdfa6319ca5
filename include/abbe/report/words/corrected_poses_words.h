#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/compensate/corrected_poses.h"

namespace abbe {

/// "row 3, X 100 mm, C 30 deg". @param row  from 1
std::string pose_words(const Machine& machine, const PoseList& poses, std::size_t row);

/// Corrected commands as CSV: a row for each pose with its status and what is left; what is not known is empty.
std::string poses_csv(const Machine& machine, const CorrectedPoses& result);

/// What was found, for people; complete lines.
/// @param leave_out_factor  as it was asked for
std::string poses_text(const Machine& machine, const PoseList& poses, const CorrectedPoses& result,
                       double leave_out_factor);

/// The same for programs; units in the keys. @param output  name of the file of the corrected commands
nlohmann::ordered_json poses_json(const Machine& machine, const PoseList& poses, const CorrectedPoses& result,
                                  const std::string& output, bool written);

}  // namespace abbe
