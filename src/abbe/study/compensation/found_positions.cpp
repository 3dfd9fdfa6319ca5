#include "abbe/study/compensation/found_positions.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/formats/machine/placement_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/registration/registration.h"
#include "abbe/report/words/geometry_facts.h"

namespace abbe {
namespace {

PlacedWorkpiece lay_on_features(const WorkpieceScan& workpiece) {
  PlacedWorkpiece result;
  FeatureRegistrationOptions options;
  options.noise_mm = workpiece.noise;
  result.fine = register_to_features(workpiece.points, workpiece.features, workpiece.labels, workpiece.start, options);
  result.ok = result.fine.status == FineRegistrationStatus::ok;
  result.status = registration_status_name(result.fine.status);
  return result;
}

PlacedWorkpiece lay_on_mesh(const PositionsRequest& request, const JobOptions& options) {
  if (!request.part || !request.scan) {
    throw InputError({.file = request.file, .field = "workpiece"}, "its part or its scan is missing",
                     "the mesh of the part and the points of its scan");
  }
  PlacedWorkpiece result;
  if (!request.part->left_out.empty()) result.warnings.push_back("the part is " + incomplete_words(*request.part));
  for (const std::string& note : request.scan->notes) result.warnings.push_back("the scan: " + note);
  RegistrationOptions registration;
  registration.noise_mm = request.scans.workpiece->noise;
  const RegistrationTarget target(request.part->mesh, registration);
  const Registration found = target.register_scan(request.scan->cloud, stoppable_progress(options));
  result.fine = found.fine;
  result.ok = found.status == RegistrationStatus::ok;
  result.status = registration_status_name(found.status);
  return result;
}

}  // namespace

PositionsRequest read_positions_request(const std::string& file, const MeshFileOptions& options) {
  return read_positions_request(file, [&](const std::string& part) { return read_mesh(part, options); });
}

PositionsRequest read_positions_request(const std::string& file,
                                        const std::function<MeshFile(const std::string& part)>& read_part) {
  PositionsRequest request;
  request.file = file;
  request.scans = read_scanner_positioning(file);
  if (request.scans.workpiece && !request.scans.workpiece->part.empty()) {
    request.part = read_part(request.scans.workpiece->part.string());
    request.scan = read_point_cloud(request.scans.workpiece->scan);
  }
  return request;
}

FoundPositions find_positions(const PositionsRequest& request, const JobOptions& options) {
  stop_if_asked(options.stop);
  FoundPositions result;
  result.file = request.file;
  result.scanner = locate_scanner(request.scans.scans);
  if (result.scanner.status != PositioningStatus::ok) {
    result.problem = fmt::format("{}: the scanner's position is not found: {}", request.file, result.scanner.reason);
    return result;
  }
  const std::optional<WorkpieceScan>& workpiece = request.scans.workpiece;
  if (!workpiece) return result;
  result.workpiece = workpiece->part.empty() ? lay_on_features(*workpiece) : lay_on_mesh(request, options);
  if (result.workpiece->ok) {
    result.workpiece->placement = locate_workpiece(result.scanner, result.workpiece->fine);
  } else {
    result.problem =
        fmt::format("{}: the workpiece's position is not found: {}", request.file, result.workpiece->status);
  }
  return result;
}

std::string found_positions_text(const FoundPositions& found) {
  return positions_text(found.file, found.scanner, found.workpiece ? &*found.workpiece : nullptr);
}

nlohmann::ordered_json found_positions_json(const FoundPositions& found) {
  return positions_json(found.file, found.scanner, found.workpiece ? &*found.workpiece : nullptr);
}

std::string found_placement_file(const FoundPositions& found, bool table_to_workpiece) {
  return placement_text({found.workpiece->placement, found.workpiece->warnings}, table_to_workpiece);
}

}  // namespace abbe
