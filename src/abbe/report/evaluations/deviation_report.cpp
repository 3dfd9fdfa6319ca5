#include "abbe/report/evaluations/deviation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/report/drawings/deviation_colours.h"
#include "abbe/report/drawings/svg_plot.h"
#include "abbe/report/words/geometry_facts.h"

namespace abbe {
namespace {

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
EvaluationPlot distribution(const Histogram& classes, std::size_t counted, const std::string& title) {
  XyPlot plot(title, "deviation in \xC2\xB5m", "share of the points in %");
  std::vector<PlotPoint> stairs;
  for (std::size_t i = 0; i < classes.counts.size(); ++i) {
    const double from = classes.from + classes.width * static_cast<double>(i);
    const double share = 100 * static_cast<double>(classes.counts[i]) / static_cast<double>(counted);
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
  return {"plot", caption, plot.picture()};
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

void add_notes(const DeviationRequest& request, const MeshFile& part, EvaluationReport& report) {
  if (request.transform.empty()) {
    report.notes.emplace_back(
        "The scan was taken as it stands: no --transform, so it must be in the frame of the part.");
  }
  if (request.status == "ambiguous" || request.status == "undetermined") {
    report.notes.push_back(fmt::format(
        "The registration that wrote {} says {}: the scan fits in other poses as well, with other deviations.",
        request.transform, request.status));
  }
  if (request.largest_mm == 0) {
    report.notes.emplace_back("No --largest-mm: stray points count with their whole distance.");
  }
  for (const std::string& note : part.notes) report.notes.push_back(request.part + ": " + note);
}

/// All but the distribution and the notes.
/// @param points  of the scan
EvaluationReport report_of_figures(const DeviationRequest& request, std::size_t points,
                                   std::vector<std::pair<std::string, std::string>> facts,
                                   const SurfaceDeviation& deviation, const SurfaceFaces& faces, double range) {
  const auto name = [](const std::string& file) { return std::filesystem::path(file).filename().string(); };
  EvaluationReport report;
  report.kind = "deviation";
  report.title = fmt::format("Deviation of {} from {}", name(request.scan), name(request.part));
  report.standard = "signed distance to the closest point of the part, positive outside of the material";
  report.facts = std::move(facts);
  report.facts.emplace_back("points that count", fmt::format("{}", deviation.all.sample.count));
  report.facts.emplace_back("left out", fmt::format("{} beyond the border of the surface, {} too far away",
                                                    deviation.beyond_border, deviation.too_far));
  if (request.tolerance) {
    report.facts.emplace_back(fmt::format("between {:.6g} and {:.6g} um", 1e3 * request.tolerance->lower_mm,
                                          1e3 * request.tolerance->upper_mm),
                              fmt::format("{:.3f} % of the points", 100 * deviation.all.within));
    report.details["share_within"] = deviation.all.within;
  }
  report.details["points"] = points;
  report.details["points_counted"] = deviation.all.sample.count;
  report.details["beyond_border"] = deviation.beyond_border;
  report.details["too_far"] = deviation.too_far;
  report.details["colour_range_um"] = 1e3 * range;
  report.figures = figures_of(deviation.all);
  if (faces.count() > 0) {
    report.tables.push_back(faces_table(faces, request.face_names, deviation.regions));
    report.details["faces"] = faces_json(faces, request.face_names, deviation.regions);
  }
  return report;
}

/// Notes and details of what a histogram and a choice of the points leave open.
void add_streamed(const StreamedScan& scan, EvaluationReport& report) {
  if (scan.least == nullptr) return;
  nlohmann::ordered_json bounds;
  double largest = 0;
  for (const auto& [symbol, fraction] : {std::pair{"p5", 0.05}, std::pair{"p25", 0.25}, std::pair{"median", 0.5},
                                         std::pair{"p75", 0.75}, std::pair{"p95", 0.95}}) {
    const double bound = scan.histogram->percentile(fraction).bound;
    bounds[symbol] = 1e3 * bound;
    largest = std::max(largest, bound);
  }
  const auto place = [&](const char* key, const SampledPoint& point) {
    report.details[key] = {{"point", point.number + 1},
                           {"at_mm", {point.point.x(), point.point.y(), point.point.z()}},
                           {"deviation_um", 1e3 * point.deviation_mm}};
  };
  report.details["percentile_error_at_most_um"] = bounds;
  place("least", *scan.least);
  place("largest", *scan.largest);
  report.details["points_shown"] = scan.shown;
  report.facts.emplace_back("least",
                            fmt::format("point {} at {} mm", scan.least->number + 1, triple_text(scan.least->point)));
  report.facts.emplace_back(
      "largest", fmt::format("point {} at {} mm", scan.largest->number + 1, triple_text(scan.largest->point)));
  report.notes.push_back(fmt::format(
      "The scan was read in blocks. Percentiles are from a histogram and off by at most {:.2g} \xC2\xB5m; all other "
      "figures are those of every point.",
      1e3 * largest));
  report.notes.push_back(
      fmt::format("The picture, deviation.csv and deviation.ply show {} of {} points that count: a random sample, and "
                  "the {} at either end.",
                  scan.shown, scan.histogram->count(), PointSample::kExtremes));
}

constexpr std::size_t kDistributionClasses = 40;

}  // namespace

double deviation_colour_range(const DeviationRequest& request, const ScanComparison& compared) {
  return request.colour_mm > 0 ? request.colour_mm : colour_range_mm(compared.counted_mm);
}

EvaluationReport deviation_report(const DeviationRequest& request, const PointCloudFile& scan, const MeshFile& part,
                                  const ScanComparison& compared) {
  const double range = deviation_colour_range(request, compared);
  EvaluationReport report = report_of_figures(request, static_cast<std::size_t>(scan.cloud.size()),
                                              facts_of(scan, part), compared.deviation, compared.faces, range);
  if (!compared.counted_mm.empty()) {
    report.plots.push_back(distribution(histogram(compared.counted_mm, -range, range, kDistributionClasses),
                                        compared.counted_mm.size(), "Distribution of the deviations"));
  }
  add_notes(request, part, report);
  return report;
}

EvaluationReport deviation_report(const DeviationRequest& request, const StreamedScan& scan, const MeshFile& part,
                                  const ScanComparison& compared, double range_mm) {
  auto facts = facts_of(*scan.file, part);
  facts.front().second = fmt::format("{} points, {}", scan.points, cloud_words(*scan.file));
  EvaluationReport report =
      report_of_figures(request, scan.points, std::move(facts), compared.deviation, compared.faces, range_mm);
  if (!compared.counted_mm.empty()) {
    const Histogram classes = scan.histogram != nullptr
                                  ? scan.histogram->classes(-range_mm, range_mm, kDistributionClasses)
                                  : histogram(compared.counted_mm, -range_mm, range_mm, kDistributionClasses);
    report.plots.push_back(
        distribution(classes, compared.deviation.all.sample.count, "Distribution of the deviations"));
  }
  add_notes(request, part, report);
  add_streamed(scan, report);
  return report;
}

}  // namespace abbe
