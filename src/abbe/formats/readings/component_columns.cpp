#include "abbe/formats/readings/component_columns.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/formats/readings/instrument_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/reading_covariance.h"

namespace abbe {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

std::vector<std::vector<double>> take_columns(CsvTable& table, std::size_t first, std::size_t count) {
  std::vector<std::vector<double>> columns;
  for (std::size_t i = 0; i < count; ++i) columns.push_back(std::move(table.columns[first + i].numbers));
  return columns;
}

Vector3d three_numbers(const CsvTable& table, std::size_t first, std::size_t row) {
  return {table.columns[first].numbers[row], table.columns[first + 1].numbers[row],
          table.columns[first + 2].numbers[row]};
}

}  // namespace

Quantity component_quantity(const ReadingComponent& component) {
  if (component.is_pure_number) return Quantity::dimensionless;
  return component.is_angle ? Quantity::angle : Quantity::length;
}

std::vector<ComponentCovariance> component_covariances(const Instrument& instrument) {
  const std::vector<ReadingComponent>& components = instrument.components();
  const std::size_t n = components.size();
  std::vector<ComponentCovariance> result(n * (n + 1) / 2);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i; j < n; ++j) {
      ComponentCovariance& column = result[covariance_place(n, i, j)];
      column.base = "cov_" + components[i].name + "_" + components[j].name;
      const int angles = (components[i].is_angle ? 1 : 0) + (components[j].is_angle ? 1 : 0);
      column.quantity = angles == 0   ? Quantity::length_squared
                        : angles == 1 ? Quantity::length_angle
                                      : Quantity::angle_squared;
      column.unit = angles == 0 ? "um2" : angles == 1 ? "um_arcsec" : "arcsec2";
    }
  }
  return result;
}

ComponentColumns::ComponentColumns(const Instrument& instrument, std::vector<CsvColumn>& wanted)
    : instrument_(instrument), has_orientation_(has_orientation(instrument)) {
  input_ = wanted.size();
  for (const ReadingComponent& known : instrument.inputs()) {
    wanted.push_back({known.name, component_quantity(known), false, !has_orientation_});
  }
  if (has_orientation_) {
    angles_ = wanted.size();
    for (const char* const name : {"a", "b", "c"}) wanted.push_back({name, Quantity::angle, false, false});
    vector_ = wanted.size();
    for (const char* const name : {"rx", "ry", "rz"}) wanted.push_back({name, Quantity::angle, false, false});
  }
  component_ = wanted.size();
  for (const ReadingComponent& one : instrument.components()) {
    if (!one.is_relative) wanted.push_back({one.name, component_quantity(one)});
  }
  uncertainty_ = wanted.size();
  for (const ReadingComponent& one : instrument.components()) {
    wanted.push_back({"u_" + one.name, component_quantity(one), false, false, CsvColumn::Range::positive});
  }
  covariance_ = wanted.size();
  const std::vector<ComponentCovariance> covariances = component_covariances(instrument);
  // Of a single number the standard uncertainty says it all.
  if (instrument.components().size() > 1) {
    for (std::size_t i = 0; i < covariances.size(); ++i) {
      wanted.push_back({covariances[i].base, covariances[i].quantity, false, false,
                        i < instrument.components().size() ? CsvColumn::Range::positive : CsvColumn::Range::any});
    }
  }
  wanted_ = wanted;
}

bool ComponentColumns::all_or_none(const std::string& file, const CsvTable& table, std::size_t first, std::size_t count,
                                   const std::string& otherwise) const {
  std::size_t present = 0, absent = first;
  for (std::size_t i = first; i < first + count; ++i) {
    if (table.columns[i].present) {
      ++present;
    } else {
      absent = i;
    }
  }
  if (present == count || present == 0) return present > 0;
  throw InputError({file, 0, 0, wanted_[absent].base}, "missing column",
                   accepted_names(wanted_[absent].base, wanted_[absent].quantity) + otherwise);
}

void ComponentColumns::take_orientation(std::string_view text, const std::string& file, CsvTable& table,
                                        InstrumentReadings& readings) const {
  const char* const all = ": all of them, or none";
  const bool quaternion = all_or_none(file, table, input_, 4, all), angles = all_or_none(file, table, angles_, 3, all),
             vector = all_or_none(file, table, vector_, 3, all);
  if (quaternion + angles + vector != 1) {
    const std::size_t at = vector ? vector_ : angles ? angles_ : input_;
    throw InputError(
        {file, 0, 0, wanted_[at].base},
        quaternion + angles + vector == 0 ? "the orientation is missing" : "the orientation is given twice",
        "qw, qx, qy, qz, or a_deg, b_deg, c_deg (Rz(c) Ry(b) Rx(a)), or rx_deg, ry_deg, rz_deg (a rotation "
        "vector)");
  }
  readings.inputs.assign(4, std::vector<double>(table.rows));
  for (std::size_t row = 0; row < table.rows; ++row) {
    Quaterniond q;
    if (quaternion) {
      q = Quaterniond(table.columns[input_].numbers[row], table.columns[input_ + 1].numbers[row],
                      table.columns[input_ + 2].numbers[row], table.columns[input_ + 3].numbers[row]);
      if (!(std::abs(q.norm() - 1) <= kQuaternionLength)) {
        throw InputError({file, csv_line(text, row), 0, "qw"},
                         fmt::format("the quaternion has the length {:.6g}", q.norm()), "a length of 1");
      }
    } else {
      q = Quaterniond(angles ? rotation_from_error_angles(three_numbers(table, angles_, row))
                             : rotation_from_vector(three_numbers(table, vector_, row)));
    }
    const double numbers[4] = {q.w(), q.x(), q.y(), q.z()};
    for (std::size_t i = 0; i < 4; ++i) readings.inputs[i][row] = numbers[i];
  }
}

void ComponentColumns::take_uncertainty(std::string_view text, const std::string& file, CsvTable& table,
                                        InstrumentReadings& readings) const {
  const std::size_t n = instrument_.components().size(), elements = n > 1 ? n * (n + 1) / 2 : 0;
  const bool standard = all_or_none(file, table, uncertainty_, n, ": the uncertainties of all components, or of none");
  const bool covariance =
      elements > 0 && all_or_none(file, table, covariance_, elements, ": all elements of the covariance, or none");
  if (standard && covariance) {
    throw InputError({file, 0, 0, table.columns[covariance_].header},
                     fmt::format("is given together with {}", table.columns[uncertainty_].header), "only one of them");
  }
  if (standard) readings.uncertainty = take_columns(table, uncertainty_, n);
  if (!covariance) return;
  const std::string header = table.columns[covariance_].header;
  readings.covariance = take_columns(table, covariance_, elements);
  for (std::size_t row = 0; row < table.rows; ++row) {
    if (inverse_covariance_factor(covariance_of(readings, n, row))) continue;
    throw InputError({file, csv_line(text, row), 0, header}, "the covariance of this reading is not positive definite",
                     "variances above zero and consistent correlations");
  }
}

void ComponentColumns::take(std::string_view text, const std::string& file, CsvTable& table,
                            InstrumentReadings& readings) const {
  if (has_orientation_) {
    take_orientation(text, file, table, readings);
  } else {
    readings.inputs = take_columns(table, input_, instrument_.inputs().size());
  }
  std::size_t column = component_;
  for (const ReadingComponent& one : instrument_.components()) {
    readings.measured.push_back(one.is_relative ? std::vector<double>(table.rows, 0.0)
                                                : std::move(table.columns[column++].numbers));
  }
  take_uncertainty(text, file, table, readings);
}

}  // namespace abbe
