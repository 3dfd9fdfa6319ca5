#include <cassert>

#include "abbe/formats/readings/axis_columns.h"
#include "abbe/formats/readings/covariance_columns.h"
#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {
namespace {

/// One column to be written: numbers in a unit, or names.
struct MeasurementColumn {
  std::string header;
  const double* numbers = nullptr;
  const Unit* unit = nullptr;
  const std::uint16_t* words = nullptr;
  const std::vector<std::string>* names = nullptr;
  const std::vector<std::string>* labels = nullptr;
  const std::vector<Eigen::Vector3d>* offsets = nullptr;  // of the reflector in `words`
  Eigen::Index direction = 0;
};

class Columns {
 public:
  void add(const std::string& base, Quantity quantity, const char* suffix, const std::vector<double>& numbers) {
    MeasurementColumn column;
    column.header = csv_field(*suffix == 0 ? base : base + "_" + suffix);
    column.numbers = numbers.data();
    column.unit = &unit_named(quantity, suffix);
    columns_.push_back(column);
  }
  void add_names(const char* header, const std::vector<std::uint16_t>& words, const std::vector<std::string>& names) {
    MeasurementColumn column;
    column.header = header;
    column.words = words.data();
    column.names = &names;
    columns_.push_back(column);
  }
  void add_labels(const char* header, const std::vector<std::string>& labels) {
    MeasurementColumn column;
    column.header = header;
    column.labels = &labels;
    columns_.push_back(column);
  }
  void add_offsets(const std::vector<std::uint16_t>& words, const std::vector<Eigen::Vector3d>& offsets) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      MeasurementColumn column;
      column.header = std::string("offset_") + "xyz"[k] + "_mm";
      column.words = words.data();
      column.offsets = &offsets;
      column.direction = k;
      columns_.push_back(column);
    }
  }

  std::string text(std::size_t rows) const {
    std::string text;
    for (const MeasurementColumn& column : columns_) text += (text.empty() ? "" : ",") + column.header;
    text += '\n';
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t i = 0; i < columns_.size(); ++i) {
        const MeasurementColumn& column = columns_[i];
        if (i > 0) text += ',';
        if (column.numbers != nullptr) {
          text += quantity_text(column.numbers[row], *column.unit);
        } else if (column.labels != nullptr) {
          text += csv_field((*column.labels)[row]);
        } else if (column.offsets != nullptr) {
          text += shortest_text((*column.offsets)[column.words[row]][column.direction]);
        } else {
          text += csv_field((*column.names)[column.words[row]]);
        }
      }
      text += '\n';
    }
    return text;
  }

 private:
  std::vector<MeasurementColumn> columns_;
};

}  // namespace

std::string measurements_text(const Machine& machine, const MeasurementTable& table) {
  const TrackerReadings& readings = table.readings;
  assert(readings.poses.axis.size() == machine.axes.size());
  Columns columns;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const bool linear = machine.axes[i].kind == AxisKind::linear;
    columns.add(machine.axes[i].name, linear ? Quantity::length : Quantity::angle, linear ? "mm" : "deg",
                readings.poses.axis[i]);
  }
  const auto named = [](const std::vector<std::string>& names) { return !(names.size() == 1 && names[0].empty()); };
  if (named(table.stations)) columns.add_names("station", readings.station, table.stations);
  if (named(table.reflectors)) columns.add_names("reflector", readings.reflector, table.reflectors);
  if (!table.reflector_offset.empty()) columns.add_offsets(readings.reflector, table.reflector_offset);

  const auto& u = readings.uncertainty;
  if (readings.measure == TrackerMeasure::cartesian) {
    for (std::size_t k = 0; k < 3; ++k) {
      columns.add(std::string("measured_") + "xyz"[k], Quantity::length, "mm", readings.measured[k]);
    }
    if (readings.stated == StatedUncertainty::standard) {
      for (std::size_t k = 0; k < 3; ++k) columns.add(std::string("u_") + "xyz"[k], Quantity::length, "um", u[k]);
    }
  } else {
    columns.add("range", Quantity::length, "mm", readings.measured[0]);
    columns.add("azimuth", Quantity::angle, "deg", readings.measured[1]);
    columns.add("elevation", Quantity::angle, "deg", readings.measured[2]);
    if (readings.stated == StatedUncertainty::standard) {
      columns.add("u_range", Quantity::length, "um", u[0]);
      columns.add("u_azimuth", Quantity::angle, "arcsec", u[1]);
      columns.add("u_elevation", Quantity::angle, "arcsec", u[2]);
    }
  }
  if (readings.stated == StatedUncertainty::covariance) {
    const std::array<CovarianceColumn, 6> stated = covariance_columns(readings.measure);
    for (std::size_t k = 0; k < 6; ++k) columns.add(stated[k].base, stated[k].quantity, stated[k].unit, u[k]);
  }
  if (!readings.time_s.empty()) columns.add("time", Quantity::time, "s", readings.time_s);
  if (!readings.point_name.empty()) columns.add_labels("point", readings.point_name);
  std::vector<std::vector<double>> approach;
  for (const std::vector<std::int8_t>& sides : readings.poses.approach) approach.push_back(approach_numbers(sides));
  for (std::size_t i = 0; i < approach.size(); ++i) {
    columns.add(approach_header(machine.axes[i]), Quantity::dimensionless, "", approach[i]);
  }
  for (std::size_t j = 0; j < machine.states.size(); ++j) {
    if (has_state_column(readings.poses, j)) {
      columns.add(state_column(machine.states[j]), Quantity::dimensionless, "", readings.poses.state[j]);
    }
  }
  return columns.text(readings.count());
}

}  // namespace abbe
