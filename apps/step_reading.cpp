#include "step_reading.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/input_error.h"
#include "abbe/formats/step_file.h"
#include "options.h"

namespace abbe {

void StepReading::add_to(Subcommand* command) {
  added_.push_back(
      command
          ->add_option("--chord-mm", options_.chord_mm, "STEP: largest distance of the triangles from the exact faces")
          ->check(positive_number())
          ->capture_default_str());
}

MeshFile StepReading::read(const std::filesystem::path& mesh, std::optional<FileLength> unit, int threads) const {
  return read_mesh(mesh, {unit, threads, options_});
}

const Option* StepReading::given() const {
  const auto at = std::find_if(added_.begin(), added_.end(), [](const Option* option) { return option->count() > 0; });
  return at == added_.end() ? nullptr : *at;
}

void StepReading::require_step_among(const std::vector<std::filesystem::path>& meshes) const {
  if (given() == nullptr) return;
  if (std::any_of(meshes.begin(), meshes.end(), [](const auto& file) { return is_step_file(file); })) return;
  refuse(meshes.empty() ? "no mesh is read"
                        : fmt::format("{} is no STEP file and has no exact faces", meshes[0].string()));
}

void StepReading::refuse(const std::string& why) const {
  if (const Option* const option = given()) throw InputError({.field = option->get_name()}, why, "no such option");
}

}  // namespace abbe
