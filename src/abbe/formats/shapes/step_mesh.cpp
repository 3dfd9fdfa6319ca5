#include "abbe/formats/shapes/step_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {
namespace {

// Two programs of different builds may meet.
constexpr const char* kKind = "abbe-step mesh 3";

constexpr const char* kProgress = "progress ";

template <typename T>
void append(std::string& bytes, const T* values, std::size_t count) {
  if (count > 0) bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

template <typename T>
void take(std::string_view& bytes, T* values, std::size_t count) {
  if (count > 0) std::memcpy(values, bytes.data(), count * sizeof(T));
  bytes.remove_prefix(count * sizeof(T));
}

// As a whole number only: 1e300 has no place in a size_t.
std::size_t count_of(const nlohmann::json& head, const char* name) {
  const nlohmann::json& value = head.at(name);
  if (!value.is_number_unsigned()) {
    throw nlohmann::json::type_error::create(302, std::string(name) + " is not a count", &value);
  }
  return value.get<std::size_t>();
}

}  // namespace

double default_step_chord(double size_mm) {
  return std::clamp(1e-4 * size_mm, std::min(0.01, 1e-3 * size_mm), std::max(0.1, kFinestStepChord * size_mm));
}

std::string step_progress_line(const StepProgress& progress) {
  return fmt::format("{}{} {} {}", kProgress, progress.done, progress.total, progress.what);
}

std::optional<StepProgress> parse_step_progress(std::string_view line) {
  if (!line.starts_with(kProgress)) return std::nullopt;
  line.remove_prefix(std::strlen(kProgress));
  StepProgress result;
  const char* const end = line.data() + line.size();
  const auto done = std::from_chars(line.data(), end, result.done);
  if (done.ec != std::errc() || done.ptr == end) return std::nullopt;
  const auto total = std::from_chars(done.ptr + 1, end, result.total);
  if (total.ec != std::errc() || total.ptr == end) return std::nullopt;
  result.what = std::string(total.ptr + 1, end);
  return result;
}

std::string step_mesh_bytes(const StepMesh& mesh) {
  const auto vertices = static_cast<std::size_t>(mesh.mesh.vertices.cols());
  const auto triangles = static_cast<std::size_t>(mesh.mesh.size());
  const nlohmann::ordered_json head = {{"kind", kKind},
                                       {"vertices", vertices},
                                       {"triangles", triangles},
                                       {"faces", mesh.faces},
                                       {"solids", mesh.solids},
                                       {"unit", mesh.unit},
                                       {"deviation_mm", mesh.deviation_mm},
                                       {"chord_mm", mesh.chord_mm},
                                       {"size_mm", mesh.size_mm},
                                       {"left_out", mesh.left_out},
                                       {"left_out_share", mesh.left_out_share.value_or(-1)},
                                       {"notes", mesh.notes}};
  // A name in a STEP file may have any bytes.
  std::string bytes = head.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  bytes.reserve(bytes.size() + 24 * vertices + 16 * triangles);
  append(bytes, mesh.mesh.vertices.data(), 3 * vertices);
  append(bytes, mesh.mesh.triangles.data(), 3 * triangles);
  append(bytes, mesh.face_of_triangle.data(), triangles);
  return bytes;
}

StepMesh parse_step_mesh(std::string_view bytes, const std::string& file) {
  const auto refuse = [&](const char* why) {
    throw InputError({file, 0, 0, ""}, std::string("abbe-step gave no mesh: ") + why, "abbe-step of this version");
  };
  const std::size_t end = bytes.find('\n');
  if (end == std::string_view::npos) refuse("no first line");
  StepMesh result;
  std::size_t vertices = 0, triangles = 0;
  try {
    const nlohmann::json head = nlohmann::json::parse(bytes.substr(0, end));
    if (head.at("kind").get<std::string>() != kKind) refuse("another version");
    vertices = count_of(head, "vertices");
    triangles = count_of(head, "triangles");
    result.faces = count_of(head, "faces");
    result.solids = count_of(head, "solids");
    head.at("unit").get_to(result.unit);
    head.at("deviation_mm").get_to(result.deviation_mm);
    head.at("chord_mm").get_to(result.chord_mm);
    head.at("size_mm").get_to(result.size_mm);
    head.at("left_out").get_to(result.left_out);
    if (const double share = head.at("left_out_share").get<double>(); share >= 0) result.left_out_share = share;
    head.at("notes").get_to(result.notes);
  } catch (const nlohmann::json::exception&) {
    refuse("the first line is not understood");
  }
  bytes.remove_prefix(end + 1);
  // Compared before they are multiplied, so that no count is too large for that.
  if (vertices > bytes.size() / 24 || triangles > bytes.size() / 16 || bytes.size() != 24 * vertices + 16 * triangles) {
    refuse("the length does not fit");
  }
  if (triangles == 0) refuse("no triangles");
  if (vertices == 0) refuse("no vertices");
  if (!(result.deviation_mm >= 0) || !(result.chord_mm > 0)) refuse("no tolerance");
  result.mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices));
  result.mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles));
  result.face_of_triangle.resize(triangles);
  take(bytes, result.mesh.vertices.data(), 3 * vertices);
  take(bytes, result.mesh.triangles.data(), 3 * triangles);
  take(bytes, result.face_of_triangle.data(), triangles);
  // Not all() of a comparison: NaN has to fail.
  if (!result.mesh.vertices.allFinite() || result.mesh.vertices.cwiseAbs().maxCoeff() > kLargestInput) {
    throw InputError({file, 0, 0, ""}, "a point of a face is not finite or too large",
                     "coordinates of at most 1e+09 mm");
  }
  if (result.mesh.triangles.maxCoeff() >= vertices) refuse("a vertex that does not exist");
  for (const std::uint32_t face : result.face_of_triangle) {
    if (face >= result.faces) refuse("a face that does not exist");
  }
  return result;
}

}  // namespace abbe
