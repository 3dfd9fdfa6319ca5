#include "step_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "abbe/formats/shapes/step_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/words/geometry_facts.h"
#include "messages.h"
#include "options.h"
#include "progress.h"

namespace abbe {

void StepReading::add_to(Subcommand* command) {
  added_ = {
      command
          ->add_option("--chord-mm", options_.chord_mm,
                       "STEP: largest distance of the triangles from the exact faces (default: 0.01; for parts "
                       "under 10 mm a thousandth of the size, over 100 mm a ten-thousandth, at most 0.1)")
          ->check(positive_number()),
      command
          ->add_option("--step-seconds", options_.most_seconds,
                       "STEP: time limit for the file in s; one face may take a third of it")
          ->check(positive_number())
          ->capture_default_str(),
      command->add_flag("--leave-out-faces", options_.leave_out_faces,
                        "STEP: continue without faces that cannot be read, and name them (default: refuse the file)")};
}

MeshFile StepReading::read_with_progress(const std::filesystem::path& mesh, MeshFileOptions options) const {
  Progress progress("reading " + mesh.filename().string());
  options.step.progress = [&](const std::string& /*what*/, std::size_t done, std::size_t total) {
    progress(done, total);
  };
  return read_mesh(mesh, options);
}

MeshFile StepReading::read(const std::filesystem::path& mesh, std::optional<FileLength> unit, int threads) const {
  MeshFile read = read_with_progress(mesh, {unit, threads, options_});
  // Only after the progress line has been cleared.
  if (!read.left_out.empty()) tell("abbe: warning: {}: {}\n", mesh.string(), left_out_faces_words(read));
  return read;
}

MeshFile StepReading::read_whole(const std::filesystem::path& mesh, const std::string& expected) const {
  MeshFile read = read_with_progress(mesh, {{}, 0, options_});
  if (!read.left_out.empty()) throw InputError({.file = mesh.string()}, left_out_faces_words(read), expected);
  return read;
}

const Option* StepReading::given() const {
  const auto at = std::find_if(added_.begin(), added_.end(), [](const Option* option) { return option->count() > 0; });
  return at == added_.end() ? nullptr : *at;
}

void StepReading::require_step_among(const std::vector<std::filesystem::path>& meshes) const {
  if (given() == nullptr) return;
  const auto is_read = [](const std::filesystem::path& file) { return !file.empty(); };
  const auto is_step_that_is_read = [&](const std::filesystem::path& file) {
    return is_read(file) && is_step_file(file);
  };
  if (std::any_of(meshes.begin(), meshes.end(), is_step_that_is_read)) return;
  const auto first = std::find_if(meshes.begin(), meshes.end(), is_read);
  refuse(first == meshes.end() ? "no mesh is read"
                               : fmt::format("{} is not a STEP file and has no exact faces", first->string()));
}

void StepReading::refuse(const std::string& why) const {
  if (const Option* const option = given()) throw InputError({.field = option->get_name()}, why, "no such option");
}

}  // namespace abbe
