#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/compensate/left_out_errors.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// What was left out, what was not although it is small by itself, and how far the former moves the tool: lines of the
/// report, each beginning with `indent`.
std::string left_out_text(const Machine& machine, double factor, const LeftOutErrors& left_out, const char* indent);
/// The same under left_out, left_out_kept, left_out_largest_um and left_out_largest_at.
void state_left_out(const Machine& machine, const LeftOutErrors& left_out, nlohmann::ordered_json& json);

}  // namespace abbe
