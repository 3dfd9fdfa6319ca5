#include "abbe/formats/shapes/step_file.h"

#include <fmt/format.h>

#include <csignal>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/files/child_process.h"
#include "abbe/formats/files/companion_program.h"
#include "abbe/formats/files/standard_input.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/shapes/step_mesh.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

constexpr CompanionProgram kStepProgram{"abbe-step", "ABBE_STEP_PROGRAM"};
constexpr const char* kValid = "a valid STEP file (AP203, AP214 or AP242) with faces";

/// What abbe-step said, without its progress.
struct Said {
  std::vector<std::string> lines;
  std::string doing;  ///< at last
};

Said said_in(std::string_view text) {
  Said said;
  const std::string name;
  TextCursor cursor(text, name);
  while (!cursor.at_end()) {
    const std::string_view line = cursor.line();
    if (const auto progress = parse_step_progress(line)) {
      said.doing = progress->total > 1
                       ? fmt::format("{}, {} of {} done", progress->what, progress->done, progress->total)
                       : progress->what;
    } else if (!line.empty()) {
      said.lines.emplace_back(line);
    }
  }
  return said;
}

void require_positive(double value, const char* field, const char* expected) {
  if (!(value > 0) || value > kLargestInput) {
    throw InputError({"", 0, 0, field}, fmt::format("is {:g}", value), expected);
  }
}

std::filesystem::path require_program(const InputError::Place& place) {
  std::filesystem::path program = find_companion_program(kStepProgram, place);
  if (!program.empty()) return program;
  throw InputError(place,
                   fmt::format("STEP files cannot be read here: there is no program {}",
                               path_beside_this_program(kStepProgram).string()),
                   "Abbe built with `make build` where the Debian package libocct-data-exchange-dev is installed, or "
                   "the part as STL");
}

[[noreturn]] void refuse(const InputError::Place& place, const ChildProcess& child, double seconds) {
  const Said said = said_in(child.messages());
  const std::string at = said.doing.empty() ? "" : fmt::format(" (it was {})", said.doing);
  if (child.timed_out() || child.signal() == SIGXCPU || child.exit_code() == kStepTimeIsUp) {
    throw InputError(place, fmt::format("OpenCASCADE was not done with the file after {:g} s{}", seconds, at),
                     "a coarser tolerance (--chord-mm) or more time (--step-seconds)");
  }
  if (child.signal() != 0) {
    throw InputError(place, fmt::format("OpenCASCADE stopped at the file ({}){}", ::strsignal(child.signal()), at),
                     kValid);
  }
  throw InputError(place, said.lines.empty() ? "OpenCASCADE could not read the file" : said.lines[0],
                   said.lines.size() == 2 ? said.lines[1] : kValid);
}

FileLength length_of(const std::string& unit) {
  return unit == "inch" ? FileLength::inch : unit == "metre" ? FileLength::metre : FileLength::millimetre;
}

}  // namespace

bool is_step(std::string_view contents) {
  while (!contents.empty() && is_blank(contents.front())) contents.remove_prefix(1);
  return contents.starts_with("ISO-10303-21");
}

bool is_step_file(const std::filesystem::path& path) { return is_step(MappedFile(path).text()); }

std::filesystem::path step_program() { return find_companion_program(kStepProgram); }

MeshFile read_step(const std::filesystem::path& path, const MeshFileOptions& options) {
  const InputError::Place place{path.string(), 0, 0, ""};
  if (options.unit) {
    throw InputError({path.string(), 0, 0, "unit"}, "a STEP file states its unit itself", "no unit");
  }
  if (options.step.chord_mm) require_positive(*options.step.chord_mm, "chord_mm", "a length above zero in mm");
  require_positive(options.step.angle_rad, "angle_rad", "an angle above zero in rad");
  require_positive(options.step.most_seconds, "most_seconds", "a time above zero in s");
  const std::filesystem::path program = require_program(place);
  // Cheaper and plainer than where the parser stumbles.
  if (MappedFile(path).text().rfind("END-ISO-10303-21") == std::string_view::npos) {
    throw InputError(place, "the file ends early", "a last line 'END-ISO-10303-21;'");
  }
  const double seconds = options.step.most_seconds;
  const auto listen = [&](std::string_view line) {
    const auto progress = parse_step_progress(line);
    if (progress && options.step.progress) options.step.progress(progress->what, progress->done, progress->total);
  };
  // It gives up by itself (kStepTimeIsUp), but not inside of some functions of OpenCASCADE.
  const ChildProcess child({program.string(), path_to_open(path).string(),
                            shortest_text(options.step.chord_mm.value_or(0)), shortest_text(options.step.angle_rad),
                            shortest_text(seconds), options.step.leave_out_faces ? "leave-out" : "all"},
                           1.1 * seconds + 1, listen);
  if (child.timed_out() || child.signal() != 0 || child.exit_code() != 0) refuse(place, child, seconds);
  StepMesh read = parse_step_mesh(child.output(), path.string());
  MeshFile result;
  result.mesh = std::move(read.mesh);
  result.format = "STEP";
  result.unit = {length_of(read.unit), read.unit.empty() ? UnitSource::assumed : UnitSource::stated};
  result.notes = std::move(read.notes);
  result.left_out = std::move(read.left_out);
  result.left_out_share = read.left_out_share;
  result.notes.push_back(
      fmt::format("{} of {}, divided within {:.3g} mm of them (tolerance {:.3g} mm{})",
                  counted(read.faces, "face", "faces"), counted(read.solids, "solid", "solids"), read.deviation_mm,
                  read.chord_mm, options.step.chord_mm ? "" : fmt::format(", for {:.3g} mm of size", read.size_mm)));
  result.faces = read.faces;
  result.face_of_triangle = std::move(read.face_of_triangle);
  result.deviation_mm = read.deviation_mm;
  return result;
}

}  // namespace abbe
