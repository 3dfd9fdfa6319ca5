#include "abbe/study/scans/scanned_points.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/words/state_words.h"

namespace abbe {

ProbeBeam probe_beam(const Machine& machine, const Eigen::Vector3d& zero,
                     const std::optional<Eigen::Vector3d>& direction) {
  if (!zero.allFinite()) {
    throw InputError({.field = "--beam-zero-mm"}, "not a place", "three finite numbers in mm");
  }
  ProbeBeam beam;
  beam.zero = zero;
  beam.direction = -machine.tool_direction;
  if (direction) {
    const double length = direction->norm();
    if (!(length > 1e-12) || !std::isfinite(length)) {
      throw InputError({.field = "--beam"}, "the direction has no length", "three numbers, not all of them zero");
    }
    beam.direction = *direction / length;
  }
  return beam;
}

LeftOutPoses ScannedPoints::left_out() const {
  return {.all = summary.readings,
          .not_covered = summary.not_covered,
          .what = "readings",
          .extrapolated = at_state.outside};
}

ScannedPoints write_scanned_points(const ScannedPointsRequest& request, const JobOptions& options) {
  refuse_states(request.machine, request.errors, "a scan", UsableStates::of_commands);
  ScanOptions scan = request.scan;
  if (request.indication_range) {
    const auto [lowest, highest] = *request.indication_range;
    if (!(lowest < highest)) {
      throw InputError({.field = "--indication-range-mm"}, "the range is empty", "the lower end first");
    }
    scan.lowest_indication = lowest;
    scan.highest_indication = highest;
  }
  stop_if_asked(options.stop);
  scan.progress = stoppable_progress(options);
  ScannedPoints result;
  result.machine = request.machine.name;
  result.errors_file = request.errors_file;
  result.at_state = request.at_state;
  result.output = request.output;
  result.summary = scan_points(
      request.readings, request.machine,
      PointScan(request.machine, request.errors, probe_beam(request.machine, request.beam_zero, request.beam)),
      request.output, scan);
  if (result.summary.points == 0) {
    result.refused = result.summary.not_covered == 0 ? "no reading lies within the probe's range"
                                                     : left_out_words(result.left_out());
  }
  return result;
}

std::string scanned_points_text(const ScannedPoints& result) {
  const ScanSummary& summary = result.summary;
  std::string text =
      fmt::format("{} readings on {}, {}\n{} points written to {}\n", summary.readings, result.machine,
                  result.errors_file.empty() ? "machine without errors" : "errors of " + result.errors_file,
                  summary.points, result.output);
  text += state_line(result.at_state);
  if (summary.points > 0) {
    text +=
        fmt::format("  x {:.4f} to {:.4f} mm, y {:.4f} to {:.4f} mm, z {:.4f} to {:.4f} mm\n", summary.lowest[0],
                    summary.highest[0], summary.lowest[1], summary.highest[1], summary.lowest[2], summary.highest[2]);
  }
  if (summary.out_of_range > 0) {
    text += fmt::format("  {} readings outside the probe's range are left out\n", summary.out_of_range);
  }
  return text;
}

nlohmann::ordered_json scanned_points_json(const ScannedPoints& result) {
  const ScanSummary& summary = result.summary;
  nlohmann::ordered_json json;
  json["machine"] = result.machine;
  json["errors"] = result.errors_file;
  add_state(result.at_state, json);
  json["readings"] = summary.readings;
  json["points"] = summary.points;
  json["outside_indication_range"] = summary.out_of_range;
  json["outside_known_errors"] = summary.not_covered;
  if (summary.points > 0) {
    json["lowest_mm"] = {summary.lowest[0], summary.lowest[1], summary.lowest[2]};
    json["highest_mm"] = {summary.highest[0], summary.highest[1], summary.highest[2]};
  }
  json["output"] = result.output;
  return json;
}

}  // namespace abbe
