#include "verify/verify_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/formats/input_error.h"
#include "abbe/formats/machine_file.h"
#include "abbe/formats/text_file.h"
#include "abbe/formats/trace_file.h"
#include "abbe/study/random_poses.h"
#include "abbe/study/study_result.h"
#include "abbe/verify/volumetric_figures.h"
#include "axis_option.h"
#include "errors_for_use.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

/// So fine that the lines between the points of a piece are not seen in the figures, mm.
constexpr double kPieceTolerance = 1e-5;

/// A file that was named, or the one that results hold under this name.
std::string found(const std::string& named, const std::string& results, const char* in_results, const char* option) {
  if (!named.empty()) return named;
  if (results.empty()) {
    throw InputError({.field = option}, "is missing", "this option, or the results folder of abbe run");
  }
  const fs::path path = fs::path(results) / in_results;
  std::error_code ignored;
  if (!fs::exists(path, ignored)) {
    throw InputError({.file = path.string()}, "these results have no such file",
                     fmt::format("results of a simulated study, or {} with a file", option));
  }
  return path.string();
}

/// "X_mm=-100:100" or "C_deg=30".
void apply_range(const Machine& machine, const std::string& text, std::vector<AxisRange>& ranges) {
  const std::string expected = "AXIS_unit=from:to or AXIS_unit=position, such as X_mm=-100:100";
  const auto [axis, unit, numbers] = axis_numbers_option(machine, "--range", text, expected);
  if (numbers.size() > 2 || !(numbers.size() == 1 || numbers[0] < numbers[1])) {
    throw InputError({.field = "--range " + text}, "needs a position, or two with the larger one behind the smaller",
                     expected);
  }
  const Axis& moved = machine.axes[axis];
  if (!moved.endless && !(numbers.front() * unit >= moved.travel_min && numbers.back() * unit <= moved.travel_max)) {
    throw InputError({.field = "--range " + text}, "outside the axis's travel",
                     fmt::format("positions within the travel, {:g} to {:g} in this unit", moved.travel_min / unit,
                                 moved.travel_max / unit));
  }
  ranges[axis] =
      numbers.size() == 1 ? AxisRange::fixed(numbers[0] * unit) : AxisRange{numbers[0] * unit, numbers[1] * unit, 2, 0};
}

PoseList unseen_poses(const VerifyOptions& options, VerifyResult& result) {
  const Machine& machine = result.machine;
  result.ranges = unseen_ranges(machine, {&result.identified.errors, &result.truth.errors});
  for (const std::string& text : options.ranges) apply_range(machine, text, result.ranges);
  result.both_directions = !result.truth.errors.reversals.empty() || !result.identified.errors.reversals.empty();
  try {
    return random_unseen_poses(machine, result.ranges, options.poses, result.seed, result.both_directions);
  } catch (const std::invalid_argument& error) {
    throw InputError({.field = "--range"}, error.what(), "ranges within the travel of their axes");
  }
}

/// The seed of the random poses at which these results were validated, so that both commands take the same ones.
std::optional<std::uint64_t> seed_of_results(const std::string& results) {
  const nlohmann::json summary = results_summary(results);
  if (!summary.contains("seed") || !summary["seed"].is_number_unsigned()) return {};
  return unseen_seed(summary["seed"].get<std::uint64_t>());
}

[[noreturn]] void refuse(const PieceRun& run, const std::string& piece, const PieceDeviation& deviation, double reach) {
  InputError::Place place{.file = run.file, .line = trace_line(run.file, deviation.row)};
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

PieceRun run_piece(const VerifyResult& result, const std::string& name, const TestPiece& piece,
                   const ConeFrustum* frustum, const std::string& file, double reach) {
  PieceRun run;
  run.file = file;
  const TraceFile trace = read_trace(file, result.machine);
  run.samples = trace.commands.count();
  const ToolPlaces tool =
      actual_tool(result.machine, result.truth.errors, positions_with_play(result.truth.errors, trace.commands));
  run.deviation = test_piece_deviation(piece, tool, reach);
  if (run.deviation.status != PieceTraceStatus::done) refuse(run, name, run.deviation, reach);
  for (const std::size_t row : run.deviation.rows) {
    if (tool.covered[row] != 0) continue;
    throw InputError({.file = file, .line = trace_line(file, row)},
                     "an axis is outside the range in which its true errors are known",
                     fmt::format("errors known there ({})", result.truth_file));
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

PieceResult verify_piece(const VerifyResult& result, const VerifyPiece& asked, double reach) {
  PieceResult piece;
  piece.is_cone = asked.is_cone;
  piece.name = asked.is_cone ? "Cone frustum" : "S shape";
  const std::string words = asked.is_cone ? "cone frustum" : "S shape";
  ConeFrustum frustum;
  if (asked.is_cone) {
    frustum = cone_frustum_of(asked.sizes);
    frustum.chord_tolerance = kPieceTolerance;
    piece.piece = made_piece(frustum);
  } else {
    SShape shape = s_shape_of(asked.sizes);
    shape.chord_tolerance = kPieceTolerance;
    piece.piece = made_piece(shape);
  }
  const ConeFrustum* const cone = asked.is_cone ? &frustum : nullptr;
  piece.before = run_piece(result, words, piece.piece, cone, asked.before, reach);
  piece.after = run_piece(result, words, piece.piece, cone, asked.after, reach);
  return piece;
}

std::vector<VerifyVerdict> verdicts_on(const VerifyOptions& options, const CompensatedPoses& poses) {
  std::vector<VerifyVerdict> verdicts;
  if (options.least_reduction) {
    const double value = poses.reduction();
    const bool met = value >= *options.least_reduction;
    verdicts.push_back({fmt::format("{:.1f} times smaller: {} the wanted {:g} times", value,
                                    met ? "at least" : "LESS than", *options.least_reduction),
                        met});
  }
  if (options.largest_ratio) {
    const double value = poses.uncertainty_ratio();
    const bool met = value > 0 && value <= *options.largest_ratio;
    verdicts.push_back({fmt::format("{:.2f} times the predicted uncertainty: {} the permitted {:g} times", value,
                                    met ? "within" : "ABOVE", *options.largest_ratio),
                        met});
  }
  return verdicts;
}

}  // namespace

nlohmann::json results_summary(const std::string& results) {
  if (results.empty()) return nullptr;
  const fs::path path = fs::path(results) / "summary.json";
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return nullptr;
  nlohmann::json json = nlohmann::json::parse(read_text_file(path), nullptr, false);
  return json.is_object() ? json : nlohmann::json(nullptr);
}

LeftOutPoses VerifyResult::left_out() const {
  return {.all = poses_asked,
          .not_covered = poses.not_covered,
          .outside_travel = poses.outside_travel,
          .not_reached = poses.not_reached,
          .what = "random poses"};
}

VerifyResult verify(const VerifyOptions& options) {
  VerifyResult result;
  result.poses_asked = options.poses;
  std::error_code ignored;
  if (!options.results.empty() && !fs::is_directory(options.results, ignored)) {
    throw InputError({.file = options.results}, "is not a folder", "results of abbe run");
  }
  result.seed = options.seed ? *options.seed : seed_of_results(options.results).value_or(1);
  const std::string machine_file = found(options.machine, options.results, "machine.toml", "--machine");
  result.errors_file = found(options.errors, options.results, "errors.toml", "--errors");
  result.truth_file = found(options.truth, options.results, "truth.errors.toml", "--truth");
  result.machine = read_machine(machine_file);
  result.identified = read_errors_and_tell(result.errors_file, result.machine);
  result.truth = read_errors(result.truth_file, result.machine);
  // Without correlations, which is the best that can be said of a file that states uncertainties only.
  if (result.identified.covariance.size() == 0) {
    result.identified.covariance = stated_variances(result.identified.errors);
    result.correlations_known = false;
  }
  if (options.largest_ratio && result.identified.covariance.size() == 0) {
    throw InputError({.file = result.errors_file}, "states no uncertainties, and --largest-ratio asks for them",
                     "the errors.toml of an identification");
  }
  result.partial = partial_errors(result.machine, result.identified);
  const PoseList poses = unseen_poses(options, result);
  try {
    result.poses = check_compensated_poses(result.machine, result.truth.errors, result.identified.errors,
                                           result.identified.covariance, poses);
  } catch (const std::invalid_argument& error) {
    throw InputError({.file = result.errors_file}, error.what(), "errors that can be compensated on this machine");
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
  const ErrorSet &identified = result.identified.errors, &truth = result.truth.errors;
  result.volumetric = volumetric_figures(result.machine, &identified, result.identified.covariance, &truth,
                                         stated_grid(result.machine, {&identified, &truth}));
  result.verdicts = verdicts_on(options, result.poses);
  for (const VerifyPiece& piece : options.pieces) result.pieces.push_back(verify_piece(result, piece, options.reach));
  return result;
}

}  // namespace abbe
