#include "abbe/instruments/instrument.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/instrument_simulation.h"

namespace abbe {
namespace {

void append_columns(std::vector<std::vector<double>>& all, const std::vector<std::vector<double>>& more) {
  if (all.empty()) all.resize(more.size());
  for (std::size_t i = 0; i < more.size(); ++i) all[i].insert(all[i].end(), more[i].begin(), more[i].end());
}

std::vector<double> picked(const std::vector<double>& values, const std::vector<std::size_t>& readings) {
  std::vector<double> result;
  result.reserve(readings.size());
  for (const std::size_t k : readings) result.push_back(values[k]);
  return result;
}

void check_columns(const std::vector<std::vector<double>>& columns, std::size_t expected, std::size_t count,
                   const char* what) {
  if (columns.size() != expected) {
    throw std::invalid_argument(fmt::format("{}: {} columns, expected {}", what, columns.size(), expected));
  }
  for (const std::vector<double>& column : columns) {
    if (column.size() != count) {
      throw std::invalid_argument(fmt::format("{}: {} values, expected {}", what, column.size(), count));
    }
    for (std::size_t k = 0; k < count; ++k) {
      if (!std::isfinite(column[k])) throw std::invalid_argument(fmt::format("reading {}: {} is not finite", k, what));
    }
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

}  // namespace

const char* body_name(Body body) { return body == Body::bed ? "bed" : body == Body::workpiece ? "workpiece" : "tool"; }

void InstrumentReadings::append(const std::vector<double>& positions, std::size_t on_item,
                                const std::vector<double>& known) {
  poses.append(positions);
  item.push_back(static_cast<std::uint16_t>(on_item));
  inputs.resize(known.size());
  for (std::size_t i = 0; i < known.size(); ++i) inputs[i].push_back(known[i]);
}

void InstrumentReadings::append(const InstrumentReadings& more, bool same_clock) {
  join_labels(point_name, count(), more.point_name, more.count());
  join_poses(poses, more.poses);
  item.insert(item.end(), more.item.begin(), more.item.end());
  append_columns(inputs, more.inputs);
  append_columns(measured, more.measured);
  append_columns(uncertainty, more.uncertainty);
  append_columns(covariance, more.covariance);
  const double after = same_clock || time_s.empty() ? 0 : time_s.back();
  for (const double time : more.time_s) time_s.push_back(after + time);
  if (drift == nullptr) drift = more.drift;
}

InstrumentReadings InstrumentReadings::subset(const std::vector<std::size_t>& readings) const {
  InstrumentReadings part;
  for (const std::size_t k : readings) part.item.push_back(item[k]);
  for (const std::vector<double>& axis : poses.axis) part.poses.axis.push_back(picked(axis, readings));
  for (const std::vector<std::int8_t>& sides : poses.approach) {
    std::vector<std::int8_t>& picked_sides = part.poses.approach.emplace_back();
    for (const std::size_t k : readings) picked_sides.push_back(sides[k]);
  }
  for (const std::vector<double>& values : poses.state) {
    part.poses.state.push_back(values.empty() ? values : picked(values, readings));
  }
  for (const std::vector<double>& column : inputs) part.inputs.push_back(picked(column, readings));
  for (const std::vector<double>& column : measured) part.measured.push_back(picked(column, readings));
  for (const std::vector<double>& column : uncertainty) part.uncertainty.push_back(picked(column, readings));
  for (const std::vector<double>& column : covariance) part.covariance.push_back(picked(column, readings));
  if (!time_s.empty()) part.time_s = picked(time_s, readings);
  for (const std::size_t k : readings) {
    if (!point_name.empty()) part.point_name.push_back(point_name[k]);
  }
  part.drift = drift;
  return part;
}

std::vector<double> Instrument::start_values(const Machine&, const InstrumentReadings&,
                                             std::vector<std::string>&) const {
  std::vector<double> values;
  for (const SetupQuantity& quantity : quantities_) values.push_back(quantity.value);
  return values;
}

StartedInstrument Instrument::started(const Machine& machine, const InstrumentReadings& readings) const {
  StartedInstrument result;
  result.instrument = with_values(start_values(machine, readings, result.warnings));
  return result;
}

std::shared_ptr<const Instrument> Instrument::truth(RandomStream& random) const {
  std::vector<double> values;
  for (const SetupQuantity& quantity : quantities_) {
    const double drawn = quantity.value + quantity.standard_uncertainty * random.normal();
    values.push_back(quantity.truth.value_or(quantity.knowledge == Knowledge::within ? drawn : quantity.value));
  }
  return with_values(values);
}

std::shared_ptr<const Instrument> Instrument::as_planned() const {
  std::vector<double> values;
  for (const SetupQuantity& quantity : quantities_) values.push_back(quantity.truth.value_or(quantity.value));
  return with_values(values);
}

std::unique_ptr<Observations> Instrument::observations(const Machine& machine, const ErrorSet& errors,
                                                       const InstrumentReadings& readings) const {
  return std::make_unique<InstrumentObservations>(machine, errors, shared_from_this(), readings);
}

std::unique_ptr<Observations> Instrument::observations_in_um(const Machine& machine, const ErrorSet& errors,
                                                             InstrumentReadings readings) const {
  readings.uncertainty.assign(components_.size(), std::vector<double>(readings.count(), 1e-3));
  readings.covariance.clear();
  return observations(machine, errors, readings);
}

SimulatedInstrument Instrument::simulate(const Machine& machine, const ErrorSet& errors, const InstrumentReadings& plan,
                                         const InstrumentSimulationOptions& options) const {
  return simulate_instrument(machine, errors, shared_from_this(), plan, options);
}

std::vector<ItemLabel> Instrument::item_labels() const {
  ItemLabel label{"target", {}, {}};
  for (const InstrumentItem& item : items_) {
    label.of_item.push_back(static_cast<std::uint16_t>(label.names.size()));
    label.names.push_back(item.name);
  }
  return {std::move(label)};
}

std::vector<double> Instrument::deviation_arms(const InstrumentReadings&) const {
  return std::vector<double>(components_.size(), 1.0);
}

Eigen::MatrixXd Instrument::place_slopes(std::size_t place, const std::vector<std::size_t>& quantities) const {
  std::vector<double> values;
  for (const SetupQuantity& quantity : quantities_) values.push_back(quantity.value);
  const InstrumentPlace present = places()[place];
  Eigen::MatrixXd slopes(6, static_cast<Eigen::Index>(quantities.size()));
  for (std::size_t i = 0; i < quantities.size(); ++i) {
    const std::size_t q = quantities[i];
    const double step = 1e-3 * quantities_[q].scale;
    std::vector<double> moved = values;
    moved[q] = values[q] + step;
    const InstrumentPlace after = with_values(moved)->places()[place];
    moved[q] = values[q] - step;
    const InstrumentPlace before = with_values(moved)->places()[place];
    slopes.col(static_cast<Eigen::Index>(i)) = (difference(present, after) - difference(present, before)) / (2 * step);
  }
  return slopes;
}

std::optional<MeetingPoints> Instrument::meeting_points(std::size_t) const { return std::nullopt; }

std::vector<std::vector<double>> Instrument::planned_inputs(std::size_t) const {
  return {std::vector<double>(inputs_.size(), 0.0)};
}

std::vector<std::string> Instrument::target_names() const {
  std::vector<std::string> names;
  for (const InstrumentItem& item : items_) names.push_back(item.name);
  return names;
}

std::size_t Instrument::item_at(const Machine&, std::size_t target, std::size_t, const std::vector<double>&) const {
  return target;
}

void Instrument::set_values(const std::vector<double>& values) {
  for (std::size_t i = 0; i < quantities_.size(); ++i) quantities_[i].value = values.at(i);
}

std::size_t Instrument::add(SetupQuantity quantity) {
  quantities_.push_back(std::move(quantity));
  return quantities_.size() - 1;
}

std::array<std::size_t, 3> Instrument::add(const std::string& name, const SetupPoint& point) {
  std::array<std::size_t, 3> indices{};
  for (std::size_t i = 0; i < 3; ++i) {
    indices[i] = add(quantity(name + "." + "xyz"[i], false, point.coordinate[i]));
  }
  return indices;
}

std::size_t Instrument::add(InstrumentItem item) {
  items_.push_back(std::move(item));
  return items_.size() - 1;
}

void check_readings(const Machine& machine, const Instrument& instrument, const InstrumentReadings& readings,
                    bool measured) {
  const std::size_t count = readings.count();
  for (const InstrumentItem& item : instrument.items()) {
    if (item.from == item.to) {
      throw std::invalid_argument(fmt::format("{}: both ends of {} are on one body", instrument.name(), item.name));
    }
  }
  check_columns(readings.poses.axis, machine.axes.size(), count, "axis commands");
  for (const std::vector<std::int8_t>& sides : readings.poses.approach) {
    if (sides.size() != count || readings.poses.approach.size() != machine.axes.size()) {
      throw std::invalid_argument(instrument.name() + ": sides of approach, not one per axis and reading");
    }
  }
  for (const std::vector<double>& values : readings.poses.state) {
    if (readings.poses.state.size() != machine.states.size() || (!values.empty() && values.size() != count)) {
      throw std::invalid_argument(instrument.name() + ": values of states, not one per state and reading");
    }
  }
  check_columns(readings.inputs, instrument.inputs().size(), count, "inputs");
  if (measured) {
    check_columns(readings.measured, instrument.components().size(), count, "measured values");
    if (!readings.uncertainty.empty()) {
      check_columns(readings.uncertainty, instrument.components().size(), count, "standard uncertainties");
    }
    if (!readings.covariance.empty()) {
      const std::size_t components = instrument.components().size();
      check_columns(readings.covariance, components * (components + 1) / 2, count, "elements of covariances");
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (readings.item[k] >= instrument.items().size()) {
      throw std::invalid_argument(
          fmt::format("reading {}: item {} of {}", k, readings.item[k], instrument.items().size()));
    }
    for (const std::vector<double>& column : readings.uncertainty) {
      if (!(column[k] > 0)) throw std::invalid_argument(fmt::format("reading {}: standard uncertainty not above 0", k));
    }
  }
}

}  // namespace abbe
