#include "abbe/formats/machine/file_kind.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "abbe/formats/files/file_extension.h"
#include "abbe/formats/files/standard_input.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/shapes/ending.h"
#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

/// A kind of TOML file that `abbe check` does not take by itself, and what does.
struct OtherKind {
  std::string_view ending;
  std::array<std::string_view, 2> lines;  ///< beginnings of lines that only such files have
  const char* name;
  const char* expected;
};

constexpr OtherKind kStudyKind = {".study.toml", {"[[setup]]", "[[setup.data]]"}, "this is a study", ""};

constexpr std::array<OtherKind, 3> kOtherKinds = {
    {{".errors.toml",
      {"[[motion]]", "[[location]]"},
      "this is an errors file",
      "--machine with the file of its machine, and --errors with this one"},
     {".placement.toml",
      {"maps =", "translation_mm ="},
      "this is the placement of a workpiece",
      "abbe path --placement with it"},
     {".positioning.toml",
      {"sphere_radius_mm =", "sphere_height_mm ="},
      "these are scans of targets",
      "abbe position with it"}}};

bool is_of_kind(const OtherKind& kind, const std::string& name, std::string_view contents) {
  if (name.ends_with(kind.ending) || name == kind.ending.substr(1)) return true;
  return std::any_of(kind.lines.begin(), kind.lines.end(), [&](std::string_view line) {
    return contents.starts_with(line) || contents.find("\n" + std::string(line)) != std::string_view::npos;
  });
}

}  // namespace

bool is_geometry_file(const std::string& file) {
  const std::string name = with_ending(std::filesystem::path(file));
  return has_mesh_extension(name) || has_point_cloud_extension(name);
}

bool has_points_only(const std::string& file) {
  if (has_point_cloud_extension(with_ending(std::filesystem::path(file)))) return true;
  const MappedFile mapped(file);
  return is_ply(mapped.text()) && parse_ply(mapped.text(), file).triangles.cols() == 0;
}

bool is_frozen_file(const std::string& file) {
  if (file != kStandardInput) return std::filesystem::path(file).extension() == ".abbec";
  return MappedFile(file).text().starts_with(
      "\x89"
      "ABBEC");
}

bool is_study_file(const std::string& file) {
  const std::string name = std::filesystem::path(file).filename().string();
  if (file != kStandardInput && file_extension(file) != ".toml") return false;
  return is_of_kind(kStudyKind, name, MappedFile(file).text());
}

void require_machine_file(const std::string& file) {
  const MappedFile contents(file);
  if (file_extension(file) == ".toml" || ending_of(contents.text()) == ".toml") {
    const std::string name = std::filesystem::path(file).filename().string();
    for (const OtherKind& kind : kOtherKinds) {
      if (is_of_kind(kind, name, contents.text())) throw InputError({.file = file}, kind.name, kind.expected);
    }
    return;
  }
  if (file == kStandardInput) {
    refuse_contents(file, contents.text(), "a file",
                    {".toml", ".abbec", ".stl", ".ply", ".obj", ".step", ".csv", ".pcd", ".e57", ".xyz"});
  }
  throw InputError({.file = file}, "its name does not tell its kind",
                   "a name ending in .abbec, .stl, .ply, .obj, .step, .stp, .xyz, .asc, .pts, .csv, .pcd or .e57, or "
                   "--machine with a machine file");
}

}  // namespace abbe
