#include "abbe/controls/kinematic_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/controls/believed_correction.h"
#include "abbe/controls/kinematic_format.h"
#include "abbe/controls/travel_grid.h"
#include "abbe/errors/calibrated_machine.h"
#include "abbe/errors/error_states.h"
#include "abbe/errors/errors_at_pose.h"
#include "abbe/formats/machine/correction_limits.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_couplings.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

/// With the values the displacement may be larger by this share before they are refused.
constexpr double kLarger = 0.02;
constexpr double kNothingThere = 1e-6;  // mm, root mean square

const KinematicFormat& kinematic_format(const std::string& name) {
  std::string names;
  for (const KinematicFormat& format : all_kinematic_formats()) {
    if (format.name == name) return format;
    names += (names.empty() ? "" : ", ") + format.name;
  }
  throw InputError({.field = "--for"}, fmt::format("unknown format '{}'", name), names);
}

void check_values_request(const KinematicValuesRequest& request, const KinematicFormat& format) {
  check_refusal(request.limit_mm, request.limit_rad, request.least_reduction);
  if (!request.tool_carrier) return;
  if (!format.takes_tool_carrier) {
    throw InputError({.field = "--tool-carrier"}, fmt::format("would change nothing in values for {}", format.name),
                     "--for siemens; or to leave it out");
  }
  if (*request.tool_carrier < 1 || *request.tool_carrier > 999) {
    throw InputError({.field = "--tool-carrier"}, "out of range", "the number of a tool carrier, 1 to 999");
  }
}

/// [axes] where the axes stand for states that follow from commands.
std::vector<double> state_pose(const KinematicValuesRequest& request) {
  std::vector<double> pose;
  for (const Axis& axis : request.machine.axes) {
    pose.push_back(axis.endless ? 0.0 : 0.5 * (axis.travel_min + axis.travel_max));
  }
  for (const HeldAxis& at : request.at) pose.at(at.axis) = at.position;
  return pose;
}

/// What becomes of a set of errors in the values of a format. A control has one geometry for all poses: errors whose
/// states follow from the commands are taken at one of them.
class ValuesOfErrors {
 public:
  ValuesOfErrors(const KinematicFormat& format, const KinematicValuesRequest& request)
      : format_(format),
        carrier_(request.tool_carrier),
        state_pose_(state_pose(request)),
        nominal_{request.machine, std::vector<double>(request.machine.axes.size(), 0.0)} {}

  std::vector<PlainValue> plain(const ErrorSet& errors) const {
    CalibratedMachine calibrated = calibrated_machine(nominal_.machine, at_pose(nominal_.machine, errors, state_pose_));
    for (std::size_t i = 0; i < calibrated.zero.size(); ++i) {
      if (nominal_.machine.axes[i].kind != AxisKind::rotary) calibrated.zero[i] = 0;
    }
    return format_.values(nominal_, {std::move(calibrated.machine), std::move(calibrated.zero)}, carrier_);
  }
  std::vector<KinematicValue> values(const ErrorSet& errors) const {
    const std::vector<PlainValue> without = plain({}), with = plain(errors);
    std::vector<KinematicValue> values;
    for (std::size_t k = 0; k < with.size(); ++k) {
      // 0.0 is added so that no zero is negative.
      values.push_back({with[k].name, with[k].kind, without[k].value + 0.0, with[k].value, std::nullopt});
    }
    return values;
  }
  std::string text(const std::vector<KinematicValue>& values) const { return format_.text(nominal_, values, carrier_); }
  NamedNumbers read(const std::string& text) const { return format_.read(text); }
  /// What a control with this file adds to the commands of a program for the nominal machine.
  std::unique_ptr<CommandCorrection> correction(const NamedNumbers& numbers) const {
    return std::make_unique<BelievedCorrection>(nominal_.machine, format_.believed(nominal_, numbers, carrier_));
  }
  std::unique_ptr<CommandCorrection> correction_of(const ErrorSet& errors) const {
    return correction(read(text(values(errors))));
  }
  std::vector<std::string> settings() const { return format_.settings(nominal_); }

 private:
  const KinematicFormat& format_;
  std::optional<int> carrier_;
  std::vector<double> state_pose_;
  BelievedMachine nominal_;
};

void add_uncertainties(const ValuesOfErrors& values, const KinematicValuesRequest& request,
                       const Eigen::MatrixXd& covariance, KinematicValues& made) {
  if (covariance.size() == 0) return;
  const std::vector<double> uncertainty =
      propagated_uncertainty(request.errors, covariance, [&](const ErrorSet& errors) {
        std::vector<double> numbers;
        for (const PlainValue& value : values.plain(errors)) numbers.push_back(value.value);
        return numbers;
      });
  for (std::size_t k = 0; k < made.values.size(); ++k) made.values[k].standard_uncertainty = uncertainty[k];
}

void check_value_limits(const KinematicValuesRequest& request, KinematicValues& made) {
  for (const KinematicValue& value : made.values) {
    const bool angle = value.kind != ValueKind::length;
    const std::optional<double>& limit = angle ? request.limit_rad : request.limit_mm;
    const double change = std::abs(value.actual - value.nominal);
    if (!limit || change <= *limit) continue;
    const double scale = micro_per_unit(angle);
    const char* const unit = micro_unit(angle);
    made.refused.push_back(fmt::format("a change of {:.3f} {} is above --limit-{} {:g}: {}", scale * change, unit, unit,
                                       scale * *limit, value.name));
  }
}

void judge_values(const KinematicValuesRequest& request, KinematicValues& made) {
  check_value_limits(request, made);
  const double before = made.before.position_statistics.rms, after = made.after.position_statistics.rms;
  if (after > (1 + kLarger) * before + kNothingThere) {
    made.refused.push_back(
        fmt::format("the displacement of the tool would be larger with the values than without: {:.3f} "
                    "instead of {:.3f} um rms",
                    1e3 * after, 1e3 * before));
    return;
  }
  const double least = request.least_reduction;
  if (!(least > 0) || before < kNothingThere || before - after >= least * before) return;
  const bool one_is = std::any_of(made.errors.begin(), made.errors.end(), [&](const CarriedError& error) {
    return error.effect_before - error.effect_after >= least * before;
  });
  if (one_is) return;
  made.refused.push_back(fmt::format(
      "the values would remove {:.2g} % of the displacement ({:.3f} to {:.3f} um rms), less than "
      "--least-reduction-percent {:g}: most errors are not of the kind that {} carries",
      std::max(0.0, 100 * (before - after) / before), 1e3 * before, 1e3 * after, 100 * least, made.format.name));
}

}  // namespace

KinematicValues make_kinematic_values(const KinematicValuesRequest& request) {
  refuse_couplings(request.machine, "a kinematic value of a control");
  refuse_states(request.machine, request.errors, "a kinematic value of a control", UsableStates::of_commands);
  const KinematicFormat& format = kinematic_format(request.format);
  check_values_request(request, format);
  const Machine& machine = request.machine;
  const ErrorSet& errors = request.errors;
  const Eigen::MatrixXd covariance = request.covariance.size() > 0 ? request.covariance : stated_variances(errors);
  const ValuesOfErrors values(format, request);
  KinematicValues made;
  made.format = format;
  if (has_states(errors)) made.state_pose = state_pose(request);
  made.values = values.values(errors);
  made.settings = values.settings();
  add_uncertainties(values, request, covariance, made);
  const std::string text = values.text(made.values);
  const NamedNumbers numbers = values.read(text);
  for (KinematicValue& value : made.values) value.actual = numbers.at(value.name) + 0.0;

  made.poses = travel_grid(machine, errors, judged_positions(machine, request.positions), made.grid);
  made.volumetric = volumetric_figures(machine, &errors, covariance, nullptr, stated_grid(machine, {&errors}));
  const std::unique_ptr<CommandCorrection> correction = values.correction(numbers);
  made.before = deviations_with(machine, errors, made.poses, NoCorrection());
  made.after = deviations_with(machine, errors, made.poses, *correction);
  if (!made.state_pose.empty()) {
    made.after_at_state_pose =
        deviations_with(machine, at_pose(machine, errors, made.state_pose), made.poses, *correction);
  }
  made.left_by_values = volumetric_error_with(machine, errors, made.poses, *correction);
  made.ideal = ideal_deviations(machine, errors, made.poses, made.ideal_not_reached);
  std::vector<std::size_t> unused;
  const PoseList few = travel_grid(machine, errors, machine.axes.size() > 3 ? 3 : 5, unused);
  made.errors =
      carried_errors(machine, errors, few, [&](const ErrorSet& alone) { return values.correction_of(alone); });
  judge_values(request, made);
  made.file = {format.file_name, made.says_no() ? std::string() : text};
  return made;
}

}  // namespace abbe
