#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "abbe/formats/input_error.h"
#include "abbe/formats/ply_file.h"
#include "abbe/formats/transform_file.h"
#include "abbe/geometry/closest_point.h"
#include "abbe/geometry/surface_faces.h"
#include "abbe/report/svg_plot.h"
#include "abbe/verify/surface_deviation.h"
#include "command.h"
#include "evaluate/evaluate.h"
#include "evaluate/number_option.h"
#include "exit_code.h"
#include "options.h"
#include "scan/deviation_colours.h"
#include "scan/scan_files.h"
#include "scan/surface_picture.h"

namespace abbe {
namespace {

struct DeviateCommand {
  ScanFiles files;
  EvaluationOptions options;
  std::string transform;
  double largest_mm = 0, lower_mm = 0, upper_mm = 0, colour_mm = 0, crease = 0;
  bool faces_of_file = false;
};

EvaluationFigure statistic_figure(const std::string& symbol, const std::string& name, const DeviationStatistics& all,
                                  double value) {
  EvaluationFigure result;
  result.symbol = symbol;
  result.name = name;
  if (all.sample.count > 0) {
    result.value = value;
  } else {
    result.missing = "no point counts";
  }
  return result;
}

std::vector<EvaluationFigure> figures_of(const DeviationStatistics& all) {
  std::vector<EvaluationFigure> figures{
      statistic_figure("mean", "mean", all, all.sample.mean),
      statistic_figure("std", "standard deviation about the mean (n - 1)", all, all.sample.deviation),
      statistic_figure("rms", "root mean square about zero", all, all.sample.rms),
      statistic_figure("rms_about_mean", "root mean square about the mean (n)", all, all.rms_about_mean),
      statistic_figure("minimum", "least", all, all.sample.minimum),
      statistic_figure("p5", "5th percentile", all, all.p5),
      statistic_figure("p25", "25th percentile", all, all.p25),
      statistic_figure("median", "median", all, all.sample.median),
      statistic_figure("p75", "75th percentile", all, all.p75),
      statistic_figure("p95", "95th percentile", all, all.sample.p95),
      statistic_figure("maximum", "largest", all, all.sample.maximum)};
  if (all.sample.count < 2) {
    figures[1].value.reset();
    figures[1].missing = "needs two points";
  }
  return figures;
}

/// Points of each class as a staircase; those beyond the last classes count in them.
EvaluationPlot distribution(const std::vector<double>& counted, double range_mm, const std::string& title) {
  constexpr std::size_t kClasses = 40;
  const Histogram classes = histogram(counted, -range_mm, range_mm, kClasses);
  XyPlot plot(title, "deviation in \xC2\xB5m", "share of the points in %");
  std::vector<PlotPoint> stairs;
  for (std::size_t i = 0; i < kClasses; ++i) {
    const double from = classes.from + classes.width * static_cast<double>(i);
    const double share = 100 * static_cast<double>(classes.counts[i]) / static_cast<double>(counted.size());
    stairs.push_back({1e3 * from, share});
    stairs.push_back({1e3 * (from + classes.width), share});
  }
  std::vector<double> x, low, high;
  for (const PlotPoint& corner : stairs) {
    x.push_back(corner.x);
    low.push_back(0);
    high.push_back(corner.y);
  }
  plot.include_y(0);
  plot.band(x, low, high, {PlotColour::first}, "");
  plot.line(stairs, {PlotColour::first, 1}, "");
  std::string caption;
  if (classes.below + classes.above > 0) {
    caption = fmt::format("{} points lie below and {} above this range.", classes.below, classes.above);
  }
  return {"plot", caption, plot.svg()};
}

/// @param names  of the faces, or empty
EvaluationTable faces_table(const SurfaceFaces& faces, const std::vector<std::string>& names,
                            const std::vector<DeviationStatistics>& regions) {
  EvaluationTable table;
  table.caption = "By faces of the part, in \xC2\xB5m; faces without points are left out";
  table.headers = {"face", "middle in mm", "area in mm\xC2\xB2", "points", "mean", "std", "rms", "least", "largest"};
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const SampleStatistics& s = regions[i].sample;
    if (s.count == 0) continue;
    const auto um = [](double value) { return fmt::format("{:.2f}", 1e3 * value); };
    table.rows.push_back({names.empty() ? fmt::format("{}", i + 1) : names[i], triple_text(faces.middle[i]),
                          fmt::format("{:.5g}", faces.area[i]), fmt::format("{}", s.count), um(s.mean), um(s.deviation),
                          um(s.rms), um(s.minimum), um(s.maximum)});
  }
  return table;
}

nlohmann::ordered_json faces_json(const SurfaceFaces& faces, const std::vector<std::string>& names,
                                  const std::vector<DeviationStatistics>& regions) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const SampleStatistics& s = regions[i].sample;
    nlohmann::ordered_json entry;
    entry["face"] = i + 1;
    if (!names.empty()) entry["name"] = names[i];
    entry["middle_mm"] = {faces.middle[i].x(), faces.middle[i].y(), faces.middle[i].z()};
    entry["area_mm2"] = faces.area[i];
    entry["points"] = s.count;
    if (s.count > 0) {
      entry["mean_um"] = 1e3 * s.mean;
      entry["rms_um"] = 1e3 * s.rms;
      entry["minimum_um"] = 1e3 * s.minimum;
      entry["maximum_um"] = 1e3 * s.maximum;
    }
    if (s.count > 1) entry["std_um"] = 1e3 * s.deviation;
    json.push_back(entry);
  }
  return json;
}

/// The points that count with what was found about them.
struct Counted {
  PointCloud cloud;
  std::vector<double> deviation_mm;
};
Counted counted_points(const Eigen::Matrix3Xd& points, const SurfaceDeviation& deviation) {
  Counted result;
  result.deviation_mm.reserve(deviation.all.sample.count);
  result.cloud.points.resize(3, static_cast<Eigen::Index>(deviation.all.sample.count));
  for (std::size_t i = 0; i < deviation.counted.size(); ++i) {
    if (deviation.counted[i] == 0) continue;
    result.cloud.points.col(static_cast<Eigen::Index>(result.deviation_mm.size())) =
        points.col(static_cast<Eigen::Index>(i));
    result.deviation_mm.push_back(deviation.deviation_mm[i]);
  }
  return result;
}

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

int run_deviate(DeviateCommand command) {
  const TransformFile pose = pose_of(command);
  const RigidTransform& part_from_scan = pose.transform;
  const bool has_band = command.lower_mm != 0 || command.upper_mm != 0;
  if (command.lower_mm > command.upper_mm) {
    throw InputError({.field = "--lower-um"}, "lies above --upper-um", "a band from lower to upper");
  }
  const PointCloudFile scan = command.files.read_scan();
  const MeshFile part = command.files.read_part();
  const Eigen::Matrix3Xd points = (part_from_scan.rotation * scan.cloud.points).colwise() + part_from_scan.translation;
  const ClosestPointFinder finder(part.mesh, command.files.threads);
  SurfaceFaces faces;
  SurfaceDeviationOptions options;
  options.largest_mm = command.largest_mm;
  if (has_band) options.tolerance = DeviationTolerance{command.lower_mm, command.upper_mm};
  const bool by_faces = command.crease > 0 || command.faces_of_file;
  if (command.faces_of_file && part.faces == 0) {
    throw InputError({command.files.part, 0, 0, ""}, "the file states no faces",
                     "a STEP file, or an OBJ file with o, g or usemtl; --faces-deg finds faces by their edges");
  }
  if (by_faces) {
    faces = command.faces_of_file ? stated_faces(part.mesh, part.face_of_triangle, part.faces)
                                  : surface_faces(part.mesh, command.crease, command.files.threads);
    options.region_of_triangle = faces.face_of_triangle;
    options.regions = faces.count();
  }
  const std::vector<SurfacePoint> closest = finder.closest(points, command.files.threads);
  const SurfaceDeviation deviation = surface_deviation(closest, options);
  const Counted counted = counted_points(points, deviation);
  const double range = command.colour_mm > 0 ? command.colour_mm : colour_range_mm(counted.deviation_mm);

  EvaluationReport report;
  report.kind = "deviation";
  report.title = fmt::format("Deviation of {} from {}", std::filesystem::path(command.files.scan).filename().string(),
                             std::filesystem::path(command.files.part).filename().string());
  report.standard = "signed distance to the closest point of the part, positive outside of the material";
  report.facts = facts_of(scan, part);
  report.facts.emplace_back("points that count", fmt::format("{}", deviation.all.sample.count));
  report.facts.emplace_back("left out", fmt::format("{} beyond the border of the surface, {} too far away",
                                                    deviation.beyond_border, deviation.too_far));
  if (has_band) {
    report.facts.emplace_back(
        fmt::format("between {:.6g} and {:.6g} um", 1e3 * command.lower_mm, 1e3 * command.upper_mm),
        fmt::format("{:.3f} % of the points", 100 * deviation.all.within));
    report.details["share_within"] = deviation.all.within;
  }
  report.details["points"] = scan.cloud.size();
  report.details["points_counted"] = deviation.all.sample.count;
  report.details["beyond_border"] = deviation.beyond_border;
  report.details["too_far"] = deviation.too_far;
  report.details["colour_range_um"] = 1e3 * range;
  report.figures = figures_of(deviation.all);
  if (by_faces) {
    const std::vector<std::string> names = command.faces_of_file ? part.face_names : std::vector<std::string>();
    report.tables.push_back(faces_table(faces, names, deviation.regions));
    report.details["faces"] = faces_json(faces, names, deviation.regions);
  }
  if (!counted.deviation_mm.empty()) {
    report.plots.push_back(distribution(counted.deviation_mm, range, "Distribution of the deviations"));
  }
  if (command.transform.empty()) {
    report.notes.emplace_back(
        "The scan was taken as it stands: no --transform, so it must be in the frame of the part.");
  }
  if (pose.status == "ambiguous" || pose.status == "undetermined") {
    report.notes.push_back(fmt::format(
        "The registration that wrote {} says {}: the scan fits in other poses as well, with other deviations.",
        command.transform, pose.status));
  }
  if (command.largest_mm == 0) {
    report.notes.emplace_back("No --largest-mm: stray points count with their whole distance.");
  }
  for (const std::string& note : part.notes) report.notes.push_back(command.files.part + ": " + note);
  if (!command.options.output.empty()) {
    command.options.files.emplace_back("deviation.csv", point_cloud_csv(counted.cloud, counted.deviation_mm));
    command.options.files.emplace_back("deviation.ply",
                                       ply_bytes({.points = counted.cloud.points,
                                                  .colours = deviation_colours(counted.deviation_mm, range),
                                                  .deviation = counted.deviation_mm}));
    report.page = deviation_page(part.mesh, closest, deviation, range, command.files.threads);
  }
  const int code = finish_evaluation(report, command.options);
  return deviation.all.sample.count == 0 ? kNegative : code;
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
  app->add_option("--transform", command->transform,
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
