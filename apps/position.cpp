#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/input_error.h"
#include "abbe/formats/json_text.h"
#include "abbe/formats/mesh_file.h"
#include "abbe/formats/placement_file.h"
#include "abbe/formats/point_cloud_file.h"
#include "abbe/formats/results_folder.h"
#include "abbe/formats/scanner_positioning_file.h"
#include "abbe/formats/vector_json.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/registration.h"
#include "command.h"
#include "exit_code.h"
#include "messages.h"
#include "options.h"
#include "position/position_json.h"
#include "progress.h"
#include "step_reading.h"

namespace abbe {
namespace {

struct PositionCommand {
  std::string file, output, maps;  ///< maps: "table-to-workpiece" if empty
  bool json = false;
  StepReading step;
};

/// The scan laid on the workpiece, and why not.
struct OnWorkpiece {
  std::vector<std::string> warnings;
  FineRegistration fine;
  bool ok = false;
  std::string status;
};

OnWorkpiece lay_on_workpiece(const WorkpieceScan& workpiece, const StepReading& step) {
  OnWorkpiece result;
  if (workpiece.part.empty()) {
    FeatureRegistrationOptions options;
    options.noise_mm = workpiece.noise;
    result.fine =
        register_to_features(workpiece.points, workpiece.features, workpiece.labels, workpiece.start, options);
    result.ok = result.fine.status == FineRegistrationStatus::ok;
    result.status = registration_status_name(result.fine.status);
    return result;
  }
  RegistrationOptions options;
  options.noise_mm = workpiece.noise;
  const MeshFile part = step.read(workpiece.part);
  if (!part.left_out.empty()) result.warnings.push_back("the part is " + incomplete_words(part));
  const PointCloudFile scan = read_point_cloud(workpiece.scan);
  Progress progress("registering");
  const Registration found = RegistrationTarget(part.mesh, options).register_scan(scan.cloud, progress.callback());
  result.fine = found.fine;
  result.ok = found.status == RegistrationStatus::ok;
  result.status = registration_status_name(found.status);
  return result;
}

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

nlohmann::ordered_json reading_json(const Placement& placement, bool table_to_workpiece) {
  const PositioningParameters p = positioning_parameters(placement, table_to_workpiece);
  nlohmann::ordered_json json;
  json["maps"] = table_to_workpiece ? "p_workpiece = D p_table" : "p_table = D p_workpiece";
  json["D"] =
      matrix_json(table_to_workpiece ? placement.table_from_workpiece.inverse() : placement.table_from_workpiece);
  json.update(position_json(p));
  json["covariance_mm_rad"] = covariance_json(p.covariance);
  return json;
}

void print_pose(const char* words, const Eigen::Vector3d& translation, const Eigen::Vector3d& angles,
                const Eigen::Matrix<double, 6, 6>& covariance) {
  const auto u = [&](int i) { return std::sqrt(std::max(0.0, covariance(i, i))); };
  fmt::print("  {:<46}{:>11.4f}{:>11.4f}{:>11.4f}{:>11.5f}{:>11.5f}{:>11.5f}\n", words, translation.x(),
             translation.y(), translation.z(), angles.x() / kDegree, angles.y() / kDegree, angles.z() / kDegree);
  fmt::print("  {:<46}{:>11.4f}{:>11.4f}{:>11.4f}{:>11.5f}{:>11.5f}{:>11.5f}\n", "  standard uncertainty", u(0), u(1),
             u(2), u(3) / kDegree, u(4) / kDegree, u(5) / kDegree);
}

int run_position(const PositionCommand& command) {
  const ScannerPositioningFile file = read_scanner_positioning(command.file);
  if (!command.output.empty() && !file.workpiece) {
    throw InputError({.field = "--output"}, "there is no workpiece to be placed",
                     "a table [workpiece] in " + command.file);
  }
  if (command.output.empty() && !command.maps.empty()) {
    throw InputError({.field = "--maps"}, "there is no placement whose matrix maps that way", "with --output");
  }
  command.step.require_step_among({file.workpiece ? file.workpiece->part : std::filesystem::path()});
  const ScannerPosition scanner = locate_scanner(file.scans);
  nlohmann::ordered_json json;
  json["file"] = command.file;
  json["status"] = scanner.status == PositioningStatus::ok ? "ok" : "no_position";
  if (scanner.status != PositioningStatus::ok) {
    json["reason"] = scanner.reason;
    if (command.json) fmt::print("{}", json_text(json));
    tell("abbe: {}: the scanner's position is not found: {}\n", command.file, scanner.reason);
    return kNegative;
  }
  json["scanner"] = scanner_json(scanner);
  Placement placement;
  OnWorkpiece laid;
  if (file.workpiece) {
    laid = lay_on_workpiece(*file.workpiece, command.step);
    json["workpiece"]["status"] = laid.status;
    if (!laid.warnings.empty()) json["workpiece"]["warnings"] = laid.warnings;
    if (!laid.ok) {
      json["status"] = "no_position";
      if (command.json) fmt::print("{}", json_text(json));
      tell("abbe: {}: the workpiece's position is not found: {}\n", command.file, laid.status);
      return kNegative;
    }
    placement = locate_workpiece(scanner, laid.fine);
    json["workpiece"]["workpiece_from_scanner"] = matrix_json(laid.fine.mesh_from_scan);
    json["workpiece"]["points_used"] = laid.fine.used;
    json["workpiece"]["scatter_um"] = 1e3 * laid.fine.scale_mm;
    json["workpiece"]["table_to_workpiece"] = reading_json(placement, true);
    json["workpiece"]["workpiece_to_table"] = reading_json(placement, false);
  }
  if (!command.output.empty()) {
    write_file_atomically(command.output,
                          placement_text({placement, laid.warnings}, command.maps != "workpiece-to-table"));
  }
  if (command.json) {
    fmt::print("{}", json_text(json));
    return kDone;
  }
  fmt::print("Positions of {}, x y z / mm, alpha beta gamma of Rx Ry Rz / deg\n", command.file);
  print_pose("p_table = D p_scanner (MCS to BCS)", scanner.table_from_scanner.translation,
             angles_xyz(scanner.table_from_scanner.rotation), scanner.covariance);
  if (file.workpiece) {
    fmt::print("  {:<46}{:>11.4f}{:>11.4f}{:>11.4f}{:>11.5f}{:>11.5f}{:>11.5f}\n",
               "p_workpiece = D p_scanner (MCS to WCS)", laid.fine.mesh_from_scan.translation.x(),
               laid.fine.mesh_from_scan.translation.y(), laid.fine.mesh_from_scan.translation.z(),
               angles_xyz(laid.fine.mesh_from_scan.rotation).x() / kDegree,
               angles_xyz(laid.fine.mesh_from_scan.rotation).y() / kDegree,
               angles_xyz(laid.fine.mesh_from_scan.rotation).z() / kDegree);
    for (const bool to_workpiece : {true, false}) {
      const PositioningParameters p = positioning_parameters(placement, to_workpiece);
      print_pose(to_workpiece ? "p_workpiece = D p_table (BCS to WCS)" : "p_table = D p_workpiece (WCS to BCS)",
                 p.translation, p.angles, p.covariance);
    }
    fmt::print("  scan on the workpiece: {} points used, scatter {:.1f} um\n", laid.fine.used,
               1e3 * laid.fine.scale_mm);
  }
  for (const std::string& warning : laid.warnings) fmt::print("  warning: {}\n", warning);
  fmt::print(
      "  angle from X to Y {:+.1f} urad off 90 degrees; table's axis tilted by {:+.1f}, {:+.1f} urad about X, Y\n",
      1e6 * scanner.squareness, 1e6 * scanner.axis_tilt.x(), 1e6 * scanner.axis_tilt.y());
  if (!command.output.empty()) fmt::print("{} written\n", command.output);
  return kDone;
}

}  // namespace

void add_position_command(CommandLine& line) {
  auto command = std::make_shared<PositionCommand>();
  Subcommand* app = line.add(
      "position",
      "Find where a scanner and a workpiece stand in a machine, from scans of targets, a sphere and the part",
      "  abbe position examples/laser_engraver/scanner.positioning.toml\n"
      "  abbe position examples/laser_engraver/scanner.positioning.toml -o part.placement.toml\n\n"
      "The file names a CSV with target, x_mm, y_mm, z_mm in the scanner's frame; docs/workpiece-position.md.\n"
      "Exit code 1: the scans do not determine the position; the message says why.");
  app->add_option("file", command->file, "Scans and what they show (*.positioning.toml)")->required();
  app->add_output_file("-o,--output", command->output, "Placement to write (*.placement.toml), as abbe path takes it");
  app->add_option("--maps", command->maps,
                  "Direction in which the matrix of the written placement maps: table-to-workpiece (default) or "
                  "workpiece-to-table")
      ->check(one_of({"table-to-workpiece", "workpiece-to-table"}));
  command->step.add_to(app);
  app->add_flag("--json", command->json, "Print JSON for programs");
  app->callback([&line, command] { line.run = [command] { return run_position(*command); }; });
}

}  // namespace abbe
