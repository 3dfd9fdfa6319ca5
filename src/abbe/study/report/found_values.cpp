#include "abbe/study/report/found_values.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/geometry/rotation.h"
#include "abbe/identify/parameter_words.h"
#include "abbe/instruments/instrument.h"
#include "abbe/study/study_result.h"

namespace abbe {
namespace {

double twice_root(double variance) { return 2 * std::sqrt(std::max(variance, 0.0)); }

/// The estimates of one identification by what they are.
class Estimates {
 public:
  explicit Estimates(const Identification& identified) : identified_(identified) {}

  /// Entry of an estimate, or nothing for what was not estimated.
  std::optional<Eigen::Index> find(const ParameterId& id) const {
    const auto& all = identified_.parameters;
    const auto at =
        std::find_if(all.begin(), all.end(), [&](const EstimatedParameter& parameter) { return parameter.id == id; });
    if (at == all.end()) return std::nullopt;
    return at - all.begin();
  }

  /// Expanded uncertainties of functions of some estimates.
  /// @param rows  [functions, entries]: derivatives
  Eigen::VectorXd expanded(const Eigen::MatrixXd& rows, const std::vector<Eigen::Index>& entries) const {
    Eigen::MatrixXd part(rows.cols(), rows.cols());
    for (std::size_t i = 0; i < entries.size(); ++i) {
      for (std::size_t j = 0; j < entries.size(); ++j) {
        part(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            identified_.covariance(entries[i], entries[j]);
      }
    }
    Eigen::VectorXd result(rows.rows());
    for (Eigen::Index r = 0; r < rows.rows(); ++r) result[r] = twice_root(rows.row(r) * part * rows.row(r).transpose());
    return result;
  }

  FoundNumber number(const std::string& name, const ParameterId& id, bool is_angle, double value) const {
    FoundNumber found{name, {}, is_angle, value, 0, true, false};
    if (const std::optional<Eigen::Index> entry = find(id)) {
      found.expanded_uncertainty = twice_root(identified_.covariance(*entry, *entry));
      found.is_fixed = !(found.expanded_uncertainty > 0);
    }
    return found;
  }

 private:
  const Identification& identified_;
};

void add_places(const Instrument& start, std::size_t s, const Identification& identified, const Estimates& estimates,
                FoundSetup& found) {
  const std::vector<SetupQuantity>& quantities = start.quantities();
  const std::vector<double>& unknowns = identified.setup[s];
  std::vector<double> values;
  std::vector<std::size_t> quantity_of;
  for (std::size_t q = 0; q < quantities.size(); ++q) {
    const bool is_exact = quantities[q].knowledge == Knowledge::exact;
    values.push_back(is_exact ? quantities[q].value : unknowns[quantity_of.size()]);
    if (!is_exact) quantity_of.push_back(q);
  }
  const std::shared_ptr<const Instrument> device = start.with_values(values);
  const std::vector<InstrumentPlace> places = device->places();
  std::vector<std::uint8_t> is_of_place(unknowns.size(), 0);
  for (std::size_t p = 0; p < places.size(); ++p) {
    const InstrumentPlace& place = places[p];
    std::vector<Eigen::Index> entries;
    std::vector<std::size_t> estimated;
    for (std::size_t u = 0; u < quantity_of.size(); ++u) {
      const std::size_t q = quantity_of[u];
      if (std::find(place.quantities.begin(), place.quantities.end(), q) == place.quantities.end()) continue;
      is_of_place[u] = 1;
      const std::optional<Eigen::Index> entry = estimates.find({s, u});
      if (!entry) continue;
      entries.push_back(*entry);
      estimated.push_back(q);
    }
    if (entries.empty()) continue;
    const Eigen::VectorXd expanded = estimates.expanded(device->place_slopes(p, estimated), entries);
    found.places.push_back({place.name, place.body, place.position, expanded.head<3>(), place.rotation, place.direction,
                            expanded.tail<3>()});
  }
  for (std::size_t u = 0; u < quantity_of.size(); ++u) {  // behind them: its drift
    if (is_of_place[u] != 0) continue;
    const SetupQuantity& quantity = quantities[quantity_of[u]];
    found.numbers.push_back(estimates.number(quantity.name, {s, u}, quantity.is_angle, unknowns[u]));
    found.numbers.back().is_pure_number = quantity.is_pure_number;
  }
}

}  // namespace

Eigen::Vector3d FoundPlace::angles() const { return error_angles_from_rotation(*rotation); }

FoundValues found_values(const Study& study, const StudyResult& result) {
  const Machine& machine = study.machine;
  const Identification& identified = result.identification;
  const ErrorSet& errors = identified.errors;
  const Estimates estimates(identified);
  FoundValues found;
  found.expansions = found_expansions(study, result);
  std::size_t index = 0;
  for (const ErrorMotion& motion : errors.motions) index += motion.coefficients.size();
  for (const LocationError& location : errors.locations) {
    FoundNumber number =
        estimates.number(location_error_name(machine, location.axis, location.component, location.state),
                         {ParameterId::kMachine, index++}, is_rotation(location.component), location.value);
    number.words = error_words(machine, location.axis, location.component, true);
    if (location.state != kNoState)
      number.words += ", per " + factor_unit(machine, location.state) + " of " + machine.states[location.state].name;
    found.locations.push_back(std::move(number));
  }
  for (const Reversal& reversal : errors.reversals) {
    FoundNumber number = estimates.number(reversal_name(machine, reversal.axis), {ParameterId::kMachine, index++},
                                          machine.axes[reversal.axis].kind == AxisKind::rotary, reversal.value);
    number.words = "reversal value of " + machine.axes[reversal.axis].name;
    found.reversals.push_back(std::move(number));
  }
  if (study.identification->tool_offset) {
    const char* const names[] = {"tool_X", "tool_Y", "tool_Z"};
    for (int k = 0; k < 3; ++k) {
      found.tool.push_back(
          estimates.number(names[k], {ParameterId::kMachine, index++}, false, errors.tool_offset_error[k]));
      found.tool.back().words = std::string("error of the tool offset in ") + "XYZ"[k];
    }
    found.tool_offset = machine.tool_offset + errors.tool_offset_error;
  }
  for (std::size_t s = 0; s < result.model.problem.observations.size(); ++s) {
    FoundSetup setup;
    setup.name = result.campaign.setups[s].name;
    setup.instrument = study.setups[s].instrument;
    add_places(*result.campaign.setups[s].start, s, identified, estimates, setup);
    if (!setup.places.empty() || !setup.numbers.empty()) found.setups.push_back(std::move(setup));
  }
  return found;
}

}  // namespace abbe
