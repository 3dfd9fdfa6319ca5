#include "abbe/study/found_values.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/geometry/rotation.h"
#include "abbe/identify/parameter_words.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/tracker_observations.h"
#include "abbe/instruments/tracker_residual.h"
#include "abbe/study/job.h"

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
    FoundNumber found{name, {}, is_angle, value, 0, true};
    if (const std::optional<Eigen::Index> entry = find(id)) {
      found.expanded_uncertainty = twice_root(identified_.covariance(*entry, *entry));
      found.is_fixed = !(found.expanded_uncertainty > 0);
    }
    return found;
  }

 private:
  const Identification& identified_;
};

/// Poses of the stations; everything else of a tracker are numbers.
void add_stations(const TrackerObservations& observations, std::size_t s, const Identification& identified,
                  const Estimates& estimates, FoundSetup& found) {
  const TrackerSetup setup = observations.setup();
  const std::vector<SetupUnknown>& unknowns = observations.unknowns();
  std::size_t next = 0;
  for (const TrackerStation& station : setup.stations) {
    if (!station.estimate_pose) continue;
    FoundPlace place;
    place.name = station.name;
    place.body = station.body;
    place.position = station.body_from_tracker.translation;
    place.rotation = station.body_from_tracker.rotation;
    const std::vector<double>& values = identified.setup[s];
    const Eigen::Matrix3d axes = rotation_vector_axes({values[next + 3], values[next + 4], values[next + 5]});
    std::vector<Eigen::Index> entries;
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(6, 0);
    for (std::size_t k = 0; k < 6; ++k) {
      const std::optional<Eigen::Index> entry = estimates.find({s, next + k});
      if (!entry) continue;
      entries.push_back(*entry);
      rows.conservativeResize(Eigen::NoChange, rows.cols() + 1);
      const Eigen::Index row = static_cast<Eigen::Index>(k);
      rows.rightCols<1>().setZero();
      if (k < 3) {
        rows.rightCols<1>()[row] = 1;
      } else {
        rows.rightCols<1>().tail<3>() = axes.col(row - 3);
      }
    }
    const Eigen::VectorXd expanded = estimates.expanded(rows, entries);
    place.position_expanded = expanded.head<3>();
    place.turn_expanded = expanded.tail<3>();
    found.places.push_back(std::move(place));
    next += 6;
  }
  for (std::size_t u = next; u < unknowns.size(); ++u) {
    found.numbers.push_back(estimates.number(unknowns[u].name, {s, u}, unknowns[u].is_angle, identified.setup[s][u]));
  }
}

/// Position and turn of a place as six numbers beside another state of it: mm, rad.
Eigen::VectorXd difference(const InstrumentPlace& from, const InstrumentPlace& to) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(6);
  result.head<3>() = to.position - from.position;
  if (from.rotation) result.tail<3>() = rotation_vector(*to.rotation * from.rotation->transpose());
  if (from.direction) result.tail<3>() = from.direction->cross(*to.direction);
  return result;
}

void add_places(const InstrumentObservations& observations, std::size_t s, const Identification& identified,
                const Estimates& estimates, FoundSetup& found) {
  const std::vector<double> values = observations.quantity_values();
  const std::vector<SetupUnknown>& unknowns = observations.unknowns();
  const std::vector<InstrumentPlace> places = observations.instrument().with_values(values)->places();
  std::vector<std::uint8_t> angle_of_place(unknowns.size(), 0);
  for (std::size_t p = 0; p < places.size(); ++p) {
    const InstrumentPlace& place = places[p];
    std::vector<Eigen::Index> entries;
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(6, 0);
    for (std::size_t u = 0; u < unknowns.size(); ++u) {
      const std::size_t q = observations.quantity_of(u);
      if (std::find(place.quantities.begin(), place.quantities.end(), q) == place.quantities.end()) continue;
      angle_of_place[u] = 1;
      const std::optional<Eigen::Index> entry = estimates.find({s, u});
      if (!entry) continue;
      // A place is smooth on the scale of its quantities: mm, and mrad for angles.
      const double step = 1e-3 * unknowns[u].scale;
      std::vector<double> moved = values;
      moved[q] = values[q] + step;
      const InstrumentPlace after = observations.instrument().with_values(moved)->places()[p];
      moved[q] = values[q] - step;
      const InstrumentPlace before = observations.instrument().with_values(moved)->places()[p];
      entries.push_back(*entry);
      rows.conservativeResize(Eigen::NoChange, rows.cols() + 1);
      rows.rightCols<1>() = (difference(place, after) - difference(place, before)) / (2 * step);
    }
    if (entries.empty()) continue;
    const Eigen::VectorXd expanded = estimates.expanded(rows, entries);
    found.places.push_back({place.name, place.body, place.position, expanded.head<3>(), place.rotation, place.direction,
                            expanded.tail<3>()});
  }
  for (std::size_t u = 0; u < unknowns.size(); ++u) {
    if (angle_of_place[u] != 0) continue;
    found.numbers.push_back(estimates.number(unknowns[u].name, {s, u}, unknowns[u].is_angle, identified.setup[s][u]));
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
  std::size_t index = 0;
  for (const ErrorMotion& motion : errors.motions) index += motion.coefficients.size();
  for (const LocationError& location : errors.locations) {
    FoundNumber number =
        estimates.number(location_error_name(machine, location.axis, location.component),
                         {ParameterId::kMachine, index++}, is_rotation(location.component), location.value);
    number.words = error_words(machine, location.axis, location.component, true);
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
    setup.name = result.campaign.setups[s]->name;
    setup.instrument = study.setups[s].instrument;
    const Observations& observations = *result.model.problem.observations[s].observations;
    if (const auto* tracker = dynamic_cast<const TrackerObservations*>(&observations)) {
      add_stations(*tracker, s, identified, estimates, setup);
    } else if (const auto* instrument = dynamic_cast<const InstrumentObservations*>(&observations)) {
      add_places(*instrument, s, identified, estimates, setup);
    }
    if (!setup.places.empty() || !setup.numbers.empty()) found.setups.push_back(std::move(setup));
  }
  return found;
}

}  // namespace abbe
