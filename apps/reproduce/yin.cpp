#include <fmt/format.h>

#include <Eigen/Geometry>

#include "abbe/formats/json_text.h"
#include "abbe/formats/results_folder.h"
#include "command.h"
#include "reproduce/reproduce.h"
#include "reproduce/yin_results.h"

namespace abbe {
namespace {

constexpr std::uint64_t kSeed = 2021;
constexpr double kAgreement = 1e-9;  // mm

YinResults compute() {
  YinResults r;
  r.table_moves = yin_steps(LinkageConvention::table_moves);
  r.head_moves = yin_steps(LinkageConvention::head_moves);
  r.joint = yin_joint_fit(r.table_moves.found);
  r.positioning = yin_positioning();
  r.agrees = r.table_moves.largest_difference < kAgreement && r.head_moves.largest_difference < kAgreement &&
             r.positioning.largest_difference < kAgreement;
  r.scans = yin_simulated_scans(kSeed);
  r.located = yin_locate(r.scans);
  BudgetOptions options;
  options.seed = kSeed;
  r.contour = yin_contour(r.positioning, options);
  r.sections = yin_sections(r.positioning, kSeed);
  return r;
}

/// The edge that the sections have found, as points in the frame of the workpiece.
std::string engraved_csv(const YinSections& sections) {
  const std::vector<YinPoint> curve = yin_curve();
  std::string text = "x_mm,y_mm,z_mm\n";
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const YinPoint& at = curve[i];
    const Eigen::Vector3d p = at.point + sections.fits[i].corner.x() * at.normal.cross(at.tangent);
    text += fmt::format("{:.6f},{:.6f},{:.6f}\n", p.x(), p.y(), p.z());
  }
  return text;
}

void write_folder(const YinResults& r, const std::filesystem::path& output) {
  const EvaluationReport report = yin_report(r);
  ResultsFolder folder(output);
  folder.write("summary.json", json_text(yin_json(r)));
  folder.write("report.html", evaluation_page(report));
  for (const EvaluationPlot& plot : report.plots) folder.write(plot.name + ".svg", plot.svg);
  folder.write("sections.csv", sections_csv(r.sections.sections));
  folder.write("engraved.csv", engraved_csv(r.sections));
  folder.write("scans.csv", target_points_csv(r.scans.targets));
  folder.write("scanner.positioning.toml", yin_positioning_text(r.scans, "scans.csv"));
  folder.commit();
}

}  // namespace

int reproduce_yin(const ReproduceOptions& options) {
  if (!options.output.empty()) check_results_folder(options.output);
  const YinResults r = compute();
  if (!options.output.empty()) write_folder(r, options.output);
  if (options.json) {
    fmt::print("{}", json_text(yin_json(r)));
  } else {
    print_yin(r);
    if (!options.output.empty()) fmt::print("results in {}\n", options.output.string());
  }
  return r.agrees ? kDone : kNegative;
}

}  // namespace abbe
