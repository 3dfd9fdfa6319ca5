#pragma once

#include <array>
#include <optional>
#include <string>

#include "abbe/formats/machine/linkage_file.h"
#include "abbe/formats/text/unit.h"
#include "abbe/identify/linkage/linkage_steps.h"
#include "abbe/identify/linkage/swing_head_linkage.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Linkage of a laser engraver with a swing head C1, A from the five steps, for evaluate_readings(); lengths in mm,
/// angles in rad. With a machine its errors are found too, and the further files of the evaluation are its errors file
/// and, if an uncertainty was stated, the covariance. Method: docs/linkage-steps.md.
///
/// Refused: a machine without the axes X, Y, Z, C1 and A, a convention that is not that of the machine, and readings
/// that determine no linkage.
struct LinkageTest {
  /// As read_linkage() returns them, with --exit-to-axis-mm and --board-mm entered; their convention is set here.
  LinkageReadings readings;
  LinkageAccuracy accuracy;                     ///< zero: not stated, taken as exact
  std::optional<LinkageConvention> convention;  ///< --convention; without it that of the machine, or else table_moves
  std::optional<Machine> machine;               ///< --machine: nominal
  std::string machine_file;                     ///< its name for messages
};

/// Name of an uncertainty of the five steps.
struct LinkageAccuracyName {
  const char* option;  ///< of `abbe evaluate linkage`, also in notes: "--u-x-um"
  Quantity quantity;
  const char* unit;  ///< suffix of the quantity: "um"
  double LinkageAccuracy::*value;
  const char* words;  ///< of what: "a position of X"
};

/// All uncertainties, in the order of the options.
const std::array<LinkageAccuracyName, 12>& linkage_accuracy_names();

}  // namespace abbe
