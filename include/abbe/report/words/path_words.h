#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "abbe/machine/tool_path.h"
#include "abbe/machine/tool_path_miss.h"

namespace abbe {

/// A tool path for people: moves, times, what it misses, ranges of the axes, jumps; complete lines.
std::string path_text(const Machine& machine, const ToolPath& path, const ToolPathMiss& miss);

/// The same for programs; units in the keys.
nlohmann::ordered_json path_json(const Machine& machine, const ToolPath& path, const ToolPathMiss& miss);

/// Facts about a path for its page: name, text. @param curve  name of its file
std::vector<std::pair<std::string, std::string>> path_facts(const std::string& curve, const ToolPath& path);

}  // namespace abbe
