#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/formats/files/file_name.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/drawings/surface_picture.h"
#include "abbe/report/pages/path_page.h"
#include "abbe/report/words/geometry_facts.h"
#include "abbe/report/words/path_words.h"
#include "abbe/report/words/state_words.h"
#include "abbe/study/compensation/planned_path.h"

namespace abbe {

std::string planned_path_file(const PlannedPath& planned, const std::string& name, PathProgramOptions options) {
  const std::string extension = std::filesystem::path(name).extension().string();
  if (extension == ".csv") return path_csv(planned.machine, planned.path, planned.commands);
  if (extension != ".ngc" && extension != ".nc" && extension != ".tap" && extension != ".mpf") {
    throw InputError({.file = name}, "unknown kind of program file", "a name ending in .ngc, .nc, .tap, .mpf or .csv");
  }
  options.comments.push_back("tool path of " + file_name(planned.curve_file) + " on " + planned.machine.name);
  if (!planned.at_state.empty()) options.comments.push_back("errors taken at " + state_words(planned.at_state));
  return path_program(planned.machine, planned.path, planned.commands, options);
}

std::string planned_path_text(const PlannedPath& planned) {
  std::string text = path_text(planned.machine, planned.path, planned.miss) + state_line(planned.at_state);
  if (!planned.errors_along.empty()) {
    text += fmt::format("corrected at every pose: {}\n", fmt::join(planned.errors_along, ", "));
  }
  return text;
}

nlohmann::ordered_json planned_path_json(const PlannedPath& planned) {
  nlohmann::ordered_json json = path_json(planned.machine, planned.path, planned.miss);
  add_state(planned.at_state, json);
  if (!planned.errors_along.empty()) json["errors_along"] = planned.errors_along;
  if (!planned.warnings.empty()) json["warnings"] = planned.warnings;
  return json;
}

std::string planned_path_page(const PlannedPath& planned, const MeshFile* part, const std::string& part_file) {
  std::optional<SurfacePicture> picture;
  if (part != nullptr) picture = part_picture(part->mesh, 0, 0);
  const std::string curve = file_name(planned.curve_file);
  std::vector<std::pair<std::string, std::string>> facts = path_facts(curve, planned.path);
  if (!planned.warnings.empty()) {
    facts.emplace_back("placement",
                       fmt::format("{}; {}", file_name(planned.placement_file), fmt::join(planned.warnings, "; ")));
  }
  if (picture) {
    facts.emplace_back("part", fmt::format("{}, {} triangles{}", file_name(part_file), picture->triangles_of_part,
                                           part->left_out.empty() ? "" : "; " + incomplete_words(*part)));
  }
  return path_page("Tool path of " + curve, planned.machine, facts,
                   path_picture(planned.machine, planned.path, planned.commands), picture);
}

}  // namespace abbe
