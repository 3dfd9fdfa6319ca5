#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "abbe/formats/readings/axis_columns.h"
#include "abbe/formats/readings/component_columns.h"
#include "abbe/formats/readings/instrument_file.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

void require_finite(const std::vector<std::vector<double>>& columns, const std::string& setup, const char* what) {
  for (const std::vector<double>& column : columns) {
    for (std::size_t k = 0; k < column.size(); ++k) {
      if (std::isfinite(column[k])) continue;
      throw InputError({.file = setup, .field = what}, fmt::format("reading {}: {}", k, column[k]), "finite numbers");
    }
  }
}

void require_travel(const InstrumentReadings& readings, const Machine& machine, const std::string& setup) {
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const auto outside = first_outside_travel(machine.axes[i], readings.poses.axis[i]);
    if (!outside) continue;
    throw InputError({.file = setup, .field = machine.axes[i].name},
                     fmt::format("reading {}: {}", outside->row, outside->problem), outside->expected);
  }
}

/// As in files: of a tracker that reads ranges and angles.
void require_ranges(const Instrument& device, const InstrumentReadings& readings, const std::string& setup) {
  if (device.components()[0].name != "range") return;
  const std::vector<double>& ranges = readings.measured[0];
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    if (ranges[k] > 0) continue;
    throw InputError({.file = setup, .field = "measured"}, fmt::format("reading {}: the range is {} mm", k, ranges[k]),
                     "a range above 0 mm");
  }
}

void require_orientations(const Instrument& device, const InstrumentReadings& readings, const std::string& setup) {
  const std::optional<BadOrientation> bad = first_bad_orientation(device, readings);
  if (!bad) return;
  throw InputError({.file = setup, .field = "inputs"},
                   fmt::format("reading {}: the quaternion has the length {:.6g}", bad->reading, bad->length),
                   "a length of 1");
}

}  // namespace

bool has_orientation(const Instrument& instrument) {
  return !instrument.inputs().empty() && instrument.inputs()[0].name == "qw";
}

std::optional<BadOrientation> first_bad_orientation(const Instrument& instrument, const InstrumentReadings& readings) {
  if (!has_orientation(instrument)) return std::nullopt;
  for (std::size_t k = 0; k < readings.count(); ++k) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += readings.inputs[i][k] * readings.inputs[i][k];
    const double length = std::sqrt(sum);
    if (!(std::abs(length - 1) <= kQuaternionLength)) return BadOrientation{k, length};
  }
  return std::nullopt;
}

InstrumentFile given_readings(const InstrumentReadings& readings, const Machine& machine,
                              const std::shared_ptr<const Instrument>& device, const std::string& setup,
                              bool noise_from_data) {
  InstrumentFile file{device, readings, {}};
  if (!noise_from_data) {
    file.readings.uncertainty.clear();
    file.readings.covariance.clear();
  } else if (readings.uncertainty.empty() && readings.covariance.empty()) {
    throw InputError({.file = setup}, "the study takes the noise from the readings, but they state no uncertainties",
                     "standard uncertainties of the readings");
  }
  try {
    check_readings(machine, *device, file.readings);
  } catch (const std::invalid_argument& error) {
    throw InputError({.file = setup}, error.what(), "");
  }
  require_finite(readings.poses.axis, setup, "positions");
  require_finite(readings.inputs, setup, "inputs");
  require_finite(readings.measured, setup, "measured");
  require_finite(readings.uncertainty, setup, "uncertainty");
  require_finite(readings.covariance, setup, "covariance");
  require_ranges(*device, readings, setup);
  require_orientations(*device, readings, setup);
  require_travel(readings, machine, setup);
  return file;
}

}  // namespace abbe
