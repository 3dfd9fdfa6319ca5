#include "abbe/instruments/instrument.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

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

}  // namespace

const char* body_name(Body body) { return body == Body::bed ? "bed" : body == Body::workpiece ? "workpiece" : "tool"; }

void InstrumentReadings::append(const std::vector<double>& positions, std::size_t on_item,
                                const std::vector<double>& known) {
  poses.append(positions);
  item.push_back(static_cast<std::uint16_t>(on_item));
  inputs.resize(known.size());
  for (std::size_t i = 0; i < known.size(); ++i) inputs[i].push_back(known[i]);
}

void InstrumentReadings::append(const InstrumentReadings& more) {
  join_labels(point_name, count(), more.point_name, more.count());
  join_poses(poses, more.poses);
  item.insert(item.end(), more.item.begin(), more.item.end());
  append_columns(inputs, more.inputs);
  append_columns(measured, more.measured);
  append_columns(uncertainty, more.uncertainty);
  const double after = time_s.empty() ? 0 : time_s.back();
  for (const double time : more.time_s) time_s.push_back(after + time);
}

InstrumentReadings InstrumentReadings::subset(const std::vector<std::size_t>& readings) const {
  InstrumentReadings part;
  for (const std::size_t k : readings) part.item.push_back(item[k]);
  for (const std::vector<double>& axis : poses.axis) part.poses.axis.push_back(picked(axis, readings));
  for (const std::vector<std::int8_t>& sides : poses.approach) {
    std::vector<std::int8_t>& picked_sides = part.poses.approach.emplace_back();
    for (const std::size_t k : readings) picked_sides.push_back(sides[k]);
  }
  for (const std::vector<double>& column : inputs) part.inputs.push_back(picked(column, readings));
  for (const std::vector<double>& column : measured) part.measured.push_back(picked(column, readings));
  for (const std::vector<double>& column : uncertainty) part.uncertainty.push_back(picked(column, readings));
  if (!time_s.empty()) part.time_s = picked(time_s, readings);
  for (const std::size_t k : readings) {
    if (!point_name.empty()) part.point_name.push_back(point_name[k]);
  }
  return part;
}

std::vector<double> Instrument::start_values(const Machine&, const InstrumentReadings&,
                                             std::vector<std::string>&) const {
  std::vector<double> values;
  for (const SetupQuantity& quantity : quantities_) values.push_back(quantity.value);
  return values;
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

std::size_t Instrument::item_at(const Machine&, std::size_t target, const std::vector<double>&) const { return target; }

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
  if (count == 0) throw std::invalid_argument(instrument.name() + ": no readings");
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
  check_columns(readings.inputs, instrument.inputs().size(), count, "inputs");
  if (measured) {
    check_columns(readings.measured, instrument.components().size(), count, "measured values");
    if (!readings.uncertainty.empty()) {
      check_columns(readings.uncertainty, instrument.components().size(), count, "standard uncertainties");
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
