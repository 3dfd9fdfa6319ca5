#include <fmt/format.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "abbe/formats/json_text.h"
#include "abbe/formats/results_folder.h"
#include "abbe/report/evaluation_data.h"
#include "abbe/report/report.h"
#include "exit_code.h"
#include "reproduce/reproduce.h"
#include "reproduce/yin_constants.h"
#include "reproduce/yin_results.h"

namespace abbe {
namespace {

/// The edge that the sections have found, as points in the frame of the workpiece.
std::string engraved_csv(const YinSections& sections) {
  const std::vector<YinPoint> curve = yin_curve();
  std::string text = "x_mm,y_mm,z_mm\n";
  for (std::size_t i = 0; i < sections.fits.size(); ++i) {
    if (sections.fits[i].status != EdgeStatus::ok) continue;
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
  folder.write("report.html", report.page.is_object() ? report_page(evaluation_data(report)) : evaluation_page(report));
  for (const EvaluationPlot& plot : report.plots) folder.write(plot.name + ".svg", plot.svg);
  folder.write("sections.csv", sections_csv(r.sections.sections));
  folder.write("axis_commands.csv", yin_commands_csv(r.commands));
  folder.write("engraved.csv", engraved_csv(r.sections));
  const YinScanFiles files = yin_scan_files(r.scans, "scans.csv");
  folder.write("scans.csv", files.points);
  folder.write("scanner.positioning.toml", files.positioning);
  folder.commit();
}

}  // namespace

int reproduce_yin(const ReproduceOptions& options) {
  if (!options.output.empty()) check_results_folder(options.output);
  const YinResults r = yin_results(yin::kSeed);
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
