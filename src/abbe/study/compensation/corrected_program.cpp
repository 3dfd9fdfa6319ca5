#include "abbe/study/compensation/corrected_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "abbe/compensate/left_out_errors.h"
#include "abbe/compensate/program/machine_planes.h"
#include "abbe/compensate/program/program_uncertainty.h"
#include "abbe/compensate/program/tool_centre_moves.h"
#include "abbe/errors/reversal.h"
#include "abbe/formats/machine/correction_limits.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_couplings.h"
#include "abbe/formats/machine/workpiece_option.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr double kMostOfALimit = 1e9;

/// @param unit  of the option, in that of the value
void require_above_zero(const char* option, double value, double unit, const char* expected) {
  if (value > 0 && std::isfinite(value)) return;
  throw InputError({.field = option}, fmt::format("{:g} is not a finite number above zero", value / unit), expected);
}

void check_program_request(const ProgramRequest& request) {
  check_leave_out(request.leave_out_factor, request.errors, request.covariance, request.errors_file);
  require_above_zero("--max-output-mb", request.limits.megabytes, 1, "a size in MB");
  require_above_zero("--max-minutes", request.limits.minutes, 1, "a time in min");
  const ProgramCorrectionOptions& correction = request.correction;
  require_above_zero("--tolerance-um", correction.tolerance.position, 1e-3, "a length in um");
  require_above_zero("--rapid-tolerance-um", correction.rapid_tolerance, 1e-3, "a length in um");
  require_above_zero("--orientation-tolerance-urad", correction.tolerance.orientation, 1e-6, "an angle in urad");
  require_above_zero("--largest-turn-deg", correction.inverse.largest_turn, kDegree, "an angle in deg");
  if (correction.reversal_dead_band != 0) {
    require_above_zero("--reversal-dead-band-um", correction.reversal_dead_band, 1e-3, "a length in um");
  }
}

/// All errors of a place, and what is known of them.
class ErrorsOfPlace {
 public:
  ErrorsOfPlace(const ProgramRequest& request, Eigen::MatrixXd covariance,
                const std::optional<WorkpieceErrors>& of_workpiece)
      : machine_errors_(request.errors), of_machine_(std::move(covariance)), of_workpiece_(of_workpiece) {}

  ErrorSet errors(const ProgramPlace& place) const {
    if (!of_workpiece_) return machine_errors_;
    ErrorSet result = of_workpiece_->with(machine_errors_);
    const auto& length = place.tool_length;
    result.tool_offset_error -= of_workpiece_->tool_length_share() * Eigen::Vector3d(length[0], length[1], length[2]);
    return result;
  }
  Eigen::MatrixXd covariance(const ProgramPlace& place) const {
    return of_workpiece_ ? of_workpiece_->covariance_with(machine_errors_, of_machine_, place.tool_length)
                         : of_machine_;
  }

 private:
  const ErrorSet& machine_errors_;
  Eigen::MatrixXd of_machine_;
  const std::optional<WorkpieceErrors>& of_workpiece_;
};

void state_uncertainties(const ProgramRequest& request, const Eigen::MatrixXd& covariance,
                         const std::optional<WorkpieceErrors>& of_workpiece, CorrectedProgram& result) {
  const Machine& machine = request.machine;
  const ErrorSet& errors = request.errors;
  const ErrorsOfPlace all(request, covariance, of_workpiece);
  std::vector<bool> moved;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) moved.push_back(request.words.moves(i));
  const auto at = [&](const ProgramPlace& place) {
    if (place.line == 0) return PlaceUncertainty{};
    std::vector<double> sides;
    for (const MachineState& state : machine.states) {
      sides.push_back(state.kind == StateKind::approach ? place.approach[state.axis] : 0.0);
    }
    return uncertainty_at(machine, all.errors(place), all.covariance(place), place, moved, sides);
  };
  result.largest = at(result.report.largest_shift);
  for (std::size_t i = 0; i < machine.axes.size(); ++i) result.by_axis.push_back(at(result.report.by_axis[i]));
  for (const ReversalAxis& axis : result.reversals) {
    result.reversal_uncertainty.push_back(0);
    auto parameter = static_cast<Eigen::Index>(first_reversal(errors));
    for (const Reversal& reversal : errors.reversals) {
      if (reversal.axis == axis.axis)
        result.reversal_uncertainty.back() = std::sqrt(std::max(0.0, covariance(parameter, parameter)));
      ++parameter;
    }
  }
}

}  // namespace

CorrectedProgram correct_program(const ProgramRequest& request, std::string_view program,
                                 const std::function<void(std::string_view text)>& write,
                                 const std::function<void(std::size_t end)>& done, const std::stop_token& stop) {
  refuse_couplings(request.machine, "a correction of NC programs");
  refuse_states(request.machine, request.errors, "a correction of programs", UsableStates::of_motions);
  if (request.leave_out_factor > 0) {
    refuse_states(request.machine, request.errors, "--leave-out-below-uncertainty");
  }
  check_program_request(request);
  const double limit_um = refusal_limit("--limit-um", request.limit_um, "um");
  const Machine& machine = request.machine;
  const Eigen::MatrixXd covariance = parameter_covariance(request.errors, request.covariance);
  std::optional<WorkpieceErrors> of_workpiece;
  if (request.workpiece) of_workpiece = workpiece_errors(machine, *request.workpiece, request.errors);
  CorrectedProgram result;
  result.at_state = request.at_state;
  result.workpiece = request.workpiece;
  ErrorSet corrected_errors = request.errors;
  if (request.leave_out_factor > 0) {
    result.left_out = leave_out_uncertain(machine, corrected_errors, covariance, request.leave_out_factor);
  }
  if (of_workpiece) corrected_errors = of_workpiece->with(corrected_errors);
  const MachinePlanes planes(machine, request.words);
  ProgramBudget budget(static_cast<std::size_t>(1e6 * std::min(request.limits.megabytes, kMostOfALimit)),
                       60 * std::min(request.limits.minutes, kMostOfALimit), stop);
  NcProgramOptions text_options = request.text;
  text_options.planes = &planes;
  text_options.tool_centre = request.tool_centre;
  text_options.budget = &budget;
  ProgramCorrectionOptions correction_options = request.correction;
  correction_options.limit = 1e-3 * limit_um;
  correction_options.budget = &budget;
  if (of_workpiece) correction_options.tool_length_share = of_workpiece->tool_length_share();
  ProgramCorrection correction(machine, corrected_errors, request.words, correction_options);
  if (!correction.problem().empty()) throw InputError({.file = request.errors_file}, correction.problem());
  ToolCentreMoves tool_centre(correction);
  MoveCorrector& corrector = request.tool_centre ? static_cast<MoveCorrector&>(tool_centre) : correction;
  result.text = correct_nc_program(program, request.program_file, text_options, corrector, write, done);
  result.report = correction.report();
  result.reversals = correction.reversals();
  if (result.report.impossible.count > 0) {
    throw InputError({.file = request.program_file, .line = result.report.impossible.line[0]},
                     "a tool centre move, for which the machine has no solution here",
                     "X, Y and Z as three independent linear axes without a rotary axis between them");
  }
  state_uncertainties(request, covariance, of_workpiece, result);
  if (result.text.spent == ProgramBudget::Spent::nothing) {
    result.refused = reasons_to_refuse(limit_um, request.allowed, machine, result.report);
  } else {
    result.refused = {given_up_words(request.program_file, request.limits, result.text)};
  }
  return result;
}

}  // namespace abbe
