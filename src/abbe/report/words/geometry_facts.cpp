#include "abbe/report/words/geometry_facts.h"

#include <fmt/format.h>

#include "abbe/formats/text/list_text.h"

namespace abbe {

std::string left_out_faces_words(const MeshFile& mesh) {
  const std::string share =
      mesh.left_out_share ? fmt::format("{:.2g} % of the area", 100 * *mesh.left_out_share) : "of unknown area";
  return fmt::format("{} left out ({}): {}", counted(mesh.left_out.size(), "face is", "faces are"), share,
                     first_few(mesh.left_out, "; "));
}

std::string incomplete_words(const MeshFile& mesh) {
  return mesh.left_out.empty() ? "" : "incomplete: " + left_out_faces_words(mesh);
}

std::vector<std::pair<std::string, std::string>> facts_of(const PointCloudFile& scan, const MeshFile& part) {
  return {{"scan", fmt::format("{} points, {}", scan.cloud.size(), cloud_words(scan))},
          {"part", fmt::format("{} triangles, {}, {}{}{}", part.mesh.size(), part.format, unit_words(part.unit),
                               part.left_out.empty() ? "" : "; ", incomplete_words(part))}};
}

std::string triple_text(const Eigen::Vector3d& vector) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", vector.x(), vector.y(), vector.z());
}

}  // namespace abbe
