#pragma once

#include "abbe/machine/tool_path.h"
#include "bindings/use/map_parts.h"

namespace abbe::python {

const char* path_status_words(PathStatus status);
const char* tool_path_status_words(ToolPathStatus status);

/// A jump with the name of its axis.
struct NamedJump {
  PathJump jump;
  std::string axis;
};
std::vector<NamedJump> named_jumps(const Machine& machine, const std::vector<PathJump>& jumps);

/// Jumps, and paths of poses.
void bind_path_parts(nb::module_& module);

}  // namespace abbe::python
