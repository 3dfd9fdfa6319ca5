#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/compensate/left_out_errors.h"
#include "abbe/compensate/program_report.h"
#include "abbe/compensate/program_uncertainty.h"
#include "abbe/formats/nc_program.h"
#include "abbe/machine/machine.h"
#include "compensate/gcode_options.h"

namespace abbe {

/// What was done to a program, with the uncertainties of the largest corrections.
struct GcodeResult {
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
std::string given_up_words(const GcodeOptions& options, const GcodeBudget& budget, const NcProgramResult& text);
/// Reasons not to write the program that are not allowed.
std::vector<std::string> reasons_to_refuse(const GcodeOptions& options, const AllowedProblems& allowed,
                                           const Machine& machine, const ProgramReport& report);
void print_gcode_report(const GcodeOptions& options, const Machine& machine, const GcodeResult& result);
nlohmann::ordered_json gcode_json(const GcodeOptions& options, const Machine& machine, const GcodeResult& result);

}  // namespace abbe
