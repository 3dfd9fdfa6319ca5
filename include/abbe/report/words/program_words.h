#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/compensate/left_out_errors.h"
#include "abbe/compensate/program/program_report.h"
#include "abbe/compensate/program/program_uncertainty.h"
#include "abbe/compensate/workpiece_expansion.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/nc/nc_program.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// A problem with which a program may still be written, by its name for --allow.
struct AllowedProblems {
  bool not_covered = false, outside_travel = false, held_start = false, position_left = false, not_converged = false;
  bool not_proven = false;
};

/// Limits of the size and the time of a corrected program.
struct ProgramLimits {
  double megabytes = 0, minutes = 0;
};

/// Settings of a correction that its report states.
struct ProgramWordsRequest {
  std::string program;          ///< name of its file
  std::string output;           ///< of the corrected program
  double tolerance_um = 1;      ///< between corrected poses
  double leave_out_factor = 0;  ///< standard uncertainties below which errors are left out; 0: none
  bool dry_run = false;
};

/// What was done to a program, with the uncertainties of the largest corrections.
struct CorrectedProgram {
  StateValues at_state{};                         ///< at which the errors are taken
  std::optional<WorkpieceExpansion> workpiece{};  ///< for which the program is corrected
  ProgramReport report;
  NcProgramResult text;
  PlaceUncertainty largest;                  ///< at ProgramReport::largest_shift
  std::vector<PlaceUncertainty> by_axis;     ///< [axes] at ProgramReport::by_axis
  std::vector<ReversalAxis> reversals;       ///< compensated reversal values
  std::vector<double> reversal_uncertainty;  ///< [reversals] mm or rad, 0: not stated
  LeftOutErrors left_out;                    ///< errors below their uncertainty
  std::vector<std::string> refused;          ///< why nothing is written; empty: it is
};

/// Why the program was given up, with the place and the option that allows more.
std::string given_up_words(const std::string& program, const ProgramLimits& limits, const NcProgramResult& text);

/// Reasons not to write the program that are not allowed.
/// @param limit_um  of corrections, as it was asked for; infinite: none
std::vector<std::string> reasons_to_refuse(double limit_um, const AllowedProblems& allowed, const Machine& machine,
                                           const ProgramReport& report);

/// What was done, for people; complete lines.
std::string program_text(const ProgramWordsRequest& request, const Machine& machine, const CorrectedProgram& result);

/// The same for programs; units in the keys.
nlohmann::ordered_json program_json(const ProgramWordsRequest& request, const Machine& machine,
                                    const CorrectedProgram& result);

}  // namespace abbe
