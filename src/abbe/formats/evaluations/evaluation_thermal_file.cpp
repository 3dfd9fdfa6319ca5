#include "abbe/formats/evaluations/evaluation_thermal_file.h"

#include <fmt/format.h>

#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "abbe/formats/evaluations/sensor_columns.h"

namespace abbe {
namespace {

enum ThermalColumn : std::size_t { kTimeAt, kTargetAt, kDirectionAt, kDeviationAt, kActualAt };
constexpr std::size_t kThermalSensors = kTimeAt + 1, kAxisSensors = kActualAt + 1;

std::vector<CsvColumn> time_column() { return {{"time", Quantity::time, false, true, CsvColumn::Range::any}}; }

std::vector<CsvColumn> axis_thermal_columns() {
  std::vector<CsvColumn> columns = time_column();
  columns.push_back({"target", Quantity::length, false, true, CsvColumn::Range::any});
  columns.push_back({"direction", Quantity::dimensionless, true, false, CsvColumn::Range::any});
  columns.push_back({"deviation", Quantity::length, false, false, CsvColumn::Range::any});
  columns.push_back({"actual", Quantity::length, false, false, CsvColumn::Range::any});
  return columns;
}

void require_two(const TimeSeries& series, const InputError::Place& place, const std::string& where) {
  if (series.time.size() >= 2) return;
  throw InputError(place, fmt::format("{} reading{}{}", series.time.size(), series.time.size() == 1 ? "" : "s", where),
                   "two at least: a change over time");
}

ThermalReadings thermal_readings(const PlacedTable& csv, const std::vector<CsvColumn>& wanted) {
  ThermalReadings readings;
  std::vector<std::size_t> rows(csv.rows);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  for (std::size_t column = kThermalSensors; column < wanted.size(); ++column) {
    TimeSeries series = sensor_series(csv, kTimeAt, column, wanted[column], rows);
    require_two(series, csv.place(csv.columns[column].header), "");
    const Quantity quantity = wanted[column].quantity;
    (quantity == Quantity::length  ? readings.displacements
     : quantity == Quantity::angle ? readings.angles
                                   : readings.temperatures)
        .push_back(std::move(series));
  }
  if (readings.displacements.empty() && readings.angles.empty()) {
    throw InputError(csv.place("X_um"), "there is no column of a displacement or an angle",
                     "columns such as X_um, Z_um or A_urad");
  }
  return readings;
}

class AxisDistortionReader {
 public:
  AxisDistortionReader(PlacedTable csv, std::vector<CsvColumn> wanted)
      : csv_(std::move(csv)), wanted_(std::move(wanted)) {
    const bool has_deviation = csv_.columns[kDeviationAt].present;
    if (has_deviation == csv_.columns[kActualAt].present) {
      throw InputError(csv_.place("deviation"),
                       has_deviation ? "is given together with the actual positions" : "missing column",
                       "deviation_um or actual_mm, one of them");
    }
    deviation_ = has_deviation ? kDeviationAt : kActualAt;
    if (!has_deviation) {
      std::vector<double>& actual = csv_.columns[kActualAt].numbers;
      for (std::size_t row = 0; row < csv_.rows; ++row) actual[row] -= csv_.columns[kTargetAt].numbers[row];
    }
  }

  AxisDistortionReadings read() const {
    AxisDistortionReadings readings;
    std::map<std::pair<double, std::string>, std::vector<std::size_t>> rows;
    for (std::size_t row = 0; row < csv_.rows; ++row) {
      rows[{csv_.columns[kTargetAt].numbers[row], approach_of(row)}].push_back(row);
    }
    for (const auto& [at, of_target] : rows) readings.targets.push_back(target_of(at.first, at.second, of_target));
    if (readings.targets.front().target == readings.targets.back().target) {
      throw InputError(csv_.place(csv_.columns[kTargetAt].header), "there is one target position",
                       "two at least: the change of their distance");
    }
    for (std::size_t column = kAxisSensors; column < wanted_.size(); ++column) {
      if (wanted_[column].quantity == Quantity::temperature) readings.temperatures.push_back(temperature_of(column));
    }
    return readings;
  }

 private:
  std::string approach_of(std::size_t row) const {
    const CsvValues& direction = csv_.columns[kDirectionAt];
    if (!direction.present) return "";
    const std::string& word = direction.names[direction.words[row]];
    if (word == "+" || word == "positive") return "+";
    if (word == "-" || word == "negative") return "-";
    throw InputError(csv_.place(row, direction.header),
                     fmt::format("'{}' is not a direction of approach", word.substr(0, 40)), "+ or -");
  }

  AxisTargetReadings target_of(double target, const std::string& approach, const std::vector<std::size_t>& rows) const {
    AxisTargetReadings result{target, approach, {}, {}, {}};
    const std::string where = fmt::format(" at the target {:.9g} mm", target) +
                              (approach.empty() ? "" : fmt::format(" from direction {}", approach));
    const auto series_of = [&](std::size_t column) {
      TimeSeries series = sensor_series(csv_, kTimeAt, column, wanted_[column], rows);
      require_two(series, csv_.place(csv_.columns[column].header), where);
      return series;
    };
    result.deviation = series_of(deviation_);
    result.deviation.name = wanted_[kDeviationAt].base;
    for (std::size_t column = kAxisSensors; column < wanted_.size(); ++column) {
      if (wanted_[column].quantity == Quantity::length) result.displacements.push_back(series_of(column));
      if (wanted_[column].quantity == Quantity::angle) result.angles.push_back(series_of(column));
    }
    return result;
  }

  /// A temperature may be the same in several rows of one time, one for each target.
  TimeSeries temperature_of(std::size_t column) const {
    std::vector<std::size_t> rows;
    const std::vector<double>& times = csv_.columns[kTimeAt].numbers;
    for (std::size_t row = 0; row < csv_.rows; ++row) {
      if (rows.empty() || times[row] != times[rows.back()]) rows.push_back(row);
    }
    TimeSeries series = sensor_series(csv_, kTimeAt, column, wanted_[column], rows);
    require_two(series, csv_.place(csv_.columns[column].header), "");
    return series;
  }

  PlacedTable csv_;
  std::vector<CsvColumn> wanted_;
  std::size_t deviation_ = kDeviationAt;
};

}  // namespace

ThermalReadings parse_thermal(std::string_view text, const std::string& file, const ColumnMapping& mapping) {
  const std::vector<CsvColumn> wanted = with_sensor_columns(text, file, mapping, time_column());
  return thermal_readings({text, file, wanted, mapping}, wanted);
}

ThermalReadings parse_thermal(const NamedColumns& columns) {
  const std::vector<CsvColumn> wanted = with_sensor_columns(columns, time_column());
  return thermal_readings({columns, wanted}, wanted);
}

AxisDistortionReadings parse_axis_distortion(std::string_view text, const std::string& file,
                                             const ColumnMapping& mapping) {
  const std::vector<CsvColumn> wanted = with_sensor_columns(text, file, mapping, axis_thermal_columns());
  return AxisDistortionReader({text, file, wanted, mapping}, wanted).read();
}

AxisDistortionReadings parse_axis_distortion(const NamedColumns& columns) {
  const std::vector<CsvColumn> wanted = with_sensor_columns(columns, axis_thermal_columns());
  return AxisDistortionReader({columns, wanted}, wanted).read();
}

ThermalReadings read_thermal(const std::filesystem::path& path, const ColumnMapping& mapping) {
  return read_sensor_table(path, time_column(), mapping,
                           [&](std::string_view text) { return parse_thermal(text, path.string(), mapping); });
}

AxisDistortionReadings read_axis_distortion(const std::filesystem::path& path, const ColumnMapping& mapping) {
  return read_sensor_table(path, axis_thermal_columns(), mapping,
                           [&](std::string_view text) { return parse_axis_distortion(text, path.string(), mapping); });
}

}  // namespace abbe
