#include "abbe/formats/readings/instrument_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/readings/axis_columns.h"
#include "abbe/formats/readings/component_columns.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {
namespace {

std::string all_of(const std::vector<std::string>& targets) {
  std::string names;
  for (const std::string& target : targets) names += (names.empty() ? "" : ", ") + target;
  return names;
}

/// Index of every reading's target.
std::vector<std::size_t> take_targets(std::string_view text, const std::string& file, const Instrument& instrument,
                                      const CsvValues& column, std::size_t rows) {
  const std::vector<std::string> targets = instrument.target_names();
  if (!column.present) {
    if (targets.size() == 1) return std::vector<std::size_t>(rows, 0);
    throw InputError({file, 0, 0, "item"}, "missing column", "item, with one of " + all_of(targets) + " in every row");
  }
  std::vector<std::size_t> index_of_name;
  for (const std::string& name : column.names) {
    index_of_name.push_back(
        static_cast<std::size_t>(std::find(targets.begin(), targets.end(), name) - targets.begin()));
  }
  std::vector<std::size_t> result(rows);
  for (std::size_t row = 0; row < rows; ++row) {
    result[row] = index_of_name[column.words[row]];
    if (result[row] < targets.size()) continue;
    throw InputError({file, csv_line(text, row), 0, column.header},
                     fmt::format("{} has no item '{}'", instrument.name(), column.names[column.words[row]]),
                     "one of " + all_of(targets));
  }
  return result;
}

/// Index of every reading's item.
std::vector<std::uint16_t> take_items(std::string_view text, const std::string& file, const Machine& machine,
                                      const Instrument& instrument, const std::vector<std::size_t>& targets,
                                      const PoseList& poses) {
  std::vector<std::uint16_t> items(targets.size());
  for (std::size_t row = 0; row < targets.size(); ++row) {
    try {
      items[row] = static_cast<std::uint16_t>(instrument.item_at(machine, targets[row], 0, poses.pose(row)));
    } catch (const std::invalid_argument& error) {
      throw InputError({file, csv_line(text, row), 0, "item"},
                       fmt::format("{}: {}", instrument.target_names()[targets[row]], error.what()),
                       "a pose at which it can be measured");
    }
  }
  return items;
}

struct WrittenColumn {
  std::string header;
  const std::vector<double>* numbers;
  const Unit* unit;
};

}  // namespace

InstrumentReadings parse_instrument_readings(std::string_view text, const std::string& file, const Machine& machine,
                                             const Instrument& instrument, const MeasurementOptions& options) {
  std::vector<CsvColumn> wanted = axis_columns(machine);
  const std::size_t item = wanted.size();
  wanted.push_back({"item", Quantity::dimensionless, true, false, CsvColumn::Range::any});
  const ComponentColumns components(instrument, wanted);
  const std::size_t time = wanted.size();
  wanted.push_back({"time", Quantity::time, false, false, CsvColumn::Range::any});
  const std::size_t point = wanted.size();
  wanted.push_back(point_column());
  const std::size_t approach = add_approach_columns(machine, wanted);
  const std::size_t states = add_state_columns(machine, wanted);

  CsvTable table = read_csv(text, file, wanted, options.mapping, options.threads);
  InstrumentReadings readings;
  const std::vector<std::size_t> targets = take_targets(text, file, instrument, table.columns[item], table.rows);
  readings.poses = take_poses(text, file, machine, table, options.check_travel);
  readings.poses.approach = take_approach(text, file, machine, table, approach);
  readings.item = take_items(text, file, machine, instrument, targets, readings.poses);
  components.take(text, file, table, readings);
  readings.point_name = std::move(table.columns[point].labels);
  take_states(text, file, machine, table, states, time, options.channels, readings.poses);
  if (table.columns[time].present) readings.time_s = std::move(table.columns[time].numbers);
  return readings;
}

InstrumentReadings read_instrument_readings(const std::filesystem::path& path, const Machine& machine,
                                            const Instrument& instrument, const MeasurementOptions& options) {
  const MappedFile file(path);
  return parse_instrument_readings(file.text(), path.string(), machine, instrument, options);
}

InstrumentFile read_instrument_file(const std::filesystem::path& path, const Machine& machine,
                                    const std::shared_ptr<const Instrument>& device, const std::string& setup,
                                    bool noise_from_data, const MeasurementOptions& options) {
  const MappedFile file(path);
  return parse_instrument_file(file.text(), path.string(), machine, device, setup, noise_from_data, options);
}

InstrumentFile parse_instrument_file(std::string_view text, const std::string& name, const Machine& machine,
                                     const std::shared_ptr<const Instrument>& device, const std::string&,
                                     bool noise_from_data, const MeasurementOptions& options) {
  InstrumentFile file{device, parse_instrument_readings(text, name, machine, *device, options), {}};
  if (!noise_from_data) {
    file.readings.uncertainty.clear();
    file.readings.covariance.clear();
  } else if (file.readings.uncertainty.empty() && file.readings.covariance.empty()) {
    const ReadingComponent& first = device->components().front();
    throw InputError({.file = name}, "the study takes the noise from the data, but the file states no uncertainties",
                     fmt::format("columns such as u_{}_{}", first.name, first.is_angle ? "arcsec" : "um"));
  }
  return file;
}

std::string instrument_readings_text(const Machine& machine, const Instrument& instrument,
                                     const InstrumentReadings& readings) {
  std::vector<WrittenColumn> columns;
  const auto add = [&](const std::string& base, Quantity quantity, const char* suffix,
                       const std::vector<double>& numbers) {
    const std::string name = *suffix == '\0' ? base : base + "_" + suffix;
    columns.push_back({csv_field(name), &numbers, &unit_named(quantity, suffix)});
  };
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const bool linear = machine.axes[i].kind == AxisKind::linear;
    add(machine.axes[i].name, linear ? Quantity::length : Quantity::angle, linear ? "mm" : "deg",
        readings.poses.axis[i]);
  }
  const std::size_t axes = columns.size();
  std::vector<std::vector<double>> approach;
  for (const std::vector<std::int8_t>& sides : readings.poses.approach) approach.push_back(approach_numbers(sides));
  for (std::size_t i = 0; i < instrument.inputs().size(); ++i) {
    const ReadingComponent& known = instrument.inputs()[i];
    add(known.name, component_quantity(known),
        known.is_pure_number ? ""
        : known.is_angle     ? "deg"
                             : "mm",
        readings.inputs[i]);
  }
  for (std::size_t i = 0; i < instrument.components().size(); ++i) {
    const ReadingComponent& one = instrument.components()[i];
    if (!one.is_relative) add(one.name, component_quantity(one), one.is_angle ? "arcsec" : "mm", readings.measured[i]);
  }
  for (std::size_t i = 0; i < readings.uncertainty.size(); ++i) {
    const ReadingComponent& one = instrument.components()[i];
    add("u_" + one.name, component_quantity(one), one.is_angle ? "arcsec" : "um", readings.uncertainty[i]);
  }
  const std::vector<ComponentCovariance> covariances = component_covariances(instrument);
  for (std::size_t i = 0; i < readings.covariance.size(); ++i) {
    add(covariances[i].base, covariances[i].quantity, covariances[i].unit, readings.covariance[i]);
  }
  if (!readings.time_s.empty()) add("time", Quantity::time, "s", readings.time_s);

  for (std::size_t i = 0; i < approach.size(); ++i) {
    columns.push_back(
        {csv_field(approach_header(machine.axes[i])), &approach[i], &unit_named(Quantity::dimensionless, "")});
  }
  for (std::size_t j = 0; j < machine.states.size(); ++j) {
    if (has_state_column(readings.poses, j)) {
      add(state_column(machine.states[j]), Quantity::dimensionless, "", readings.poses.state[j]);
    }
  }

  const std::vector<std::string> targets = instrument.target_names();
  const bool named = targets.size() > 1;
  std::string text;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (i == axes && named) text += ",item";
    text += (i == 0 ? "" : ",") + columns[i].header;
  }
  if (!readings.point_name.empty()) text += ",point";
  text += '\n';
  for (std::size_t row = 0; row < readings.count(); ++row) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (i == axes && named) text += "," + csv_field(targets[instrument.target_of(readings.item[row])]);
      if (i > 0) text += ',';
      text += quantity_text((*columns[i].numbers)[row], *columns[i].unit);
    }
    if (!readings.point_name.empty()) text += "," + csv_field(readings.point_name[row]);
    text += '\n';
  }
  return text;
}

}  // namespace abbe
