#include "abbe/report/drawings/surface_data.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "abbe/report/drawings/packed_numbers.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Grid on which coordinates are written.
struct Steps {
  Vector3d lower = Vector3d::Zero();
  double step = 1;

  Steps(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xd& feet) {
    Eigen::AlignedBox3d box;
    for (Index i = 0; i < vertices.cols(); ++i) box.extend(Vector3d(vertices.col(i)));
    for (Index i = 0; i < feet.cols(); ++i) box.extend(Vector3d(feet.col(i)));
    if (box.isEmpty()) return;
    lower = box.min();
    const double extent = box.sizes().maxCoeff();
    step = extent > 0 ? extent / kPictureSteps : 1e-6;
  }

  std::string packed_points(const Eigen::Matrix3Xd& points) const {
    std::vector<std::uint16_t> numbers;
    numbers.reserve(static_cast<std::size_t>(points.size()));
    for (Index i = 0; i < points.cols(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const double steps = std::round((points(k, i) - lower[k]) / step);
        numbers.push_back(static_cast<std::uint16_t>(std::clamp(steps, 0.0, static_cast<double>(kPictureSteps))));
      }
    }
    return packed(std::span<const std::uint16_t>(numbers));
  }
};

std::string packed_triangles(const TriangleMesh& mesh) {
  const std::span<const std::uint32_t> all(mesh.triangles.data(), static_cast<std::size_t>(mesh.triangles.size()));
  if (mesh.vertices.cols() > 65536) return packed(all);
  std::vector<std::uint16_t> numbers;
  numbers.reserve(all.size());
  for (const std::uint32_t vertex : all) numbers.push_back(static_cast<std::uint16_t>(vertex));
  return packed(std::span<const std::uint16_t>(numbers));
}

std::int16_t in_steps(double deviation_mm, double step_mm) {
  return static_cast<std::int16_t>(std::clamp(std::round(deviation_mm / step_mm), -32767.0, 32767.0));
}

std::string packed_normals(const Eigen::Matrix3Xd& normals) {
  std::vector<std::int8_t> numbers;
  numbers.reserve(static_cast<std::size_t>(normals.size()));
  for (Index i = 0; i < normals.cols(); ++i) {
    for (int k = 0; k < 3; ++k) {
      numbers.push_back(static_cast<std::int8_t>(std::clamp(std::round(127 * normals(k, i)), -127.0, 127.0)));
    }
  }
  return packed(std::span<const std::int8_t>(numbers));
}

void add_deviation(const DeviationPicture& deviation, const Steps& steps, nlohmann::json& json) {
  const double step = deviation.limit_mm / kStepsToLimit;
  json["quantity"] = "signed deviation, positive outside of the material";
  json["limit_um"] = 1e3 * deviation.limit_mm;
  json["value_step_um"] = 1e3 * step;
  json["averaging_radius_mm"] = deviation.averaging_radius_mm;
  std::vector<std::int16_t> values;
  for (std::size_t i = 0; i < deviation.average.mean_mm.size(); ++i) {
    values.push_back(deviation.average.count[i] >= kFewestReadings ? in_steps(deviation.average.mean_mm[i], step)
                                                                   : kNoDeviation);
  }
  json["values"] = packed(std::span<const std::int16_t>(values));
  nlohmann::json& points = json["points"];
  points["measured"] = deviation.measured;
  points["counted"] = deviation.counted;
  points["drawn"] = deviation.readings.deviation_mm.size();
  points["foot"] = steps.packed_points(deviation.readings.foot);
  points["normal"] = packed_normals(deviation.readings.normal);
  values.clear();
  for (const double value : deviation.readings.deviation_mm) values.push_back(in_steps(value, step));
  points["values"] = packed(std::span<const std::int16_t>(values));
}

}  // namespace

nlohmann::json surface_data(const SurfacePicture& part, const DeviationPicture* deviation) {
  const auto vertices = static_cast<std::size_t>(part.mesh.vertices.cols());
  const auto triangles = static_cast<std::size_t>(part.mesh.size());
  if (!part.coverage.empty() && part.coverage.size() != triangles) {
    throw std::invalid_argument("surface: coverage is not one number for each triangle");
  }
  if (part.percent.size() > part.reasons.size() ||
      (!part.colours.empty() && part.colours.size() != part.reasons.size())) {
    throw std::invalid_argument("surface: shares or colours do not match the reasons");
  }
  if (deviation != nullptr && (deviation->average.mean_mm.size() != vertices || !(deviation->limit_mm > 0))) {
    throw std::invalid_argument("surface: deviations are not one for each vertex, or without a limit");
  }
  const Steps steps(part.mesh.vertices, deviation != nullptr ? deviation->readings.foot : Eigen::Matrix3Xd(3, 0));
  nlohmann::json json;
  json["frame"] = part.frame;
  json["triangles_of_part"] = part.triangles_of_part;
  if (part.thinned_cell_mm > 0) json["thinned_cell_mm"] = part.thinned_cell_mm;
  json["lower_mm"] = {steps.lower.x(), steps.lower.y(), steps.lower.z()};
  json["step_mm"] = steps.step;
  json["vertex_count"] = vertices;
  json["triangle_count"] = triangles;
  json["vertices"] = steps.packed_points(part.mesh.vertices);
  json["triangles"] = packed_triangles(part.mesh);
  if (!part.coverage.empty()) {
    json["coverage"] = {{"reasons", part.reasons},
                        {"of_triangle", packed(std::span<const std::uint8_t>(part.coverage))}};
    if (!part.percent.empty()) json["coverage"]["percent"] = part.percent;
    if (!part.colours.empty()) json["coverage"]["colours"] = part.colours;
  }
  if (deviation != nullptr) add_deviation(*deviation, steps, json);
  return json;
}

}  // namespace abbe
