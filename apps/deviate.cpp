#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "abbe/formats/machine/transform_file.h"
#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/drawings/deviation_colours.h"
#include "abbe/report/drawings/surface_picture.h"
#include "abbe/report/evaluations/deviation_report.h"
#include "command.h"
#include "evaluate/evaluate.h"
#include "evaluate/number_option.h"
#include "exit_code.h"
#include "options.h"
#include "scan/scan_files.h"

namespace abbe {
namespace {

struct DeviateCommand {
  ScanFiles files;
  EvaluationOptions options;
  std::string transform;
  double largest_mm = 0, lower_mm = 0, upper_mm = 0, colour_mm = 0, crease = 0;
  bool faces_of_file = false;
};

/// The transform, refused where the registration that wrote it found no pose.
TransformFile pose_of(const DeviateCommand& command) {
  if (command.transform.empty()) return {};
  TransformFile pose = read_transform_file(command.transform);
  if (!pose.status.empty() && pose.status != "ok" && pose.status != "ambiguous" && pose.status != "undetermined") {
    throw InputError({.file = command.transform, .field = "status"},
                     fmt::format("the registration that wrote this transform says {}", pose.status),
                     "the transform of a registration that found a pose (ok, ambiguous or undetermined)");
  }
  return pose;
}

SurfaceFaces faces_of(const DeviateCommand& command, const MeshFile& part) {
  if (!command.faces_of_file) {
    return command.crease > 0 ? surface_faces(part.mesh, command.crease, command.files.threads) : SurfaceFaces();
  }
  if (part.faces == 0) {
    throw InputError({command.files.part, 0, 0, ""}, "the file states no faces",
                     "a STEP file, or an OBJ file with o, g or usemtl; --faces-deg finds faces by their edges");
  }
  return stated_faces(part.mesh, part.face_of_triangle, part.faces);
}

int run_deviate(DeviateCommand command) {
  const TransformFile pose = pose_of(command);
  if (command.lower_mm > command.upper_mm) {
    throw InputError({.field = "--lower-um"}, "lies above --upper-um", "a band from lower to upper");
  }
  const PointCloudFile scan = command.files.read_scan();
  const MeshFile part = command.files.read_part();
  const Eigen::Matrix3Xd points = (pose.transform.rotation * scan.cloud.points).colwise() + pose.transform.translation;
  ScanComparisonOptions options;
  options.largest_mm = command.largest_mm;
  options.threads = command.files.threads;
  if (command.lower_mm != 0 || command.upper_mm != 0) {
    options.tolerance = DeviationTolerance{command.lower_mm, command.upper_mm};
  }
  const ClosestPointFinder surface(part.mesh, command.files.threads);
  options.faces = faces_of(command, part);
  const ScanComparison compared = compare_scan(surface, points, options);
  DeviationRequest request{.scan = command.files.scan,
                           .part = command.files.part,
                           .transform = command.transform,
                           .status = pose.status,
                           .tolerance = options.tolerance,
                           .largest_mm = command.largest_mm,
                           .colour_mm = command.colour_mm};
  if (command.faces_of_file) request.face_names = part.face_names;
  EvaluationReport report = deviation_report(request, scan, part, compared);
  if (!command.options.output.empty()) {
    const double range = deviation_colour_range(request, compared);
    command.options.files.emplace_back("deviation.csv",
                                       point_cloud_csv({compared.counted_points, {}}, compared.counted_mm));
    command.options.files.emplace_back("deviation.ply",
                                       ply_bytes({.points = compared.counted_points,
                                                  .colours = deviation_colours(compared.counted_mm, range),
                                                  .deviation = compared.counted_mm}));
    report.page = deviation_page(part.mesh, compared.closest, compared.deviation, range, command.files.threads);
  }
  const int code = finish_evaluation(report, command.options);
  return compared.counted_mm.empty() ? kNegative : code;
}

}  // namespace

void add_deviate_command(CommandLine& line) {
  auto command = std::make_shared<DeviateCommand>();
  Subcommand* app = line.add(
      "deviate", "Compute the signed deviation of a scan from its part: statistics, coloured points, report",
      "  abbe deviate examples/scan/pin-scan.csv examples/scan/pin.stl --transform examples/scan/pin-transform.csv\n"
      "  abbe deviate examples/scan/bracket-scan.csv examples/scan/bracket.stl --transform "
      "examples/scan/bracket-transform.csv --largest-mm 0.3 --faces-deg 30 --tolerance p95_um=60 -o "
      "results/deviation");
  add_scan_files(app, command->files);
  app->add_input_file("--transform", command->transform,
                      "Pose of the scan on the part: transform.csv of abbe register (default: as it stands)");
  add_number(app, "--largest-mm", Quantity::length, "mm", {0, 1e9}, command->largest_mm,
             "Points farther away are left out (default 0: all count)");
  add_number(app, "--lower-um", Quantity::length, "um", {-1e9, 1e9}, command->lower_mm,
             "With --upper-um: a band; reports the share of points within it");
  add_number(app, "--upper-um", Quantity::length, "um", {-1e9, 1e9}, command->upper_mm, "Upper end of the band");
  add_number(app, "--faces-deg", Quantity::angle, "deg", {0, 180}, command->crease,
             "Add statistics by face, where faces end at edges sharper than this angle (default 0: none)");
  app->add_flag("--faces", command->faces_of_file,
                "Add statistics by the faces of a STEP file, or by the objects, groups and materials of an OBJ file")
      ->excludes("--faces-deg");
  add_number(app, "--colour-um", Quantity::length, "um", {0, 1e9}, command->colour_mm,
             "Deviation shown in full colour (default: from the 98th percentile)");
  app->add_output_folder("-o,--output", command->options.output,
                         "Results folder to write: evaluation.json, deviation.csv, deviation.ply (coloured), plot.svg, "
                         "report.html (part in three dimensions, sections)");
  app->add_option("--tolerance", command->options.tolerances,
                  "Largest permitted amount of a figure, such as maximum_um=50; repeatable. Exit code 1 if "
                  "exceeded")
      ->allow_extra_args(false);
  app->add_flag("--json", command->options.json, "Print JSON for programs");
  app->callback([&line, command] { line.run = [command] { return run_deviate(*command); }; });
}

}  // namespace abbe
