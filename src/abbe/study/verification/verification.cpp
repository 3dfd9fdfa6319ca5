#include "abbe/study/verification/verification.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/formats/files/results_files.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/study/random_poses.h"
#include "abbe/study/scans/test_piece_sizes.h"
#include "abbe/study/verification/verification_condition.h"

namespace abbe {
namespace {

/// So fine that the lines between the points of a piece are not seen in the figures, mm.
constexpr double kPieceTolerance = 1e-5;

PoseList poses_to_verify(const VerificationRequest& request, Verification& result) {
  const ErrorSet &identified = request.identified.errors, &truth = request.truth.errors;
  result.ranges = unseen_ranges(request.machine, {&identified, &truth});
  for (std::size_t axis = 0; axis < request.ranges.size(); ++axis) {
    if (request.ranges[axis]) result.ranges.at(axis) = *request.ranges[axis];
  }
  result.both_directions = !truth.reversals.empty() || !identified.reversals.empty();
  try {
    return random_unseen_poses(request.machine, result.ranges, request.poses, request.seed, result.both_directions);
  } catch (const std::invalid_argument& error) {
    throw InputError({.field = "--range"}, error.what(), "ranges within the travel of their axes");
  }
}

/// The seed of the random poses at which these results were validated, so that both commands take the same ones.
std::optional<std::uint64_t> seed_of_summary(const std::string& text) {
  const nlohmann::json summary = nlohmann::json::parse(text, nullptr, false);
  if (!summary.is_object() || !summary.contains("seed") || !summary["seed"].is_number_unsigned()) return {};
  return unseen_seed(summary["seed"].get<std::uint64_t>());
}

[[noreturn]] void refuse(const PieceTrace& traced, const std::string& piece, const PieceDeviation& deviation,
                         double reach) {
  InputError::Place place{.file = traced.file, .line = traced.trace.lines.at(deviation.row)};
  const std::string sizes = "a trace of the program of this piece, with its sizes and centre as in abbe test-piece";
  switch (deviation.status) {
    case PieceTraceStatus::never_begins:
      throw InputError(place,
                       fmt::format("the tool never begins to cut the {}: here it is nearest to the first point, {:.4g} "
                                   "mm away",
                                   piece, deviation.distance),
                       sizes);
    case PieceTraceStatus::leaves_piece:
      throw InputError(place,
                       fmt::format("the tool is {:.4g} mm beside the {} after {:.1f} of {:.1f} mm", deviation.distance,
                                   piece, deviation.reached, deviation.length),
                       fmt::format("{}; or --reach-mm above {:g}", sizes, reach));
    default:
      throw InputError(
          place,
          fmt::format("the trace ends after {:.1f} of {:.1f} mm of the {}", deviation.reached, deviation.length, piece),
          "a trace up to the end of the cut");
  }
}

PieceRun carry_out(const VerificationRequest& request, const std::string& name, const TestPiece& piece,
                   const ConeFrustum* frustum, const PieceTrace& traced) {
  PieceRun run;
  run.file = traced.file;
  const TraceFile& trace = traced.trace;
  const ErrorSet& truth = request.truth.errors;
  run.samples = trace.commands.count();
  const ToolPlaces tool = actual_tool(request.machine, truth, positions_with_play(truth, trace.commands));
  run.deviation = test_piece_deviation(piece, tool, request.reach_mm);
  if (run.deviation.status != PieceTraceStatus::done) refuse(traced, name, run.deviation, request.reach_mm);
  for (const std::size_t row : run.deviation.rows) {
    if (tool.covered[row] != 0) continue;
    throw InputError({.file = traced.file, .line = trace.lines.at(row)},
                     "an axis is outside the range in which its true errors are known",
                     fmt::format("errors known there ({})", request.truth_file));
  }
  if (!trace.time_s.empty()) {
    run.duration_s = trace.time_s[run.deviation.rows.back()] - trace.time_s[run.deviation.rows.front()];
  }
  run.as_cut = piece_figures(run.deviation, false);
  run.aligned = piece_figures(run.deviation, true);
  if (frustum != nullptr) {
    run.foot = cone_roundness(*frustum, run.deviation, false);
    run.head = cone_roundness(*frustum, run.deviation, true);
  }
  return run;
}

VerifiedPiece verify_piece(const VerificationRequest& request, const PieceToVerify& asked) {
  VerifiedPiece piece;
  PieceToVerify fine = asked;
  const auto* const cone = std::get_if<ConeFrustum>(&fine.sizes);
  piece.is_cone = cone != nullptr;
  piece.name = piece.is_cone ? "Cone frustum" : "S shape";
  const std::string words = piece.is_cone ? "cone frustum" : "S shape";
  piece.piece = std::visit(
      [](auto& sizes) {
        sizes.chord_tolerance = kPieceTolerance;
        return test_piece_of(sizes);
      },
      fine.sizes);
  piece.before = carry_out(request, words, piece.piece, cone, asked.before);
  piece.after = carry_out(request, words, piece.piece, cone, asked.after);
  return piece;
}

std::vector<VerificationVerdict> verdicts_on(const VerificationRequest& request, const CompensatedPoses& poses) {
  std::vector<VerificationVerdict> verdicts;
  if (request.least_reduction) {
    const double value = poses.reduction();
    const bool met = value >= *request.least_reduction;
    verdicts.push_back({fmt::format("{:.1f} times smaller: {} the required {:g} times", value,
                                    met ? "at least" : "LESS than", *request.least_reduction),
                        met});
  }
  if (request.largest_ratio) {
    const double value = poses.uncertainty_ratio();
    const bool met = value > 0 && value <= *request.largest_ratio;
    verdicts.push_back({fmt::format("{:.2f} times the predicted uncertainty: {} the permitted {:g} times", value,
                                    met ? "within" : "ABOVE", *request.largest_ratio),
                        met});
  }
  return verdicts;
}

}  // namespace

LeftOutPoses Verification::left_out() const {
  return {.all = poses_asked,
          .not_covered = poses.not_covered,
          .outside_travel = poses.outside_travel,
          .not_reached = poses.not_reached,
          .what = "random poses",
          .extrapolated = partial.at_state.outside};
}

bool Verification::says_no() const {
  return std::any_of(verdicts.begin(), verdicts.end(), [](const VerificationVerdict& verdict) { return !verdict.met; });
}

const char* step_words(VerificationStep step) {
  switch (step) {
    case VerificationStep::poses:
      return "correcting random poses";
    case VerificationStep::figures:
      return "mapping the volumetric error";
    case VerificationStep::pieces:
      return "carrying out test pieces";
  }
  return "";
}

VerificationRequest read_verification(const VerificationFiles& files) {
  VerificationRequest request;
  require_results(files.results);
  request.summary = results_summary_text(files.results);
  request.seed = seed_of_summary(request.summary).value_or(1);
  const auto found = [&files](const std::string& named, const char* in_results, const char* option) {
    return file_or_of_results(named, files.results, in_results, option);
  };
  const std::string machine_file = found(files.machine, "machine.toml", "--machine");
  request.errors_file = found(files.errors, "errors.toml", "--errors");
  request.truth_file = found(files.truth, "truth.errors.toml", "--truth");
  request.machine = read_machine(machine_file);
  request.identified = read_errors_at(request.errors_file, request.machine, files.states);
  request.truth = read_errors_at(request.truth_file, request.machine, files.states);
  return request;
}

Verification verify_compensation(const VerificationRequest& request, const VerificationOptions& options) {
  refuse_states(request.machine, request.identified.errors, "a verification", UsableStates::of_commands);
  refuse_states(request.machine, request.truth.errors, "a verification", UsableStates::of_commands);
  require_condition("--least-reduction", request.least_reduction);
  require_condition("--largest-ratio", request.largest_ratio);
  const auto tell = [&options](VerificationStep step, std::size_t done, std::size_t total) {
    stop_if_asked(options.stop);
    if (options.progress) options.progress(step, done, total);
  };
  Verification result;
  result.machine = request.machine;
  result.summary = request.summary;
  result.seed = request.seed;
  result.poses_asked = request.poses;
  const ErrorSet &identified = request.identified.errors, &truth = request.truth.errors;
  result.parameters = identified.parameter_count();
  Eigen::MatrixXd covariance = request.identified.covariance;
  // Without correlations, which is the best that can be said of a file that states uncertainties only.
  if (covariance.size() == 0) {
    covariance = stated_variances(identified);
    result.correlations_known = false;
  }
  if (request.largest_ratio && covariance.size() == 0) {
    throw InputError({.file = request.errors_file}, "states no uncertainties, and --largest-ratio asks for them",
                     "the errors.toml of an identification");
  }
  result.partial = partial_errors(request.machine, request.identified);
  tell(VerificationStep::poses, 0, 1);
  const PoseList poses = poses_to_verify(request, result);
  try {
    result.poses = check_compensated_poses(request.machine, truth, identified, covariance, poses);
  } catch (const std::invalid_argument& error) {
    throw InputError({.file = request.errors_file}, error.what(), "errors that can be compensated on this machine");
  }
  // The best fit of the workpiece datum has six freedoms.
  const LeftOutPoses left_out = result.left_out();
  if (left_out.all - left_out.count() < 10) {
    throw InputError({.field = "--range"}, left_out_words(left_out),
                     2 * left_out.not_reached > left_out.count()
                         ? "a machine whose axes can correct the position of the tool"
                         : "ranges in which at least 10 poses have a result");
  }
  if (result.poses.datum != BestFitStatus::ok) {
    throw InputError({.field = "--range"},
                     result.poses.datum == BestFitStatus::coincident
                         ? "the tool is at one place at all poses, so the turn of the workpiece is not determined"
                         : "the tool is on one line at all poses, so the turn of the workpiece about it is not "
                           "determined",
                     "ranges that spread the poses over an area, 1 mm or more across");
  }
  tell(VerificationStep::figures, 0, 1);
  result.volumetric = volumetric_figures(request.machine, &identified, covariance, &truth,
                                         stated_grid(request.machine, {&identified, &truth}));
  result.verdicts = verdicts_on(request, result.poses);
  for (const PieceToVerify& piece : request.pieces) {
    tell(VerificationStep::pieces, result.pieces.size(), request.pieces.size());
    result.pieces.push_back(verify_piece(request, piece));
  }
  return result;
}

}  // namespace abbe
