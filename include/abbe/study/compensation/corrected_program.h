#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "abbe/compensate/program/program_correction.h"
#include "abbe/compensate/program/word_axes.h"
#include "abbe/compensate/workpiece_expansion.h"
#include "abbe/errors/error_set.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/nc/nc_program.h"
#include "abbe/machine/machine.h"
#include "abbe/report/words/program_words.h"

namespace abbe {

/// An NC program that is to be corrected for the errors of a machine; lengths in mm, angles in rad.
///
/// Messages name a field by the option of `abbe compensate gcode` that sets it: --tolerance-um and the others of
/// `correction`, --leave-out-below-uncertainty, --max-output-mb, --max-minutes, --limit-um.
struct ProgramRequest {
  Machine machine;
  ErrorSet errors;
  /// [p, p] of errors.parameters(), or 0 x 0: what the errors state of their standard uncertainties.
  Eigen::MatrixXd covariance;
  StateValues at_state{};  ///< at which the errors are taken, for the report
  /// One that is to be right at 20 degC and has the temperature stated here: the program makes it so.
  std::optional<WorkpieceExpansion> workpiece{};
  std::string program_file, errors_file;  ///< names for messages

  WordAxes words;                       ///< axes of the program's words
  NcProgramOptions text;                ///< how it is read and written; planes, tool_centre and budget are set here
  bool tool_centre = false;             ///< X Y Z are the functional point in the workpiece frame throughout
  ProgramCorrectionOptions correction;  ///< tolerances; limit and budget are set here
  double leave_out_factor = 0;          ///< errors below so many of their standard uncertainties are left out; 0: none
  ProgramLimits limits{1e9, 1e9};       ///< beyond which the program is given up
  AllowedProblems allowed;              ///< what it may meet without being refused
  std::optional<double> limit_um;       ///< larger corrections of the functional point are refused; above zero
};

/// Corrects a program: the actual tool follows the commanded path within a tolerance. Opens no file.
///
/// Where the program must not be used, that is in the result (`refused`) and not an error.
/// @param program  its text
/// @param write    takes the corrected program piece by piece; it is only good if nothing is refused in the end
/// @param done     told how many bytes of the program are dealt with and not looked at again
/// @param stop     checked every few moves
/// @throws Stopped if `stop` was requested
/// @throws InputError for numbers of the request that are out of range, errors that cannot be corrected on this
///   machine, what the program says that is not understood, and tool centre moves for which the machine has no solution
CorrectedProgram correct_program(const ProgramRequest& request, std::string_view program,
                                 const std::function<void(std::string_view text)>& write,
                                 const std::function<void(std::size_t end)>& done, const std::stop_token& stop = {});

}  // namespace abbe
