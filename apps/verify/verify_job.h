#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/errors_file.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/machine/machine.h"
#include "abbe/report/partial_errors.h"
#include "abbe/verify/compensated_poses.h"
#include "abbe/verify/test_piece_deviation.h"
#include "abbe/verify/volumetric_figures.h"
#include "test_piece/sizes.h"
#include "uncovered_poses.h"

namespace abbe {

/// A test piece that was run twice.
struct VerifyPiece {
  bool is_cone = false;  ///< else the S
  TestPieceSizes sizes;
  std::string before, after;  ///< traces (*.csv)
};

/// What the command was asked.
struct VerifyOptions {
  std::string results, machine, errors, truth, output;
  std::vector<std::string> ranges;
  std::vector<VerifyPiece> pieces;
  std::size_t poses = 1000;
  std::optional<std::size_t> seed;  ///< none: that of the results, else 1
  double reach = 1;                 ///< mm
  std::optional<double> least_reduction, largest_ratio;
  bool json = false, accept_uncovered = false;
};

/// One run of a test piece.
struct PieceRun {
  std::string file;
  std::size_t samples = 0;
  std::optional<double> duration_s;  ///< of the cut
  PieceDeviation deviation;
  PieceFigures as_cut, aligned;  ///< without and with the best fit of the workpiece
  Roundness foot, head;          ///< of a cone
};

struct PieceResult {
  bool is_cone = false;
  std::string name;  ///< "Cone frustum"
  TestPiece piece;
  PieceRun before, after;
};

/// Verdict on one of the two figures that may be asked for.
struct VerifyVerdict {
  std::string text;
  bool met = true;
};

struct VerifyResult {
  Machine machine;
  ErrorsFile identified, truth;
  std::string errors_file, truth_file;
  std::vector<AxisRange> ranges;
  std::uint64_t seed = 1;          ///< of the random poses
  std::size_t poses_asked = 0;     ///< with those that are left out
  bool correlations_known = true;  ///< false: the errors file states standard uncertainties only
  PartialErrors partial;           ///< what the identified errors do not state
  bool both_directions = false;    ///< there are reversal values: axes come from either side
  CompensatedPoses poses;          ///< random, commands corrected, axes from either side
  VolumetricFigures volumetric;    ///< over the grid that all commands state
  std::vector<PieceResult> pieces;
  std::vector<VerifyVerdict> verdicts;

  LeftOutPoses left_out() const;
};

/// The summary.json of results, or null where there is none. @param results  folder; empty: none
nlohmann::json results_summary(const std::string& results);

/// @throws InputError
VerifyResult verify(const VerifyOptions& options);

}  // namespace abbe
