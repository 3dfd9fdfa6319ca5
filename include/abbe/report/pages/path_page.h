#pragma once

#include <optional>
#include <string>
#include <vector>

#include "abbe/machine/tool_path.h"
#include "abbe/report/drawings/surface_data.h"
#include "abbe/report/pages/path_data.h"

namespace abbe {

/// Moves of a tool path as a page plays them. @param commands  [steps][axes] as the control has them, mm or rad
PathPicture path_picture(const Machine& machine, const ToolPath& path,
                         const std::vector<std::vector<double>>& commands);

/// The page: facts, machine, path, on the part where there is one.
/// @param facts  what was planned: name, text
std::string path_page(const std::string& title, const Machine& machine,
                      const std::vector<std::pair<std::string, std::string>>& facts, const PathPicture& path,
                      const std::optional<SurfacePicture>& part);

}  // namespace abbe
