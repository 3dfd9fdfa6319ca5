#include "abbe/study/scans/scan_registration.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/formats/files/file_name.h"
#include "abbe/formats/machine/transform_file.h"
#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/report/pages/evaluation_data.h"
#include "abbe/report/pages/registration_page.h"
#include "abbe/report/report.h"
#include "abbe/report/words/geometry_facts.h"
#include "abbe/report/words/registration_words.h"
#include "abbe/study/scans/closest_points.h"
#include "abbe/study/scans/scan_of_part.h"

namespace abbe {

ScanRegistration register_scan(ScanRegistrationRequest request, const JobOptions& options) {
  check_scan_and_part(request.scan, request.scan_file, request.part, request.part_file);
  stop_if_asked(options.stop);
  ScanRegistration result;
  result.scan_file = std::move(request.scan_file);
  result.part_file = std::move(request.part_file);
  result.scan = std::move(request.scan);
  result.part = std::move(request.part);
  result.threads = request.options.threads;
  request.options.work = with_mesh(options.work, result.part.mesh);
  const RegistrationTarget target(result.part.mesh, request.options);
  result.found = target.register_scan(result.scan.cloud, stoppable_progress(options));
  if (request.compare && has_pose(result.found)) {
    const Eigen::Matrix3Xd points = registered_scan(result).points;
    std::optional<std::vector<SurfacePoint>> closest =
        closest_points(target.surface(), result.part.mesh, points, request.options.threads,
                       {.stop = options.stop, .work = options.work});
    if (!closest) return result;
    result.compared = compare_scan(std::move(*closest), points, {.largest_mm = farthest_shown_mm(result.part.mesh)});
  }
  return result;
}

PointCloud registered_scan(const ScanRegistration& result) {
  return moved_cloud(result.scan.cloud, result.found.fine.mesh_from_scan);
}

std::string scan_registration_text(const ScanRegistration& result, bool covariance) {
  std::string text = fmt::format("Registration of {} on {}\n", result.scan_file, result.part_file);
  for (const auto& [name, fact] : facts_of(result.scan, result.part)) text += fmt::format("  {}: {}\n", name, fact);
  text += "\n" + registration_text(result.found, result.scan.cloud.size(), covariance);
  for (const std::string& note : result.part.notes) text += fmt::format("note: {}: {}\n", result.part_file, note);
  return text;
}

nlohmann::ordered_json scan_registration_json(const ScanRegistration& result) {
  nlohmann::ordered_json json;
  json["scan"] = result.scan_file;
  json["part"] = result.part_file;
  for (const auto& [name, text] : facts_of(result.scan, result.part)) json["files"][name] = text;
  json.update(registration_json(result.found));
  return json;
}

std::string scan_registration_page(const ScanRegistration& result) {
  const std::string part = file_name(result.part_file);
  EvaluationReport page =
      registration_page(fmt::format("Registration of {} on {}", file_name(result.scan_file), part), result.found,
                        result.part.mesh, result.compared ? &*result.compared : nullptr, result.threads);
  const auto facts = facts_of(result.scan, result.part);
  page.facts.insert(page.facts.begin(), facts.begin(), facts.end());
  for (const std::string& note : result.part.notes) page.notes.push_back(part + ": " + note);
  return report_page(evaluation_data(page));
}

std::vector<std::pair<std::string, std::string>> scan_registration_files(const ScanRegistration& result) {
  std::vector<std::pair<std::string, std::string>> files;
  files.emplace_back("registration.json", json_text(scan_registration_json(result)));
  if (has_pose(result.found)) {
    files.emplace_back("transform.csv",
                       transform_csv(result.found.fine.mesh_from_scan,
                                     result.is_ok() ? "" : registration_status_name(result.found.status)));
    const PointCloud placed = registered_scan(result);
    files.emplace_back("registered.ply", ply_bytes({.points = placed.points, .normals = placed.normals}));
  }
  files.emplace_back("report.html", scan_registration_page(result));
  return files;
}

}  // namespace abbe
