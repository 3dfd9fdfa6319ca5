#include "abbe/formats/step_mesh.h"

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "abbe/formats/input_error.h"
#include "abbe/formats/number_text.h"

namespace abbe {
namespace {

// Two programs of different builds may meet.
constexpr const char* kKind = "abbe-step mesh 1";

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
    throw nlohmann::json::type_error::create(302, std::string(name) + " is no count", &value);
  }
  return value.get<std::size_t>();
}

}  // namespace

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
                                       {"deflection_mm", mesh.deflection_mm},
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
    head.at("deflection_mm").get_to(result.deflection_mm);
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
  if (!(result.deviation_mm >= 0) || !(result.deflection_mm > 0)) refuse("no tolerance");
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
