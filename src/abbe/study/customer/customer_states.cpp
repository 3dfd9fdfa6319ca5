#include "abbe/study/customer/customer_states.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "abbe/errors/error_states.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/identify/trust/prediction.h"
#include "abbe/report/customer/customer_notes.h"
#include "abbe/report/customer/customer_words.h"
#include "abbe/study/identification/state_ranges.h"

namespace abbe {
namespace {

/// A reference of a given state that errors use, and the range of it in the readings; null: not stated.
struct ReportedState {
  std::string column;
  double reference = 0;
  const CoveredState* covered = nullptr;

  bool is_outside() const { return covered != nullptr && !covered->contains(reference); }
  std::string range() const {
    return fmt::format("{} to {}", shortest_text(covered->from), shortest_text(covered->to));
  }
};

std::vector<ReportedState> reported_states(const Machine& machine, const ErrorsFile& file) {
  std::vector<ReportedState> states;
  const std::vector<std::uint8_t> used = used_states(machine, file.errors);
  for (std::size_t j = 0; j < used.size(); ++j) {
    const MachineState& state = machine.states[j];
    if (used[j] == 0 || !is_input(state.kind)) continue;
    ReportedState& one = states.emplace_back(ReportedState{state_column(state), state.reference});
    for (const CoveredState& covered : file.covered) {
      if (covered.column == one.column) one.covered = &covered;
    }
  }
  return states;
}

/// Names of errors whose states follow from commands or motions alone, or from these as well.
std::string errors_that_follow(const Machine& machine, const ErrorSet& errors) {
  std::vector<std::string> names;
  const auto note = [&](std::size_t state, const std::string& name) {
    if (state == kNoState || is_input(machine.states[state].kind)) return;
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const ErrorMotion& motion : errors.motions) {
    note(motion.state, error_motion_name(machine, motion.axis, motion.component, motion.state));
  }
  for (const LocationError& location : errors.locations) {
    note(location.state, location_error_name(machine, location.axis, location.component, location.state));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Why nothing is proven of a state; empty: verdicts are given.
/// @param outside  references of states that the readings did not cover
std::string without_verdict(bool is_refused, bool is_simulated, const std::string& outside, ReportLanguage language) {
  if (is_refused) return std::string(customer_word(CustomerWord::without_trust, language));
  if (is_simulated) return std::string(customer_word(CustomerWord::without_simulation, language));
  if (outside.empty()) return {};
  const std::string note = fmt::format("Outside the states that the readings cover: {}.", outside);
  return customer_note(note, language).value_or(note);
}

}  // namespace

ErrorsFile identified_for_customer(const Study& study, const StudyResult& result) {
  ErrorsFile file;
  file.errors = result.identification.errors;
  file.covariance = machine_covariance(result.identification, file.errors.parameter_count());
  if (has_states(file.errors)) file.covered = covered_states(study, result);
  return file;
}

ErrorsFile errors_for_customer(const Machine& machine, ErrorsFile file) {
  if (!has_states(file.errors)) return file;
  Eigen::MatrixXd by_parameters;
  file.errors = at_state(machine, file.errors, reference_states(machine), &by_parameters);
  if (file.covariance.size() > 0) file.covariance = by_parameters * file.covariance * by_parameters.transpose();
  return file;
}

std::string references_not_covered(const Machine& machine, const ErrorsFile& file) {
  std::string words;
  for (const ReportedState& one : reported_states(machine, file)) {
    if (!one.is_outside()) continue;
    words += fmt::format("{}{} = {} (readings: {})", words.empty() ? "" : ", ", one.column,
                         shortest_text(one.reference), one.range());
  }
  return words;
}

std::vector<std::string> customer_state_notes(const Machine& machine, const ErrorsFile& file) {
  std::vector<std::string> notes;
  std::string references, ranges;
  for (const ReportedState& one : reported_states(machine, file)) {
    references += fmt::format("{}{} = {}", references.empty() ? "" : ", ", one.column, shortest_text(one.reference));
    if (one.covered == nullptr) continue;
    ranges += fmt::format("{}{} {}", ranges.empty() ? "" : ", ", one.column, one.range());
  }
  if (!references.empty()) notes.push_back(fmt::format("The figures hold at the state {}.", references));
  if (!ranges.empty()) {
    notes.push_back(fmt::format(
        "The readings cover {}; beyond, errors are extrapolated: their uncertainty grows with the distance, "
        "and nothing is proven.",
        ranges));
  }
  const std::string outside = references_not_covered(machine, file);
  if (!outside.empty()) notes.push_back(fmt::format("Outside the states that the readings cover: {}.", outside));
  const std::string follow = errors_that_follow(machine, file.errors);
  if (!follow.empty()) {
    notes.push_back(fmt::format(
        "States that follow from the commands are in the volumetric error; the other figures hold where the "
        "factors of these errors are zero: {}.",
        follow));
  }
  return notes;
}

std::vector<CustomerState> customer_states(const Study& study, const StudyResult& result, bool is_refused,
                                           ReportLanguage language) {
  const auto word = [&](CustomerWord what) { return std::string(customer_word(what, language)); };
  const std::string now =
      without_verdict(is_refused, result.campaign.truth.has_value(),
                      references_not_covered(study.machine, identified_for_customer(study, result)), language);
  if (!result.before) {
    return {{word(CustomerWord::measured), now},
            {word(CustomerWord::predicted_after), word(CustomerWord::without_measurement)}};
  }
  const ErrorsFile& before = result.before->errors;
  const bool was_refused = !before.distrusted.empty() && !before.misfit_accepted;
  return {{word(CustomerWord::before), without_verdict(was_refused, result.before->is_simulated,
                                                       references_not_covered(study.machine, before), language)},
          {word(CustomerWord::after), now}};
}

}  // namespace abbe
