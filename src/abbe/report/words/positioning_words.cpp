#include "abbe/report/words/positioning_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/text/vector_json.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/report/evaluations/positioning_json.h"

namespace abbe {
namespace {

nlohmann::ordered_json matrix_json(const RigidTransform& t) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (int i = 0; i < 3; ++i) {
    rows.push_back({t.rotation(i, 0), t.rotation(i, 1), t.rotation(i, 2), t.translation[i]});
  }
  rows.push_back({0, 0, 0, 1});
  return rows;
}

nlohmann::ordered_json covariance_json(const Eigen::Matrix<double, 6, 6>& covariance) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (int i = 0; i < 6; ++i) {
    nlohmann::ordered_json row = nlohmann::ordered_json::array();
    for (int k = 0; k < 6; ++k) row.push_back(covariance(i, k));
    rows.push_back(std::move(row));
  }
  return rows;
}

nlohmann::ordered_json placement_json(const Placement& placement, bool table_to_workpiece) {
  const PositioningParameters p = positioning_parameters(placement, table_to_workpiece);
  nlohmann::ordered_json json;
  json["maps"] = table_to_workpiece ? "p_workpiece = D p_table" : "p_table = D p_workpiece";
  json["D"] =
      matrix_json(table_to_workpiece ? placement.table_from_workpiece.inverse() : placement.table_from_workpiece);
  json.update(position_json(p));
  json["covariance_mm_rad"] = covariance_json(p.covariance);
  return json;
}

std::string pose_lines(const char* words, const Eigen::Vector3d& translation, const Eigen::Vector3d& angles,
                       const Eigen::Matrix<double, 6, 6>& covariance) {
  std::string text;
  const auto u = [&](int i) { return std::sqrt(std::max(0.0, covariance(i, i))); };
  text +=
      fmt::format("  {:<46}{:>11.4f}{:>11.4f}{:>11.4f}{:>11.5f}{:>11.5f}{:>11.5f}\n", words, translation.x(),
                  translation.y(), translation.z(), angles.x() / kDegree, angles.y() / kDegree, angles.z() / kDegree);
  text += fmt::format("  {:<46}{:>11.4f}{:>11.4f}{:>11.4f}{:>11.5f}{:>11.5f}{:>11.5f}\n", "  standard uncertainty",
                      u(0), u(1), u(2), u(3) / kDegree, u(4) / kDegree, u(5) / kDegree);
  return text;
}

nlohmann::ordered_json scanner_json(const ScannerPosition& scanner) {
  nlohmann::ordered_json json;
  json["table_from_scanner"] = matrix_json(scanner.table_from_scanner);
  json["covariance_of"] =
      "small motion in the table's frame at the table's origin: translation mm, rotation vector rad";
  json["covariance"] = covariance_json(scanner.covariance);
  json["x_direction"] = vector_json(scanner.x_direction);
  json["y_direction"] = vector_json(scanner.y_direction);
  json["axis_direction"] = vector_json(scanner.axis_direction);
  json["sphere_centre_mm"] = vector_json(scanner.sphere_centre);
  json["foot_on_axis_mm"] = vector_json(scanner.on_axis);
  json["squareness_urad"] = 1e6 * scanner.squareness;
  json["axis_tilt_urad"] = {1e6 * scanner.axis_tilt.x(), 1e6 * scanner.axis_tilt.y()};
  return json;
}

}  // namespace

nlohmann::ordered_json positions_json(const std::string& file, const ScannerPosition& scanner,
                                      const PlacedWorkpiece* workpiece) {
  nlohmann::ordered_json json;
  json["file"] = file;
  json["status"] = scanner.status == PositioningStatus::ok ? "ok" : "no_position";
  if (scanner.status != PositioningStatus::ok) {
    json["reason"] = scanner.reason;
    return json;
  }
  json["scanner"] = scanner_json(scanner);
  if (workpiece == nullptr) return json;
  json["workpiece"]["status"] = workpiece->status;
  if (!workpiece->warnings.empty()) json["workpiece"]["warnings"] = workpiece->warnings;
  if (!workpiece->ok) {
    json["status"] = "no_position";
    return json;
  }
  json["workpiece"]["workpiece_from_scanner"] = matrix_json(workpiece->fine.mesh_from_scan);
  json["workpiece"]["points_used"] = workpiece->fine.used;
  json["workpiece"]["scatter_um"] = 1e3 * workpiece->fine.scale_mm;
  json["workpiece"]["table_to_workpiece"] = placement_json(workpiece->placement, true);
  json["workpiece"]["workpiece_to_table"] = placement_json(workpiece->placement, false);
  return json;
}

std::string positions_text(const std::string& file, const ScannerPosition& scanner, const PlacedWorkpiece* workpiece) {
  std::string text = fmt::format("Positions of {}, x y z / mm, alpha beta gamma of Rx Ry Rz / deg\n", file);
  text += pose_lines("p_table = D p_scanner (MCS to BCS)", scanner.table_from_scanner.translation,
                     angles_xyz(scanner.table_from_scanner.rotation), scanner.covariance);
  if (workpiece != nullptr) {
    const RigidTransform& on_part = workpiece->fine.mesh_from_scan;
    const Eigen::Vector3d angles = angles_xyz(on_part.rotation);
    text += fmt::format("  {:<46}{:>11.4f}{:>11.4f}{:>11.4f}{:>11.5f}{:>11.5f}{:>11.5f}\n",
                        "p_workpiece = D p_scanner (MCS to WCS)", on_part.translation.x(), on_part.translation.y(),
                        on_part.translation.z(), angles.x() / kDegree, angles.y() / kDegree, angles.z() / kDegree);
    for (const bool to_workpiece : {true, false}) {
      const PositioningParameters p = positioning_parameters(workpiece->placement, to_workpiece);
      text += pose_lines(to_workpiece ? "p_workpiece = D p_table (BCS to WCS)" : "p_table = D p_workpiece (WCS to BCS)",
                         p.translation, p.angles, p.covariance);
    }
    text += fmt::format("  scan on the workpiece: {} points used, scatter {:.1f} um\n", workpiece->fine.used,
                        1e3 * workpiece->fine.scale_mm);
    for (const std::string& warning : workpiece->warnings) text += fmt::format("  warning: {}\n", warning);
  }
  return text + fmt::format(
                    "  angle from X to Y {:+.1f} urad off 90 degrees; table's axis tilted by {:+.1f}, {:+.1f} "
                    "urad about X, Y\n",
                    1e6 * scanner.squareness, 1e6 * scanner.axis_tilt.x(), 1e6 * scanner.axis_tilt.y());
}

}  // namespace abbe
