#pragma once

// What a compensation leaves of the errors of a simulated machine, as `abbe verify` does it:
//
//   #include <abbe/study/verification/verification.h>
//
//   #include <cstdio>
//
//   int main() {
//     abbe::VerificationFiles files;
//     files.machine = "examples/machines/trunnion-mill.machine.toml";
//     files.errors = "examples/compensate/trunnion.errors.toml";
//     files.truth = "examples/verify/truth.errors.toml";
//     abbe::VerificationRequest request = abbe::read_verification(files);
//     request.least_reduction = 10;  // the mean volumetric error has to become ten times smaller
//     const abbe::Verification result = abbe::verify_compensation(request);
//     std::printf("poses: mean %.1f um before, %.1f um after compensation\n",
//                 1e3 * result.poses.before_statistics.mean,
//                 1e3 * result.poses.after_statistics.mean);  // verification_text() says more
//     for (const abbe::VerificationVerdict& verdict : result.verdicts) std::printf("%s\n", verdict.text.c_str());
//     return result.says_no() ? 1 : 0;
//   }
//
// It prints:
//
//   poses: mean 39.0 um before, 1.7 um after compensation
//   23.1 times smaller: at least the required 10 times
//
// Its page: verification_page.h. Method and figures: docs/verify.md.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "abbe/formats/evaluations/trace_file.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/geometry/stopped.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/machine/machine.h"
#include "abbe/machine/test_piece.h"
#include "abbe/report/evaluations/partial_errors.h"
#include "abbe/verify/compensated_poses.h"
#include "abbe/verify/left_out_poses.h"
#include "abbe/verify/parts/test_piece_deviation.h"
#include "abbe/verify/volumetric_figures.h"

namespace abbe {

/// Where the files of a verification are; what is empty is the file of that name in the results.
struct VerificationFiles {
  std::string results = {};              ///< folder of `abbe run`, of a study with simulated readings; empty: none
  std::string machine = {};              ///< else machine.toml
  std::string errors = {};               ///< identified; else errors.toml
  std::string truth = {};                ///< else truth.errors.toml
  std::vector<std::string> states = {};  ///< --state: at which both errors are taken, as state_options()
};

/// What the axes were commanded while a program ran.
struct PieceTrace {
  std::string file;  ///< for messages
  TraceFile trace;
};

/// A test piece that was run twice.
struct PieceToVerify {
  std::variant<ConeFrustum, SShape> sizes;  ///< feed and chord tolerance are not used
  PieceTrace before, after;                 ///< without and with the compensation
};

/// What is verified, and the requirements; lengths in mm, angles in rad.
///
/// Messages name a field by the option of `abbe verify` that sets it, given below.
struct VerificationRequest {
  Machine machine;
  ErrorsFile identified;                ///< without covariance: its standard uncertainties, as if independent
  ErrorsFile truth;                     ///< true errors of the simulated machine
  std::string errors_file, truth_file;  ///< names for messages
  std::string summary;                  ///< text of the summary.json of the study; empty: none

  std::size_t poses = 1000;  ///< --poses: random ones, at least 10
  std::uint64_t seed = 1;    ///< --seed: of the random poses
  /// --range: [axes] within the travel, or empty; what is not set is the range over which all errors are known.
  std::vector<std::optional<AxisRange>> ranges;
  std::optional<double> least_reduction;  ///< --least-reduction: mean volumetric error, times smaller; above zero
  std::optional<double> largest_ratio;    ///< --largest-ratio: to the predicted uncertainty, above zero
  std::vector<PieceToVerify> pieces;
  double reach_mm = 1;  ///< --reach-mm: a sample farther from a piece's path does not cut it
};

/// Opens the files of a verification; pieces and conditions are left to be added.
///
/// The seed is the one at which the results were validated, so that the poses are the same; 1 without results.
/// @throws InputError naming the file, or the option by which a missing one can be named
VerificationRequest read_verification(const VerificationFiles& files);

/// One run of a test piece.
struct PieceRun {
  std::string file;
  std::size_t samples = 0;
  std::optional<double> duration_s;  ///< of the cut
  PieceDeviation deviation;
  PieceFigures as_cut, aligned;  ///< without and with the best fit of the workpiece
  Roundness foot, head;          ///< of a cone
};

struct VerifiedPiece {
  bool is_cone = false;
  std::string name;  ///< "Cone frustum"
  TestPiece piece;
  PieceRun before, after;
};

/// Verdict on one of the two figures that may be asked for.
struct VerificationVerdict {
  std::string text;
  bool met = true;
};

/// Errors that a compensation leaves. It holds no reference to the request.
struct Verification {
  Machine machine;
  std::string summary;             ///< as in the request
  std::size_t parameters = 0;      ///< of the identified errors
  std::vector<AxisRange> ranges;   ///< [axes] of the random poses
  std::uint64_t seed = 1;          ///< of the random poses
  std::size_t poses_asked = 0;     ///< with those that are left out
  bool correlations_known = true;  ///< false: the errors file states standard uncertainties only
  PartialErrors partial;           ///< what the identified errors do not state
  bool both_directions = false;    ///< there are reversal values: axes come from either side
  CompensatedPoses poses;          ///< random, commands corrected, axes from either side
  VolumetricFigures volumetric;    ///< over the grid that all commands state
  std::vector<VerifiedPiece> pieces;
  std::vector<VerificationVerdict> verdicts;

  LeftOutPoses left_out() const;
  /// Whether a requirement is not met.
  bool says_no() const;
};

/// The parts of a verification that take time, in their order.
enum class VerificationStep { poses, figures, pieces };

/// "correcting random poses", "mapping the volumetric error", "carrying out test pieces".
const char* step_words(VerificationStep step);

struct VerificationOptions {
  /// Called at the beginning of every step, and with every piece that is done: done of total.
  std::function<void(VerificationStep step, std::size_t done, std::size_t total)> progress{};
  std::stop_token stop{};  ///< looked at there
};

/// Commands at random poses and on test pieces without and with the compensation, carried out by the machine with its
/// true errors. Opens no file and prints nothing.
/// @throws InputError for errors that cannot be compensated, ranges that leave less than 10 poses or do not determine
///   the workpiece datum, conditions that are none or cannot be judged, traces that are none of their piece, and sizes
///   that make none; Stopped where that was asked for
Verification verify_compensation(const VerificationRequest& request, const VerificationOptions& options = {});

}  // namespace abbe
