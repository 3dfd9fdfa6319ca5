#include "abbe/study/verification/verification_text.h"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "abbe/report/evaluations/statistics_json.h"
#include "abbe/report/words/state_words.h"
#include "abbe/report/words/volumetric_words.h"
#include "abbe/study/identification/not_identified.h"
#include "abbe/study/report/summary.h"
#include "abbe/study/report/unseen.h"

namespace abbe {
namespace {

nlohmann::ordered_json flank_json(const FlankFigures& flank) {
  return {{"lowest_um", 1e3 * flank.lowest},
          {"highest_um", 1e3 * flank.highest},
          {"largest_um", 1e3 * flank.largest()},
          {"range_um", 1e3 * flank.range()},
          {"rms_um", 1e3 * flank.rms}};
}

nlohmann::ordered_json figures_json(const PieceFigures& figures) {
  return {{"foot", flank_json(figures.foot)},
          {"head", flank_json(figures.head)},
          {"contour_mean_um", 1e3 * figures.contour.mean},
          {"contour_largest_um", 1e3 * figures.contour.largest}};
}

nlohmann::ordered_json roundness_json(const Roundness& circle) {
  if (!circle.evaluated) return nullptr;
  return {{"roundness_um", 1e3 * circle.roundness},
          {"centre_um", {1e3 * circle.centre.x(), 1e3 * circle.centre.y()}},
          {"radius_deviation_um", 1e3 * circle.radius_deviation}};
}

nlohmann::ordered_json run_json(const PieceRun& run, bool is_cone) {
  nlohmann::ordered_json json;
  json["file"] = run.file;
  json["samples"] = run.samples;
  json["samples_cutting"] = run.deviation.rows.size();
  json["cut_mm"] = run.deviation.reached;
  if (run.duration_s) json["cut_s"] = *run.duration_s;
  json["as_cut"] = figures_json(run.as_cut);
  json["best_fit"] = figures_json(run.aligned);
  if (is_cone) {
    json["foot_circle"] = roundness_json(run.foot);
    json["head_circle"] = roundness_json(run.head);
  }
  return json;
}

void add_pair(std::string& text, const std::string& name, double before, double after) {
  text += fmt::format("  {:<46} {:>9.2f} {:>9.2f} um", name, 1e3 * before, 1e3 * after);
  if (after > 0) text += fmt::format("  {:>6.1f} times", before / after);
  text += "\n";
}

void add_piece(std::string& text, const VerifiedPiece& piece) {
  const auto& [b, a] = std::pair<const PieceRun&, const PieceRun&>(piece.before, piece.after);
  text += fmt::format("\n{}: {:.1f} mm cut, {} and {} samples\n", piece.name, a.deviation.reached,
                      b.deviation.rows.size(), a.deviation.rows.size());
  text += fmt::format("  {:<46} {:>9} {:>9}\n", "", "before", "after");
  if (piece.is_cone && b.foot.evaluated && a.foot.evaluated && b.head.evaluated && a.head.evaluated) {
    add_pair(text, "roundness at the foot", b.foot.roundness, a.foot.roundness);
    add_pair(text, "roundness at the head", b.head.roundness, a.head.roundness);
  }
  const auto add_figures = [&text](const std::string& how, const PieceFigures& before, const PieceFigures& after) {
    add_pair(text, "flank at the foot, range, " + how, before.foot.range(), after.foot.range());
    add_pair(text, "flank at the foot, largest, " + how, before.foot.largest(), after.foot.largest());
    add_pair(text, "flank at the head, range, " + how, before.head.range(), after.head.range());
    add_pair(text, "flank at the head, largest, " + how, before.head.largest(), after.head.largest());
    add_pair(text, "contour error, largest, " + how, before.contour.largest, after.contour.largest);
    add_pair(text, "contour error, mean, " + how, before.contour.mean, after.contour.mean);
  };
  add_figures("best fit", b.aligned, a.aligned);
  add_figures("as cut", b.as_cut, a.as_cut);
}

}  // namespace

std::string verification_sentence(const Verification& result) {
  const CompensatedPoses& poses = result.poses;
  std::string text = fmt::format(
      "True volumetric error at {} random poses (seed {}): mean {:.3g} um before, {:.2g} um after compensation, {:.3g} "
      "times smaller",
      poses.after.size(), result.seed, 1e3 * poses.before_statistics.mean, 1e3 * poses.after_statistics.mean,
      poses.reduction());
  if (poses.uncertainty_ratio() > 0) {
    text += fmt::format("; {:.2f} times what its uncertainty predicts", poses.uncertainty_ratio());
  }
  return text + ".";
}

nlohmann::ordered_json unseen_poses_json(const CompensatedPoses& poses) {
  nlohmann::ordered_json json;
  json["poses"] = poses.after.size();
  json["quantity"] = quantity_name(UnseenQuantity::volumetric_error);
  json["position_before_um"] = statistics_um(poses.before_statistics);
  json["position_after_um"] = statistics_um(poses.after_statistics);
  json["reduction"] = poses.reduction();
  json["remaining_percent"] =
      poses.before_statistics.mean > 0 ? 100 * poses.after_statistics.mean / poses.before_statistics.mean : 0;
  json["orientation_before_urad"] = statistics_urad(poses.direction_before_statistics);
  json["orientation_after_urad"] = statistics_urad(poses.direction_after_statistics);
  if (poses.uncertainty_statistics.maximum > 0) {
    std::vector<double> expanded = poses.uncertainty;
    for (double& value : expanded) value *= 2;
    json["predicted_expanded_uncertainty_um"] = statistics_um(sample_statistics(expanded));
    json["coverage_percent"] = 100 * poses.coverage;
    json["uncertainty_ratio"] = poses.uncertainty_ratio();
  }
  return json;
}

std::string verification_text(const Verification& result) {
  std::string text;
  const CompensatedPoses& poses = result.poses;
  text += fmt::format("{}\n\n", verification_sentence(result));
  text += fmt::format("{}: {} random poses (seed {}) over {}{}\n", result.machine.name, poses.after.size(), result.seed,
                      ranges_text(result.machine, result.ranges),
                      result.both_directions ? ", axes coming from either side" : "");
  text += state_line(result.partial.at_state);
  const auto row = [&text](const char* name, const SampleStatistics& s, double unit, const char* unit_name) {
    text += fmt::format("  {:<46} mean {:.3f}  rms {:.3f}  95 % {:.3f}  max {:.3f} {}\n", name, unit * s.mean,
                        unit * s.rms, unit * s.p95, unit * s.maximum, unit_name);
  };
  row("true volumetric error, before", poses.before_statistics, 1e3, "um");
  row("true volumetric error, after compensation", poses.after_statistics, 1e3, "um");
  if (!poses.uncertainty.empty()) {
    row("predicted standard uncertainty", poses.uncertainty_statistics, 1e3, "um");
    text += fmt::format("  {:<46} {:.1f} %\n", "coordinates within twice their uncertainty", 100 * poses.coverage);
  }
  row("direction of the tool, before", poses.direction_before_statistics, 1e6, "urad");
  row("direction of the tool, after", poses.direction_after_statistics, 1e6, "urad");
  if (result.partial.is_partial()) {
    text += fmt::format(
        "  caution: the prediction covers the {} of {} errors of the machine that are known; the others are not in it: "
        "{}\n",
        result.partial.known, result.partial.all(), result.partial.missing_names());
  }
  if (result.left_out().count() > 0) text += fmt::format("  {}\n", left_out_words(result.left_out()));
  text += "\n";
  text += volumetric_text(result.volumetric);
  for (const VerifiedPiece& piece : result.pieces) add_piece(text, piece);
  if (!result.verdicts.empty()) text += "\n";
  for (const VerificationVerdict& verdict : result.verdicts) text += verdict.text + "\n";
  return text;
}

nlohmann::ordered_json verification_json(const Verification& result) {
  const CompensatedPoses& poses = result.poses;
  nlohmann::ordered_json json;
  json["format"] = "abbe-verify/1";
  json["machine"] = result.machine.name;
  json["verdict"] = verification_sentence(result);
  nlohmann::ordered_json unseen = unseen_poses_json(poses);
  if (result.partial.is_partial()) unseen["uncertainty_covers"] = kIdentifiedErrorsOnly;
  unseen["seed"] = result.seed;
  unseen["ranges"] = ranges_text(result.machine, result.ranges);
  unseen["both_directions"] = result.both_directions;
  unseen["outside_travel"] = poses.outside_travel;
  unseen["outside_range"] = poses.not_covered;
  unseen["not_reached"] = poses.not_reached;
  json["unseen_poses"] = unseen;
  add_state(result.partial.at_state, json);
  add_volumetric_figures(result.volumetric, json);
  if (result.partial.is_partial()) {
    json["errors_known"] = result.partial.known;
    json["errors_of_machine"] = result.partial.all();
    json["not_known"] = result.partial.missing;
  }
  json["test_pieces"] = nlohmann::ordered_json::array();
  for (const VerifiedPiece& piece : result.pieces) {
    json["test_pieces"].push_back({{"name", piece.is_cone ? "cone-frustum" : "s-shape"},
                                   {"length_mm", piece.after.deviation.length},
                                   {"before", run_json(piece.before, piece.is_cone)},
                                   {"after", run_json(piece.after, piece.is_cone)}});
  }
  json["wanted"] = nlohmann::ordered_json::array();
  for (const VerificationVerdict& verdict : result.verdicts) {
    json["wanted"].push_back({{"text", verdict.text}, {"met", verdict.met}});
  }
  return json;
}

}  // namespace abbe
