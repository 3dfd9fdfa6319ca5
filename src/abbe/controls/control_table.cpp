#include "abbe/controls/control_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/compensate/left_out_errors.h"
#include "abbe/controls/left_out_tables.h"
#include "abbe/controls/lost_motion.h"
#include "abbe/controls/table_format.h"
#include "abbe/controls/table_limits.h"
#include "abbe/controls/travel_grid.h"
#include "abbe/controls/useless_tables.h"
#include "abbe/controls/writer_request.h"
#include "abbe/formats/machine/correction_limits.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_couplings.h"
#include "abbe/formats/machine/workpiece_option.h"
#include "abbe/verify/error_map.h"

namespace abbe {
namespace {

/// Nodes of tables that are made for one error alone, to see what of it is carried.
constexpr std::size_t kNodesForOneError = 33;

void check_judgement(const ControlTableRequest& request) {
  check_leave_out(request.leave_out_below, request.errors, request.covariance, request.errors_file);
  check_refusal(request.limit_mm, request.limit_rad, request.least_reduction);
}

/// What takes the reversal values that the tables do not carry.
std::vector<ControlNote> reversal_notes(const Machine& machine, const ErrorSet& errors, const TableFormat& format,
                                        const WriterRequest& request) {
  std::vector<ControlNote> notes;
  for (const Reversal& reversal : errors.reversals) {
    if (reversal.value == 0) continue;
    const Axis& axis = machine.axes[reversal.axis];
    const bool rotary = axis.kind == AxisKind::rotary;
    std::string words;
    if (format.directions && !request.axes[reversal.axis]) {
      words = "no table is wanted for this axis";
    } else if (format.backlash) {
      const bool named = !format.axis_names.empty();
      words =
          format.backlash(named ? table_axis(request.names, reversal.axis).name : axis.name, -reversal.value, rotary);
    } else {
      words = "handled by the backlash compensation of the control, if it has one: " +
              lost_motion_words(-reversal.value, rotary);
    }
    notes.push_back({reversal_name(machine, reversal.axis), std::move(words)});
  }
  return notes;
}

/// Standard uncertainty of the displacement that is corrected, over poses.
SampleStatistics displacement_uncertainty(const Machine& machine, const ErrorSet& errors,
                                          const Eigen::MatrixXd& covariance, const PoseList& poses) {
  ErrorMapOptions options;
  ParameterCovariance parameters;
  parameters.covariance = covariance;
  for (std::size_t p = 0; p < errors.parameter_count(); ++p) parameters.parameters.push_back(p);
  options.covariance = &parameters;
  options.orientation = false;
  const ErrorMap map = error_map(machine, errors, nullptr, pose_source(poses), options);
  return sample_statistics(map.norm_uncertainty, map.covered);
}

/// The tables of a request on their way to a result.
struct Making {
  const ControlTableRequest& request;
  const TableFormat& format;
  const Eigen::MatrixXd& covariance;  ///< 0 x 0: not known
  WriterRequest writer;
  ErrorSet carried;  ///< what the tables are made of; they are judged by all errors
  std::vector<LeftOutReversal> left_out;
  WrittenTables tables;
};

/// Writes the tables, leaves out those below their uncertainty and states the uncertainty of the others.
void write_tables(Making& making, ControlTables& made) {
  const Machine& machine = making.request.machine;
  const double times = making.request.leave_out_below;
  const Eigen::MatrixXd& covariance = making.covariance;
  if (covariance.size() > 0) {
    making.left_out = leave_out_uncertain_reversals(making.carried, covariance, times);
  }
  for (const LeftOutReversal& one : making.left_out) {
    made.left_out.push_back(
        fmt::format("{}: {:.2g} times its standard uncertainty", reversal_name(machine, one.axis), one.times));
  }
  WrittenTables& tables = making.tables;
  tables = making.format.write(machine, making.carried, making.writer);
  std::vector<double> uncertainty;
  if (covariance.size() > 0) {
    std::vector<SmallTable> small, unused;
    uncertainty = table_uncertainties(making.carried, covariance, tables.tables, times, small);
    for (const SmallTable& table : leave_out_tables(machine, making.carried, covariance, made.poses, making.format,
                                                    making.writer, times, tables, small)) {
      made.left_out_kept.push_back(table.text());
    }
    for (const SmallTable& table : small) made.left_out.push_back(table.text());
    if (!small.empty()) uncertainty = table_uncertainties(making.carried, covariance, tables.tables, 0, unused);
    made.uncertainty = displacement_uncertainty(machine, making.request.errors, covariance, made.poses);
  }
  for (std::size_t t = 0; t < tables.tables.size(); ++t) {
    if (t < uncertainty.size()) tables.tables[t].standard_uncertainty = uncertainty[t];
    made.tables.push_back(tables.tables[t]);
  }
}

/// What becomes of every error alone.
std::vector<CarriedError> what_is_carried(const Making& making) {
  const Machine& machine = making.request.machine;
  std::vector<std::size_t> unused;
  const PoseList few = travel_grid(machine, making.request.errors, machine.axes.size() > 3 ? 3 : 5, unused);
  WriterRequest quick = making.writer;
  quick.nodes = kNodesForOneError;
  return carried_errors(machine, making.request.errors, few, [&](ErrorSet alone) {
    for (Reversal& reversal : alone.reversals) {
      for (const LeftOutReversal& one : making.left_out) {
        reversal.value = reversal.axis == one.axis ? 0 : reversal.value;
      }
    }
    return making.format.write(machine, alone, quick).correction;
  });
}

/// A lattice has the position of every axis that a state may follow from; a table over one axis has one value at each
/// of its positions. Rotary axes are corrected by themselves, whatever others do.
void refuse_states_of(const std::string& format, const Machine& machine, const ErrorSet& errors) {
  if (table_format(format).kind != TableKind::lattice) {
    refuse_states(machine, errors, "a table over the position of one axis");
    return;
  }
  refuse_states(machine, errors, "a lattice", UsableStates::of_commands);
  ErrorSet of_rotary;
  for (const ErrorMotion& motion : errors.motions) {
    if (machine.axes[motion.axis].kind == AxisKind::rotary) of_rotary.motions.push_back(motion);
  }
  for (const LocationError& location : errors.locations) {
    if (machine.axes[location.axis].kind == AxisKind::rotary) of_rotary.locations.push_back(location);
  }
  refuse_states(machine, of_rotary, "the correction of a rotary axis by itself");
}

LossOverStates loss_over_states(const ControlTableRequest& request, const PoseList& poses,
                                const CommandCorrection& correction) {
  LossOverStates loss;
  loss.record = request.over_file;
  for (const ErrorsAtTime& there : request.over) {
    refuse_states_of(request.format, request.machine, there.errors);
    const SampleStatistics left = volumetric_error_with(request.machine, there.errors, poses, correction);
    loss.time_s.push_back(there.time_s);
    loss.rms.push_back(left.rms);
    loss.maximum.push_back(left.maximum);
    loss.outside += there.at_state.outside.empty() ? 0U : 1U;
  }
  loss.worst_state = request.over[loss.worst()].at_state;
  return loss;
}

/// The same request with the workpiece among the errors.
ControlTableRequest as_errors_alone(const ControlTableRequest& request) {
  ControlTableRequest result = request;
  result.workpiece.reset();
  const auto on_workpiece = [&](const ErrorSet& errors, const Eigen::MatrixXd& covariance) {
    return errors_on_workpiece(request.machine, *request.workpiece, errors, covariance);
  };
  ErrorsOnWorkpiece all = on_workpiece(request.errors, request.covariance);
  result.errors = std::move(all.errors);
  result.covariance = std::move(all.covariance);
  for (ErrorsAtTime& there : result.over) there.errors = on_workpiece(there.errors, {}).errors;
  return result;
}

/// Why the tables must not be used.
void judge(const Making& making, ControlTables& made) {
  const ControlTableRequest& request = making.request;
  check_limits(request, *making.tables.correction, made);
  made.refused.insert(made.refused.end(), making.tables.problems.begin(), making.tables.problems.end());
  if (made.refused.empty()) {
    const std::string useless =
        useless_tables(request.machine, making.carried, making.writer, made, request.least_reduction);
    if (!useless.empty()) made.refused.push_back(useless);
  }
  const bool within =
      std::all_of(made.tables.begin(), made.tables.end(), [](const TableFigures& table) { return table.within; });
  if (made.refused.empty() && !within) {
    made.too_few_nodes = fmt::format(
        "straight lines between the nodes that {} has room for do not keep to --interpolation-um or "
        "--interpolation-urad",
        making.format.name);
  }
}

}  // namespace

std::size_t LossOverStates::worst() const {
  return static_cast<std::size_t>(std::max_element(maximum.begin(), maximum.end()) - maximum.begin());
}

double LossOverStates::rms_of_all() const {
  double sum = 0;
  for (const double one : rms) sum += one * one / static_cast<double>(rms.size());
  return std::sqrt(sum);
}

std::string LossOverStates::outside_words() const {
  if (outside == 0) return {};
  return fmt::format(
      "the states of {} lie outside what the readings cover at {} of {} times: the errors are extrapolated", record,
      outside, time_s.size());
}

ControlTables make_control_tables(const ControlTableRequest& request) {
  if (request.workpiece) {
    check_judgement(request);
    ControlTables made = make_control_tables(as_errors_alone(request));
    made.workpiece = request.workpiece;
    return made;
  }
  refuse_couplings(request.machine, "a table of a control");
  refuse_states_of(request.format, request.machine, request.errors);
  const TableFormat& format = table_format(request.format);
  const Machine& machine = request.machine;
  const ErrorSet& errors = request.errors;
  check_judgement(request);
  const Eigen::MatrixXd covariance = request.covariance.size() > 0 ? request.covariance : stated_variances(errors);
  Making making{request, format, covariance, writer_request(request, format), errors, {}, {}};
  ControlTables made;
  made.format = &format;
  made.tolerance_mm = making.writer.tolerance_mm;
  made.tolerance_rad = making.writer.tolerance_rad;
  made.poses = travel_grid(machine, errors, judged_positions(machine, request.positions), made.grid);
  made.volumetric = volumetric_figures(machine, &errors, covariance, nullptr, stated_grid(machine, {&errors}));
  write_tables(making, made);
  made.settings = making.tables.remarks;
  const CommandCorrection& correction = *making.tables.correction;
  made.before = deviations_with(machine, errors, made.poses, NoCorrection());
  made.after = deviations_with(machine, errors, made.poses, correction);
  made.left_by_tables = volumetric_error_with(machine, errors, made.poses, correction);
  if (!request.over.empty()) made.over_states = loss_over_states(request, made.poses, correction);
  made.ideal = ideal_deviations(machine, errors, made.poses, made.ideal_not_reached);
  made.errors = what_is_carried(making);
  made.reversals = reversal_notes(machine, making.carried, format, making.writer);
  judge(making, made);
  if (!made.says_no()) made.files = std::move(making.tables.files);
  return made;
}

}  // namespace abbe
