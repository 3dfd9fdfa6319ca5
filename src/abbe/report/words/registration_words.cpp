#include "abbe/report/words/registration_words.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "abbe/formats/text/vector_json.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/report/words/geometry_facts.h"

namespace abbe {
namespace {

std::string words_of(const UndeterminedMotion& motion) {
  if (!motion.rotation) return fmt::format("shift along {}", triple_text(motion.direction));
  const std::string line =
      fmt::format("about the line along {} through {} mm", triple_text(motion.direction), triple_text(motion.point));
  if (motion.pitch_mm == 0) return "turn " + line;
  return fmt::format("screw {}, {:.6g} mm per turn", line, 2 * std::numbers::pi * motion.pitch_mm);
}

nlohmann::ordered_json json_of(const RigidTransform& transform) {
  nlohmann::ordered_json json;
  json["rotation"] = nlohmann::ordered_json::array();
  for (int row = 0; row < 3; ++row) json["rotation"].push_back(vector_json(transform.rotation.row(row).transpose()));
  json["translation_mm"] = vector_json(transform.translation);
  return json;
}

double standard_uncertainty(const FineRegistration& fine, int k) {
  return std::sqrt(std::max(0.0, fine.covariance(k, k)));
}

std::string pose_text(const RigidTransform& pose) {
  const Eigen::Vector3d turn = rotation_vector(pose.rotation);
  std::string text;
  for (int row = 0; row < 3; ++row) {
    text += fmt::format("  {:13.9f} {:13.9f} {:13.9f}   {:14.6f} mm\n", pose.rotation(row, 0), pose.rotation(row, 1),
                        pose.rotation(row, 2), pose.translation[row]);
  }
  if (turn.norm() > 0) {
    text += fmt::format("  (a turn of {:.6f} deg about {})\n", turn.norm() / kDegree, triple_text(turn.normalized()));
  }
  return text;
}

std::string covariance_text(const FineRegistration& fine) {
  static constexpr const char* kNames[] = {"A", "B", "C", "X", "Y", "Z"};
  std::string text = "correlations of turns (A, B, C about x, y, z) and shifts (X, Y, Z) at that point\n";
  for (int i = 0; i < 6; ++i) {
    text += fmt::format("  {}", kNames[i]);
    for (int k = 0; k < 6; ++k) {
      const double product = standard_uncertainty(fine, i) * standard_uncertainty(fine, k);
      text += product > 0 ? fmt::format(" {:7.3f}", fine.covariance(i, k) / product) : "       -";
    }
    text += "\n";
  }
  return text;
}

}  // namespace

std::string registration_words(const Registration& result) {
  switch (result.status) {
    case RegistrationStatus::ok:
      return "the pose is determined";
    case RegistrationStatus::too_few_points:
      return "too few points for a pose: at least six that are not all at one place";
    case RegistrationStatus::no_start:
      return "no pose brings the scan near the part: is it the same part, in the same unit, with normals to the same "
             "side?";
    case RegistrationStatus::not_converged:
      return "not converged: the pose below is where the iteration stopped";
    case RegistrationStatus::undetermined:
      return "undetermined: motions of the scan along the surface change nothing, so the pose below is one of many";
    case RegistrationStatus::ambiguous:
      return fmt::format("ambiguous: {} fits as well, and the scan does not tell which is right",
                         result.alternatives.size() == 1
                             ? "another pose"
                             : fmt::format("each of {} other poses", result.alternatives.size()));
    case RegistrationStatus::not_run:
      break;
  }
  return "not run";
}

bool has_pose(const Registration& result) {
  return result.status != RegistrationStatus::not_run && result.status != RegistrationStatus::too_few_points &&
         result.status != RegistrationStatus::no_start;
}

std::vector<std::string> undetermined_words(const FineRegistration& fine) {
  std::vector<std::string> words;
  for (const UndeterminedMotion& motion : fine.undetermined) words.push_back(words_of(motion));
  return words;
}

nlohmann::ordered_json registration_json(const Registration& result) {
  const FineRegistration& fine = result.fine;
  nlohmann::ordered_json json;
  json["status"] = registration_status_name(result.status);
  json["words"] = registration_words(result);
  if (!has_pose(result)) return json;
  json["part_from_scan"] = json_of(fine.mesh_from_scan);
  json["iterations"] = fine.iterations;
  json["points_counted"] = fine.used;
  json["points_beyond_border"] = fine.beyond_border;
  json["inlier_share"] = result.inlier_share;
  json["robust_standard_deviation_mm"] = fine.scale_mm;
  json["weighted_rms_mm"] = fine.rms_mm;
  nlohmann::ordered_json uncertainty;
  uncertainty["reference_mm"] = vector_json(fine.reference);
  uncertainty["turn_rad"] = vector_json(
      Eigen::Vector3d(standard_uncertainty(fine, 0), standard_uncertainty(fine, 1), standard_uncertainty(fine, 2)));
  uncertainty["shift_mm"] = vector_json(
      Eigen::Vector3d(standard_uncertainty(fine, 3), standard_uncertainty(fine, 4), standard_uncertainty(fine, 5)));
  for (int i = 0; i < 6; ++i) {
    nlohmann::ordered_json row = nlohmann::ordered_json::array();
    for (int k = 0; k < 6; ++k) row.push_back(fine.covariance(i, k));
    uncertainty["covariance_rad_mm"].push_back(row);
  }
  json["standard_uncertainty"] = uncertainty;
  json["undetermined"] = nlohmann::ordered_json::array();
  for (const UndeterminedMotion& motion : fine.undetermined) {
    nlohmann::ordered_json entry;
    entry["words"] = words_of(motion);
    entry["kind"] = motion.rotation ? "turn" : "shift";
    entry["direction"] = vector_json(motion.direction);
    if (motion.rotation) {
      entry["point_mm"] = vector_json(motion.point);
      entry["pitch_mm_per_rad"] = motion.pitch_mm;
    }
    json["undetermined"].push_back(entry);
  }
  json["alternatives"] = nlohmann::ordered_json::array();
  for (const AlternativePose& other : result.alternatives) {
    json["alternatives"].push_back({{"part_from_scan", json_of(other.mesh_from_scan)},
                                    {"loss_difference", other.cost_difference},
                                    {"loss_difference_uncertainty", other.cost_difference_uncertainty}});
  }
  return json;
}

std::string registration_text(const Registration& result, Eigen::Index points, bool covariance) {
  const FineRegistration& fine = result.fine;
  std::string text = registration_words(result) + "\n";
  if (!has_pose(result)) return text;
  text += "\npart from scan: rotation, translation\n" + pose_text(fine.mesh_from_scan);
  text += fmt::format("\n{:.1f} % of the points lie on the surface, {} of {} count, {} lie beyond its border\n",
                      100 * result.inlier_share, fine.used, points, fine.beyond_border);
  text += fmt::format("robust standard deviation of the distances {:.3f} um\n", 1e3 * fine.scale_mm);
  text +=
      fmt::format("standard uncertainty at {} mm, the middle of the scan\n  shift x, y, z  {:.4f} {:.4f} {:.4f} um\n",
                  triple_text(fine.reference), 1e3 * standard_uncertainty(fine, 3), 1e3 * standard_uncertainty(fine, 4),
                  1e3 * standard_uncertainty(fine, 5));
  text += fmt::format("  turn about x, y, z  {:.4f} {:.4f} {:.4f} urad\n", 1e6 * standard_uncertainty(fine, 0),
                      1e6 * standard_uncertainty(fine, 1), 1e6 * standard_uncertainty(fine, 2));
  if (covariance) text += covariance_text(fine);
  if (!fine.undetermined.empty()) text += "\nnot determined by this scan (not in the uncertainties)\n";
  for (const UndeterminedMotion& motion : fine.undetermined) text += "  " + words_of(motion) + "\n";
  for (std::size_t i = 0; i < result.alternatives.size(); ++i) {
    text += fmt::format("\nalternative {}\n{}", i + 1, pose_text(result.alternatives[i].mesh_from_scan));
  }
  return text;
}

}  // namespace abbe
