#include "abbe/study/verification/verification_page.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "abbe/identify/distributions.h"
#include "abbe/report/evaluations/machine_json.h"
#include "abbe/report/report.h"
#include "abbe/report/words/volumetric_words.h"
#include "abbe/study/verification/verification_text.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr std::size_t kPlaces = 480;     // along a piece, as it is drawn
constexpr std::size_t kQuantiles = 120;  // of a distribution

/// Share of a length of three coordinates of equal standard deviation that lies below x of them.
double share_below(double x) { return 1 - chi_square_exceedance(x * x, 3); }

/// Quantiles that errors with the predicted uncertainties would have, as if the coordinates of a pose were alike.
std::vector<double> predicted_quantiles(const std::vector<double>& uncertainty, const std::vector<double>& shares) {
  std::vector<double> quantiles;
  const double largest = *std::max_element(uncertainty.begin(), uncertainty.end());
  for (const double share : shares) {
    double low = 0, high = 10 * largest;
    for (int step = 0; step < 50 && high > 0; ++step) {
      const double middle = (low + high) / 2;
      double sum = 0;
      for (const double u : uncertainty) sum += u > 0 ? share_below(middle * std::numbers::sqrt3 / u) : 1;
      (sum < share * static_cast<double>(uncertainty.size()) ? low : high) = middle;
    }
    quantiles.push_back((low + high) / 2);
  }
  return quantiles;
}

nlohmann::json in_um(const std::vector<double>& values) {
  nlohmann::json numbers = nlohmann::json::array();
  for (const double value : values) numbers.push_back(for_drawing(1e3 * value));
  return numbers;
}

nlohmann::json distribution(const CompensatedPoses& poses) {
  std::vector<double> shares, before, after;
  nlohmann::json percent = nlohmann::json::array();
  for (std::size_t i = 0; i <= kQuantiles; ++i) {
    shares.push_back(0.002 + 0.996 * static_cast<double>(i) / kQuantiles);
  }
  // Those that the page states are among them, so that its words agree with its tables.
  for (const double stated : {0.5, 0.95}) {
    const auto place = std::lower_bound(shares.begin(), shares.end(), stated);
    if (place == shares.end() || *place != stated) shares.insert(place, stated);
  }
  for (const double share : shares) {
    percent.push_back(for_drawing(100 * share));
    before.push_back(percentile(poses.before, share));
    after.push_back(percentile(poses.after, share));
  }
  nlohmann::json json = {{"percent", percent}, {"before_um", in_um(before)}, {"after_um", in_um(after)}};
  if (poses.uncertainty_statistics.maximum > 0) {
    json["predicted_um"] = in_um(predicted_quantiles(poses.uncertainty, shares));
  }
  return json;
}

/// A column of values at samples, at a place of the curve between two of them.
struct Between {
  Index first = 0;
  double part = 0;

  double of(const std::vector<double>& values) const {
    const auto at = static_cast<std::size_t>(first);
    return (1 - part) * values[at] + part * values[at + 1];
  }
  Vector3d of(const Eigen::Matrix3Xd& values) const {
    return (1 - part) * values.col(first) + part * values.col(first + 1);
  }
};

Between between(const std::vector<double>& along, double place) {
  const auto behind = std::upper_bound(along.begin() + 1, along.end() - 1, place);
  const Index first = behind - along.begin() - 1;
  const double from = along[static_cast<std::size_t>(first)], to = along[static_cast<std::size_t>(first) + 1];
  return {first, to > from ? std::clamp((place - from) / (to - from), 0.0, 1.0) : 0.0};
}

/// Across the axis of a cone, from above on an S: the two directions of the drawing.
void drawing_plane(const VerifiedPiece& piece, Vector3d& across, Vector3d& up) {
  Vector3d area = Vector3d::Zero();
  const std::vector<Ruling>& rulings = piece.piece.rulings;
  const Vector3d start = rulings.front().foot;
  for (std::size_t k = 1; k < rulings.size(); ++k) {
    area += (rulings[k - 1].foot - start).cross(rulings[k].foot - start);
  }
  const Vector3d normal = piece.is_cone ? area.normalized() : Vector3d::UnitZ();
  across = (Vector3d::UnitX() - normal.x() * normal).normalized();
  up = normal.cross(across);
}

nlohmann::json edge_data(const VerifiedPiece& piece, bool head) {
  const PieceRun &before = piece.before, &after = piece.after;
  Vector3d across, up;
  drawing_plane(piece, across, up);
  const double from = std::max(before.deviation.along.front(), after.deviation.along.front());
  const double to = std::min(before.deviation.along.back(), after.deviation.along.back());
  nlohmann::json json = {{"name", head ? "head" : "foot"}};
  nlohmann::json x = nlohmann::json::array(), y = x, out_x = x, out_y = x, s = x;
  std::vector<double> before_values, after_values;
  for (std::size_t i = 0; i <= kPlaces; ++i) {
    const double place = from + (to - from) * static_cast<double>(i) / kPlaces;
    const Between old = between(before.deviation.along, place), now = between(after.deviation.along, place);
    const Vector3d point = now.of(head ? after.deviation.head_point : after.deviation.foot_point);
    const Vector3d normal = now.of(head ? after.deviation.head_normal : after.deviation.foot_normal);
    const Eigen::Vector2d out = Eigen::Vector2d(across.dot(normal), up.dot(normal)).normalized();
    s.push_back(for_drawing(place));
    x.push_back(std::round(1e3 * across.dot(point)) / 1e3);
    y.push_back(std::round(1e3 * up.dot(point)) / 1e3);
    out_x.push_back(for_drawing(out.x()));
    out_y.push_back(for_drawing(out.y()));
    before_values.push_back(old.of(head ? before.aligned.head_left : before.aligned.foot_left));
    after_values.push_back(now.of(head ? after.aligned.head_left : after.aligned.foot_left));
  }
  json["s_mm"] = s;
  json["x_mm"] = x;
  json["y_mm"] = y;
  json["out_x"] = out_x;
  json["out_y"] = out_y;
  json["before_um"] = in_um(before_values);
  json["after_um"] = in_um(after_values);
  // Of all samples; those that are drawn may miss the extremes.
  json["range_before_um"] = 1e3 * (head ? before.aligned.head : before.aligned.foot).range();
  json["range_after_um"] = 1e3 * (head ? after.aligned.head : after.aligned.foot).range();
  return json;
}

nlohmann::json piece_rows(const VerifiedPiece& piece) {
  nlohmann::json rows = nlohmann::json::array();
  const auto add = [&rows](const std::string& name, double before, double after) {
    rows.push_back({{"name", name}, {"before_um", 1e3 * before}, {"after_um", 1e3 * after}});
  };
  const PieceRun &b = piece.before, &a = piece.after;
  if (b.foot.evaluated && b.head.evaluated && a.foot.evaluated && a.head.evaluated) {
    add("Roundness at the foot", b.foot.roundness, a.foot.roundness);
    add("Roundness at the head", b.head.roundness, a.head.roundness);
  }
  add("Flank at the foot, range, best fit", b.aligned.foot.range(), a.aligned.foot.range());
  add("Flank at the head, range, best fit", b.aligned.head.range(), a.aligned.head.range());
  add("Contour error, largest, best fit", b.aligned.contour.largest, a.aligned.contour.largest);
  add("Flank at the foot, largest, datum not probed", b.as_cut.foot.largest(), a.as_cut.foot.largest());
  add("Flank at the head, largest, datum not probed", b.as_cut.head.largest(), a.as_cut.head.largest());
  add("Contour error, largest, datum not probed", b.as_cut.contour.largest, a.as_cut.contour.largest);
  add("Contour error, mean, datum not probed", b.as_cut.contour.mean, a.as_cut.contour.mean);
  return rows;
}

nlohmann::json piece_data(const VerifiedPiece& piece) {
  nlohmann::json json = {{"name", piece.name}, {"closed", piece.is_cone}};
  json["description"] =
      fmt::format("{:.0f} mm cut with the flank of a tool of {:g} mm, {} and {} samples", piece.after.deviation.length,
                  2 * piece.piece.tool_radius, piece.before.deviation.rows.size(), piece.after.deviation.rows.size());
  if (piece.after.duration_s)
    json["description"] = json["description"].get<std::string>() + fmt::format(", {:.1f} s", *piece.after.duration_s);
  json["edges"] = {edge_data(piece, false), edge_data(piece, true)};
  json["figures"] = piece_rows(piece);
  return json;
}

std::string measured_with(const nlohmann::json& summary) {
  std::string text;
  if (!summary.is_object() || !summary.contains("setups") || !summary["setups"].is_array()) return text;
  for (const nlohmann::json& setup : summary["setups"]) {
    if (!setup.is_object()) continue;
    const std::string instrument = setup.contains("instrument") && setup["instrument"].is_string()
                                       ? setup["instrument"].get<std::string>()
                                       : "instrument";
    text += (text.empty() ? "" : ", ") + instrument;
    if (setup.contains("readings") && setup["readings"].is_number_unsigned()) {
      text += fmt::format(" ({} readings)", setup["readings"].get<std::uint64_t>());
    }
  }
  return text;
}

nlohmann::json facts(const Verification& result, const nlohmann::json& summary) {
  nlohmann::json list = nlohmann::json::array();
  const auto add = [&list](const char* name, const std::string& text) {
    if (!text.empty()) list.push_back({{"name", name}, {"text", text}});
  };
  add("Machine", result.machine.name);
  add("Chain", result.machine.chain());
  if (summary.is_object() && summary.contains("study") && summary["study"].is_string()) {
    add("Study", summary["study"].get<std::string>());
  }
  add("Measured with", measured_with(summary));
  if (!summary.is_object()) {
    add("Identified", fmt::format("{} parameters", result.parameters));
  }
  add("Unseen poses",
      ranges_text(result.machine, result.ranges) + (result.both_directions ? "; axes coming from either side" : ""));
  add("Data", "simulated, truth known");
  add("Seed of the poses", fmt::format("{}", result.seed));
  return list;
}

nlohmann::json notes(const Verification& result) {
  nlohmann::json list = nlohmann::json::array();
  list.push_back(
      "Before: commands as the nominal machine has them. After: commands corrected by the inverse kinematics with the "
      "identified errors; the machine with the true errors carries out both.");
  list.push_back(
      "Volumetric error: what is left at the functional point after the best fit of the workpiece datum over all "
      "poses, before and after alike.");
  if (!result.poses.uncertainty.empty()) {
    list.push_back(result.correlations_known
                       ? "Predicted uncertainty: from the covariance of the identified parameters, without what the "
                         "datum takes up. It covers the parameters of the model, not errors of other shapes."
                       : "Predicted uncertainty: from the standard uncertainties that the errors file states, as if "
                         "they were independent.");
  }
  if (result.partial.is_partial()) {
    list.push_back(fmt::format(
        "The prediction covers the {} of {} errors of the machine that are known; the others are not in it: {}.",
        result.partial.known, result.partial.all(), result.partial.missing_names()));
  }
  if (result.left_out().count() > 0) list.push_back(left_out_words(result.left_out()) + ".");
  if (!result.pieces.empty()) {
    list.push_back(
        "Test pieces: what the axes were commanded, sample by sample, is carried out by the machine with its true "
        "errors and the play of its axes; deviations along the normals of the surface, positive where material is "
        "left. Best fit: the rigid displacement of the workpiece that explains most is removed, as in a coordinate "
        "measurement. Datum not probed: where the program has the workpiece, with the displacement that an instrument "
        "on the table cannot see and that probing removes.");
  }
  return list;
}

}  // namespace

nlohmann::json verification_page_data(const Verification& result) {
  const CompensatedPoses& poses = result.poses;
  // What is no object, such as no text at all, says nothing.
  const nlohmann::json summary = nlohmann::json::parse(result.summary, nullptr, false);
  nlohmann::json data;
  data["format"] = "abbe-report/1";
  data["title"] = "Compensation of the " + result.machine.name + ", verified";
  data["subtitle"] = std::string(
                         "A simulated machine, whose errors are therefore known, carries out the same commands without "
                         "and with the compensation: what is left at poses that were not measured") +
                     (result.pieces.empty() ? "" : ", and on test pieces");
  data["evaluation"] = {{"kind", "verify"}, {"facts", facts(result, summary)}};
  data["summary"] = {{"verdict", verification_sentence(result)},
                     {"held_out", nlohmann::json(unseen_poses_json(poses))}};
  nlohmann::ordered_json volumetric;
  add_volumetric_figures(result.volumetric, volumetric);
  data["summary"].update(nlohmann::json(volumetric));
  if (summary.is_object()) {
    for (const char* const key : {"readings", "outliers", "parameters", "machine_parameters", "setup_parameters",
                                  "rank", "null_space", "normalised_residual_rms"}) {
      if (summary.contains(key) && summary[key].is_number()) data["summary"][key] = summary[key];
    }
  }
  nlohmann::json& verification = data["verification"];
  verification["distribution"] = distribution(poses);
  verification["poses"] = poses.after.size();
  verification["pieces"] = nlohmann::json::array();
  for (const VerifiedPiece& piece : result.pieces) verification["pieces"].push_back(piece_data(piece));
  for (const VerificationVerdict& verdict : result.verdicts) {
    verification["wanted"].push_back({{"text", verdict.text}, {"met", verdict.met}});
  }
  data["machine"] = nlohmann::json(report_machine(result.machine));
  data["assumptions"] = notes(result);
  return data;
}

std::string verification_page(const Verification& result) { return report_page(verification_page_data(result)); }

}  // namespace abbe
