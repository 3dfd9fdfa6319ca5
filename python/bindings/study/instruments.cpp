#include <fmt/format.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "abbe/formats/readings/instrument_file.h"
#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/instruments/instrument_simulation.h"
#include "bindings/arrays.h"
#include "bindings/files.h"
#include "bindings/job.h"
#include "bindings/machine_errors.h"
#include "bindings/study/study_objects.h"
#include "bindings/tables.h"

namespace abbe::python {
namespace {

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

using Items = std::variant<std::string, std::vector<std::string>>;

std::vector<std::string> names_of(const std::vector<ReadingComponent>& components) {
  std::vector<std::string> names;
  for (const ReadingComponent& component : components) {
    const char* const unit = component.is_pure_number ? "" : component.is_angle ? "_rad" : "_mm";
    names.push_back(component.name + unit);
  }
  return names;
}

std::vector<std::string> item_names(const Instrument& device) {
  std::vector<std::string> names;
  for (const InstrumentItem& item : device.items()) names.push_back(item.name);
  return names;
}

std::uint16_t item_named(const Instrument& device, const std::string& name) {
  for (std::size_t i = 0; i < device.items().size(); ++i) {
    if (device.items()[i].name == name) return static_cast<std::uint16_t>(i);
  }
  throw nb::key_error(fmt::format("no item '{}' of {}", name, device.name()).c_str());
}

std::vector<std::uint16_t> items_of(const Instrument& device, const std::optional<Items>& items, std::size_t count) {
  if (!items) {
    if (device.items().size() != 1) {
      throw InputError({.field = "items"},
                       fmt::format("is missing, and {} has {} items", device.name(), device.items().size()),
                       "the item of each reading, by name");
    }
    return std::vector<std::uint16_t>(count, 0);
  }
  if (const auto* one = std::get_if<std::string>(&*items))
    return std::vector<std::uint16_t>(count, item_named(device, *one));
  const auto& all = std::get<std::vector<std::string>>(*items);
  if (all.size() != count) {
    throw InputError({.field = "items"}, fmt::format("are {}", all.size()),
                     fmt::format("{}, as many as positions", count));
  }
  std::vector<std::uint16_t> result;
  for (const std::string& name : all) result.push_back(item_named(device, name));
  return result;
}

/// Columns of an argument [n, columns] (or [n] if there is one); none if it is absent.
std::vector<std::vector<double>> columns_of(const std::optional<ArrayLike>& argument, const char* name,
                                            std::size_t count, std::size_t columns) {
  if (!argument) return {};
  const Numbers numbers = argument->numbers(name);
  const bool flat = numbers.ndim() == 1 && columns == 1;
  if (numbers.ndim() > 2 || numbers.ndim() == 0 || numbers.shape(0) != count ||
      (!flat && (numbers.ndim() != 2 || numbers.shape(1) != columns))) {
    throw InputError({.field = name}, "has another shape", fmt::format("shape ({}, {})", count, columns));
  }
  std::vector<std::vector<double>> result(columns, std::vector<double>(count));
  for (std::size_t c = 0; c < columns; ++c) {
    for (std::size_t k = 0; k < count; ++k) {
      const std::int64_t across = flat ? 0 : static_cast<std::int64_t>(c) * numbers.stride(1);
      result[c][k] = numbers.data()[static_cast<std::int64_t>(k) * numbers.stride(0) + across];
    }
  }
  return result;
}

nb::object array_of_columns(const std::vector<std::vector<double>>& columns, std::size_t count) {
  if (columns.empty()) return nb::none();
  Columns<double> result(columns.size(), count);
  for (std::size_t c = 0; c < columns.size(); ++c) std::copy(columns[c].begin(), columns[c].end(), result[c]);
  return result.release({columns.size()}, false);
}

/// Orientations of readings, which have all been measured. @throws InputError
void require_orientations(const Instrument& device, const InstrumentReadings& readings) {
  const std::optional<BadOrientation> bad = first_bad_orientation(device, readings);
  if (!bad) return;
  const std::string what = std::isnan(bad->length) ? "the orientation is missing"
                                                   : fmt::format("the quaternion has the length {:.6g}", bad->length);
  throw InputError({.field = "inputs_mm_rad"}, fmt::format("row {}: {}", bad->reading, what),
                   "the measured orientation as a quaternion qw, qx, qy, qz of length 1");
}

/// Orientations of a plan: none, or NaN in a row, where nothing is measured yet. The library has zeros there.
/// @throws InputError
void plan_orientations(const Instrument& device, InstrumentReadings& plan) {
  const std::size_t numbers = device.inputs().size();
  if (plan.inputs.empty()) plan.inputs.assign(numbers, std::vector<double>(plan.count(), kNotMeasured));
  InstrumentReadings stated;
  stated.inputs.resize(numbers);
  std::vector<std::size_t> rows;
  for (std::size_t k = 0; k < plan.count(); ++k) {
    const auto is_missing = [k](const std::vector<double>& column) { return std::isnan(column[k]); };
    if (std::all_of(plan.inputs.begin(), plan.inputs.end(), is_missing)) {
      for (std::vector<double>& column : plan.inputs) column[k] = 0;
      continue;
    }
    rows.push_back(k);
    for (std::size_t i = 0; i < numbers; ++i) stated.inputs[i].push_back(plan.inputs[i][k]);
    stated.item.push_back(plan.item[k]);
  }
  const std::optional<BadOrientation> bad = first_bad_orientation(device, stated);
  if (!bad) return;
  throw InputError({.field = "inputs_mm_rad"},
                   fmt::format("row {}: the quaternion has the length {:.6g}", rows[bad->reading], bad->length),
                   "a quaternion qw, qx, qy, qz of length 1, or NaN where no orientation is measured yet");
}

PythonReadings make_readings(const MachineInstrument& instrument, const ArrayLike& positions_argument,
                             const std::optional<ArrayLike>& measured, const std::optional<Items>& items,
                             const std::optional<ArrayLike>& inputs, const std::optional<ArrayLike>& uncertainty,
                             const std::optional<ArrayLike>& approach, const std::optional<ArrayLike>& time_s) {
  const Positions positions(positions_argument, instrument.machine);
  const Instrument& device = *instrument.device;
  const std::size_t count = positions.count(), components = device.components().size();
  InstrumentReadings readings;
  readings.poses = positions.list();
  readings.item = items_of(device, items, count);
  readings.inputs = columns_of(inputs, "inputs_mm_rad", count, device.inputs().size());
  readings.measured = columns_of(measured, "measured_mm_rad", count, components);
  readings.uncertainty = columns_of(uncertainty, "standard_uncertainties_mm_rad", count, components);
  if (approach) {
    for (const std::vector<double>& column : columns_of(approach, "approach", count, instrument.machine.axes.size())) {
      std::vector<std::int8_t>& sides = readings.poses.approach.emplace_back();
      for (const double side : column) {
        if (side != 0 && side != 1 && side != -1) {
          throw InputError({.field = "approach"}, fmt::format("has {}", side), "+1, -1 or 0 (not known)");
        }
        sides.push_back(static_cast<std::int8_t>(side));
      }
    }
  }
  if (time_s) readings.time_s = columns_of(time_s, "time_s", count, 1).front();
  // As plans and as readings: what is wrong with them is said here and not when they are used.
  if (!readings.measured.empty()) {
    if (!readings.inputs.empty()) require_orientations(device, readings);
    return {instrument, given_readings(readings, instrument.machine, instrument.device, instrument.setup,
                                       !readings.uncertainty.empty())
                            .readings};
  }
  if (has_orientation(device)) plan_orientations(device, readings);
  try {
    check_readings(instrument.machine, device, readings, false);
  } catch (const std::invalid_argument& error) {
    throw InputError({.field = "readings"}, error.what(), "");
  }
  return {instrument, std::move(readings)};
}

/// [n, inputs]; NaN where a plan has no orientation.
nb::object inputs_of(const PythonReadings& self) {
  std::vector<std::vector<double>> inputs = self.readings.inputs;
  for (std::size_t k = 0; has_orientation(*self.instrument.device) && k < self.readings.count(); ++k) {
    if (std::any_of(inputs.begin(), inputs.end(), [k](const std::vector<double>& column) { return column[k] != 0; })) {
      continue;
    }
    for (std::vector<double>& column : inputs) column[k] = kNotMeasured;
  }
  return array_of_columns(inputs, self.readings.count());
}

/// A measurement file. @throws InputError for a plan
std::string text_of_readings(const PythonReadings& self) {
  if (self.readings.measured.empty()) {
    throw InputError({.field = "readings"}, "are a plan, nothing is measured", "measured readings, or simulate() them");
  }
  return instrument_form(self.instrument.word)
      .readings.text(self.instrument.machine, *self.instrument.device, self.readings);
}

PythonReadings simulate(const PythonReadings& plan, const MachineErrors& errors, std::uint64_t seed, bool noise,
                        const nb::object& progress) {
  InstrumentSimulationOptions options;
  options.seed = seed;
  options.noise_factor = noise ? 1 : 0;
  return job_result(progress, [&](const JobControl& control) {
    const JobOptions job = control.options("simulating readings");
    options.progress = stoppable_progress(job);
    return PythonReadings{
        plan.instrument,
        plan.instrument.device->simulate(plan.instrument.machine, errors.set(), plan.readings, options).readings};
  });
}

PythonReadings read(const MachineInstrument& instrument, const std::filesystem::path& path, bool noise_from_data,
                    std::map<std::string, std::string> columns, std::vector<std::string> ignore) {
  MeasurementOptions options;
  for (auto& [ours, theirs] : columns) options.mapping.columns.emplace(ours, theirs);
  options.mapping.ignore = std::move(ignore);
  options.mapping.ignored_by = "`ignore`";
  InstrumentFile file =
      instrument_form(instrument.word)
          .readings.read(path, instrument.machine, instrument.device, instrument.setup, noise_from_data, options);
  return {{instrument.setup, instrument.word, file.device, instrument.machine}, std::move(file.readings)};
}

void bind_readings(nb::module_& module) {
  nb::class_<PythonReadings> bound(module, "Readings",
                                   "Readings of one instrument, or a plan of them (nothing measured yet).\n\n"
                                   "Arrays have one row per reading; lengths in mm, angles in rad.");
  add_tables(bound, "readings_frame", nullptr);
  bound
      .def(
          "__init__",
          [](PythonReadings* self, const MachineInstrument& instrument, const ArrayLike& positions,
             const std::optional<ArrayLike>& measured, const std::optional<Items>& items,
             const std::optional<ArrayLike>& inputs, const std::optional<ArrayLike>& uncertainty,
             const std::optional<ArrayLike>& approach, const std::optional<ArrayLike>& time_s) {
            new (self) PythonReadings(
                make_readings(instrument, positions, measured, items, inputs, uncertainty, approach, time_s));
          },
          nb::arg("instrument"), nb::arg("positions_mm_rad"), nb::arg("measured_mm_rad") = nb::none(), nb::kw_only(),
          nb::arg("items") = nb::none(), nb::arg("inputs_mm_rad") = nb::none(),
          nb::arg("standard_uncertainties_mm_rad") = nb::none(), nb::arg("approach") = nb::none(),
          nb::arg("time_s") = nb::none(),
          "positions [n, axes] commands; measured [n, components], or None for a plan; items: name of what each "
          "reading is\n"
          "taken on, or one name for all; inputs [n, inputs]: known numbers of each reading, of a pose tracker the "
          "measured\n"
          "orientation as a quaternion of length 1 (NaN in a plan: not measured yet); standard uncertainties\n"
          "[n, components], in place of the instrument's own; approach [n, axes]: +1, -1 or 0, the side from which an "
          "axis\n"
          "came. Raises InputError for other shapes, commands outside the travel and numbers that are not finite.")
      .def_prop_ro("instrument", [](const PythonReadings& self) { return self.instrument; })
      .def("__len__", [](const PythonReadings& self) { return self.readings.count(); })
      .def_prop_ro(
          "positions_mm_rad",
          [](const PythonReadings& self) { return array_of_columns(self.readings.poses.axis, self.readings.count()); },
          nb::sig("def positions_mm_rad(self) -> numpy.ndarray"), "[n, axes] commands, mm or rad.")
      .def_prop_ro(
          "measured_mm_rad",
          [](const PythonReadings& self) { return array_of_columns(self.readings.measured, self.readings.count()); },
          nb::sig("def measured_mm_rad(self) -> numpy.ndarray | None"), "[n, components] readings; None for a plan.")
      .def_prop_ro("inputs_mm_rad", &inputs_of, nb::sig("def inputs_mm_rad(self) -> numpy.ndarray | None"),
                   "[n, inputs] known numbers of each reading, as Instrument.inputs names them; NaN: an orientation "
                   "that is not\n"
                   "measured yet. None: the instrument has no inputs.")
      .def_prop_ro(
          "standard_uncertainties_mm_rad",
          [](const PythonReadings& self) { return array_of_columns(self.readings.uncertainty, self.readings.count()); },
          nb::sig("def standard_uncertainties_mm_rad(self) -> numpy.ndarray | None"),
          "[n, components], or None: as the instrument states.")
      .def_prop_ro(
          "items",
          [](const PythonReadings& self) {
            const std::vector<std::string> names = item_names(*self.instrument.device);
            std::vector<std::string> result;
            for (const std::uint16_t item : self.readings.item) result.push_back(names[item]);
            return result;
          },
          "Name of what each reading is taken on.")
      .def("csv", &text_of_readings, "Text of a measurement file (docs/formats.md). Raises InputError for a plan.")
      .def(
          "write",
          [](const PythonReadings& self, const std::filesystem::path& path, bool overwrite) {
            write_text(path, text_of_readings(self), overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false,
          "Writes a measurement file, whole or not at all. Raises InputError for a plan.")
      .def("simulate", &simulate, nb::arg("errors"), nb::kw_only(), nb::arg("seed") = 1, nb::arg("noise") = true,
           nb::arg("progress") = nb::none(),
           "What the instrument would read at these poses on a machine with these errors.\n\n"
           "The numbers of its set-up are taken as true. Readings without a line of sight are left out. The noise of a "
           "reading\n"
           "depends on the seed and the reading alone.")
      .def("__repr__", [](const PythonReadings& self) {
        return fmt::format("<abbe.Readings of {}: {}{}>", self.instrument.device->name(), self.readings.count(),
                           self.readings.measured.empty() ? ", a plan" : "");
      });
}

}  // namespace

void bind_instruments(nb::module_& module) {
  std::vector<std::string> words;
  for (const std::string_view word : instrument_words()) words.emplace_back(word);
  module.attr("INSTRUMENTS") = nb::tuple(nb::cast(words));
  nb::class_<MachineInstrument>(module, "Instrument",
                                "A measuring instrument where it stands, on a machine.\n\n"
                                "Instruments come from a study (Study.instruments) or from instrument().")
      .def_static(
          "_parse",
          [](const std::string& text, const std::string& word, const std::string& name, const Machine& machine) {
            TomlTable table = TomlTable::parse(text, name);
            const auto all = instrument_words();
            if (std::find(all.begin(), all.end(), word) == all.end()) {
              throw InputError({.field = "instrument"}, fmt::format("'{}' is no instrument", word),
                               fmt::format("one of {}", fmt::join(all, ", ")));
            }
            MachineInstrument made{name, word, instrument_form(word).read(table, {name, machine, true, false}),
                                   machine};
            table.finish();
            return made;
          },
          nb::arg("text"), nb::arg("kind"), nb::arg("name"), nb::arg("machine"))
      .def_prop_ro(
          "name", [](const MachineInstrument& self) { return self.setup; }, "Name of its set-up.")
      .def_prop_ro(
          "kind", [](const MachineInstrument& self) { return self.word; }, "'ball-bar', 'tracker', ...")
      .def_prop_ro(
          "machine", [](const MachineInstrument& self) { return self.machine; }, "A copy of the machine.")
      .def_prop_ro(
          "items", [](const MachineInstrument& self) { return item_names(*self.device); },
          "Names of what readings are taken on: balls, lines, reflectors.")
      .def_prop_ro(
          "components", [](const MachineInstrument& self) { return names_of(self.device->components()); },
          "What a reading consists of, with units: ['length_mm'].")
      .def_prop_ro(
          "inputs", [](const MachineInstrument& self) { return names_of(self.device->inputs()); },
          "Known numbers that every reading carries besides the commands, with units.")
      .def_prop_ro(
          "quantities",
          [](const MachineInstrument& self) {
            std::vector<std::string> names;
            for (const SetupQuantity& quantity : self.device->quantities()) names.push_back(quantity.name);
            return names;
          },
          "Names of the numbers of its set-up, known or not.")
      .def("read", &read, nb::arg("path"), nb::kw_only(), nb::arg("noise_from_data") = false,
           nb::arg("columns") = std::map<std::string, std::string>{}, nb::arg("ignore") = std::vector<std::string>{},
           "Readings from a measurement file (CSV, docs/formats.md).\n\n"
           "columns: our name of a column to the file's; ignore: columns to pass over. Raises InputError with line and "
           "field.")
      .def("__repr__", [](const MachineInstrument& self) {
        return fmt::format("<abbe.Instrument {} '{}': {} on {} items>", self.word, self.setup,
                           fmt::join(names_of(self.device->components()), ", "), self.device->items().size());
      });
  bind_readings(module);
}

}  // namespace abbe::python
