#include "abbe/formats/readings/measurement_file.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <tuple>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/readings/axis_columns.h"
#include "abbe/formats/readings/covariance_columns.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/instruments/trackers/tracker_whitening.h"

namespace abbe {
namespace {

constexpr std::size_t kLargestOffsetCount = 1000;

/// Columns of one file and where they stand in the table that was read.
struct Layout {
  std::vector<CsvColumn> columns;
  std::size_t add(const std::string& base, Quantity quantity, CsvColumn::Range range = CsvColumn::Range::any) {
    columns.push_back({base, quantity, false, false, range});
    return columns.size() - 1;
  }
  std::size_t add_name(const std::string& base) {
    columns.push_back({base, Quantity::dimensionless, true, false, CsvColumn::Range::any});
    return columns.size() - 1;
  }
};

class MeasurementReader {
 public:
  MeasurementReader(std::string_view text, const std::string& file, const Machine& machine,
                    const MeasurementOptions& options)
      : text_(text), file_(file), machine_(machine), options_(options) {}

  MeasurementTable measurements() {
    layout_.columns = axis_columns(machine_);
    const std::size_t station = layout_.add_name("station");
    const std::size_t reflector = layout_.add_name("reflector");
    const std::size_t offset = add_all({"offset_x", "offset_y", "offset_z"}, Quantity::length);
    const std::size_t xyz = add_all({"measured_x", "measured_y", "measured_z"}, Quantity::length);
    const std::size_t range = layout_.add("range", Quantity::length, CsvColumn::Range::positive);
    add_all({"azimuth", "elevation"}, Quantity::angle);
    const std::size_t u_xyz = add_all({"u_x", "u_y", "u_z"}, Quantity::length, CsvColumn::Range::positive);
    const std::size_t u_range = layout_.add("u_range", Quantity::length, CsvColumn::Range::positive);
    add_all({"u_azimuth", "u_elevation"}, Quantity::angle, CsvColumn::Range::positive);
    const std::size_t cov_xyz = add_covariance(TrackerMeasure::cartesian);
    const std::size_t cov_range = add_covariance(TrackerMeasure::range_and_angles);
    const std::size_t time = layout_.add("time", Quantity::time);
    const std::size_t point = layout_.columns.size();
    layout_.columns.push_back(point_column());
    const std::size_t approach = add_approach_columns(machine_, layout_.columns);
    const std::size_t states = add_state_columns(machine_, layout_.columns);

    csv_ = read_csv(text_, file_, layout_.columns, options_.mapping, options_.threads);
    TrackerReadings& readings = table_.readings;
    readings.poses = poses();
    readings.poses.approach = take_approach(text_, file_, machine_, csv_, approach);
    read_measured(xyz, range);
    const bool cartesian = readings.measure == TrackerMeasure::cartesian;
    refuse_other(cartesian ? u_range : u_xyz, 3);
    refuse_other(cartesian ? cov_range : cov_xyz, 6);
    read_uncertainty(cartesian ? u_xyz : u_range, cartesian ? cov_xyz : cov_range);
    if (!cartesian && readings.stated != StatedUncertainty::none) refuse_vertical_beams(csv_.columns[range + 2].header);
    readings.point_name = std::move(csv_.columns[point].labels);
    take_states(text_, file_, machine_, csv_, states, time, options_.channels, readings.poses);
    if (csv_.columns[time].present) readings.time_s = std::move(csv_.columns[time].numbers);
    read_names(station, readings.station, table_.stations);
    if (table_.stations.empty()) table_.stations.emplace_back();
    read_names(reflector, readings.reflector, table_.reflectors);
    if (all_or_none(offset, 3)) read_offsets(offset, csv_.columns[reflector].present);
    if (table_.reflectors.empty()) table_.reflectors.emplace_back();
    return std::move(table_);
  }

  PoseList poses_only() {
    layout_.columns = axis_columns(machine_);
    const std::size_t states = add_state_columns(machine_, layout_.columns);
    csv_ = read_csv(text_, file_, layout_.columns, options_.mapping, options_.threads);
    PoseList list = poses();
    take_states(text_, file_, machine_, csv_, states, kNoColumn, {}, list);
    return list;
  }

 private:
  std::size_t add_all(std::initializer_list<const char*> bases, Quantity quantity,
                      CsvColumn::Range range = CsvColumn::Range::any) {
    const std::size_t first = layout_.columns.size();
    for (const char* base : bases) layout_.add(base, quantity, range);
    return first;
  }

  [[noreturn]] void fail_row(std::size_t row, const std::string& field, const std::string& problem,
                             const std::string& expected) const {
    throw InputError({file_, csv_line(text_, row), 0, field}, problem, expected);
  }

  /// True if all of a group of columns are there. @throws InputError if only some are
  bool all_or_none(std::size_t first, std::size_t count) const {
    std::size_t present = 0, absent = first;
    for (std::size_t i = first; i < first + count; ++i) {
      if (csv_.columns[i].present) {
        ++present;
      } else {
        absent = i;
      }
    }
    if (present == count) return true;
    if (present == 0) return false;
    fail_missing(absent);
  }

  [[noreturn]] void fail_missing(std::size_t column) const {
    const CsvColumn& wanted = layout_.columns[column];
    throw InputError({file_, 0, 0, wanted.base}, "missing column", accepted_names(wanted.base, wanted.quantity));
  }

  [[noreturn]] void fail_beside(std::size_t column, std::size_t other) const {
    throw InputError({file_, 0, 0, csv_.columns[column].header},
                     fmt::format("is given together with {}", csv_.columns[other].header), "only one of them");
  }

  PoseList poses() { return take_poses(text_, file_, machine_, csv_, options_.check_travel); }

  void read_measured(std::size_t xyz, std::size_t range) {
    const bool cartesian = all_or_none(xyz, 3), polar = all_or_none(range, 3);
    if (cartesian && polar) fail_beside(range, xyz);
    if (!cartesian && !polar) {
      throw InputError({file_, 0, 0, "measured_x"}, "missing column",
                       "measured_x_mm, measured_y_mm, measured_z_mm or range_mm, azimuth_deg, elevation_deg");
    }
    table_.readings.measure = cartesian ? TrackerMeasure::cartesian : TrackerMeasure::range_and_angles;
    const std::size_t first = cartesian ? xyz : range;
    for (std::size_t k = 0; k < 3; ++k) table_.readings.measured[k] = std::move(csv_.columns[first + k].numbers);
  }

  std::size_t add_covariance(TrackerMeasure measure) {
    const std::size_t first = layout_.columns.size();
    for (const CovarianceColumn& column : covariance_columns(measure)) {
      layout_.add(column.base, column.quantity, column.variance ? CsvColumn::Range::positive : CsvColumn::Range::any);
    }
    return first;
  }

  /// Refuses uncertainties of components that were not measured.
  void refuse_other(std::size_t first, std::size_t count) const {
    for (std::size_t i = first; i < first + count; ++i) {
      if (!csv_.columns[i].present) continue;
      const bool cartesian = table_.readings.measure == TrackerMeasure::cartesian;
      throw InputError({file_, 0, 0, csv_.columns[i].header}, "does not belong to what was measured",
                       cartesian ? "u_x_um, u_y_um, u_z_um or cov_xx_um2, ..."
                                 : "u_range_um, u_azimuth_arcsec, u_elevation_arcsec or cov_range_range_um2, ...");
    }
  }

  void read_uncertainty(std::size_t standard, std::size_t covariance) {
    const bool has_standard = all_or_none(standard, 3), has_covariance = all_or_none(covariance, 6);
    if (has_standard && has_covariance) fail_beside(covariance, standard);
    TrackerReadings& readings = table_.readings;
    if (!has_standard && !has_covariance) return;
    readings.stated = has_standard ? StatedUncertainty::standard : StatedUncertainty::covariance;
    const std::size_t first = has_standard ? standard : covariance;
    for (std::size_t k = 0; k < (has_standard ? 3U : 6U); ++k) {
      readings.uncertainty[k] = std::move(csv_.columns[first + k].numbers);
    }
    if (has_covariance) check_covariance(covariance);
  }

  void check_covariance(std::size_t first) const {
    static constexpr std::size_t kPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    const std::array<std::vector<double>, 6>& c = table_.readings.uncertainty;
    for (std::size_t row = 0; row < c[0].size(); ++row) {
      if (is_positive_definite(reading_covariance(table_.readings, row))) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const double correlation = c[3 + k][row] / std::sqrt(c[kPairs[k][0]][row] * c[kPairs[k][1]][row]);
        if (std::abs(correlation) < 1) continue;
        fail_row(row, csv_.columns[first + 3 + k].header,
                 fmt::format("implies a correlation of {:.6g} given {} and {}", correlation,
                             csv_.columns[first + kPairs[k][0]].header, csv_.columns[first + kPairs[k][1]].header),
                 "a positive definite covariance: correlations between -1 and 1");
      }
      fail_row(row, csv_.columns[first].header, "the covariance of this reading is not positive definite",
               "consistent correlations");
    }
  }

  /// Across a vertical beam an azimuth moves nothing, so that its uncertainty says nothing about the reading.
  void refuse_vertical_beams(const std::string& field) const {
    const std::vector<double>& elevation = table_.readings.measured[2];
    for (std::size_t row = 0; row < elevation.size(); ++row) {
      if (std::abs(std::cos(elevation[row])) > kVerticalBeam) continue;
      fail_row(row, field, "the beam is vertical, where an uncertainty of the azimuth has no meaning",
               "an elevation between -90 and 90 deg, or no columns of uncertainty");
    }
  }

  void read_names(std::size_t column, std::vector<std::uint16_t>& index, std::vector<std::string>& names) {
    index.assign(csv_.rows, 0);
    if (!csv_.columns[column].present) return;
    names = std::move(csv_.columns[column].names);
    const std::vector<std::uint32_t>& words = csv_.columns[column].words;
    for (std::size_t row = 0; row < csv_.rows; ++row) index[row] = static_cast<std::uint16_t>(words[row]);
  }

  /// Offsets belong to reflectors: named ones must keep theirs, and without names every offset is a reflector.
  void read_offsets(std::size_t first, bool named) {
    const std::vector<double>&x = csv_.columns[first].numbers, &y = csv_.columns[first + 1].numbers,
          &z = csv_.columns[first + 2].numbers;
    std::vector<std::uint16_t>& reflector = table_.readings.reflector;
    std::vector<Eigen::Vector3d>& offsets = table_.reflector_offset;
    std::map<std::tuple<double, double, double>, std::size_t> known;
    std::vector<std::uint8_t> seen(table_.reflectors.size());
    if (named) offsets.resize(table_.reflectors.size());
    for (std::size_t row = 0; row < csv_.rows; ++row) {
      const Eigen::Vector3d offset(x[row], y[row], z[row]);
      if (named) {
        const std::size_t i = reflector[row];
        if (seen[i] == 0) offsets[i] = offset;
        seen[i] = 1;
        if (offsets[i] == offset) continue;
        fail_row(row, csv_.columns[first].header,
                 fmt::format("reflector {} had another offset in an earlier row", table_.reflectors[i]),
                 fmt::format("({:.9g}, {:.9g}, {:.9g}) mm", offsets[i].x(), offsets[i].y(), offsets[i].z()));
      }
      const auto [entry, is_new] = known.emplace(std::tuple(x[row], y[row], z[row]), offsets.size());
      if (is_new) {
        if (offsets.size() == kLargestOffsetCount) {
          fail_row(row, csv_.columns[first].header, "too many different offsets", "at most 1000");
        }
        offsets.push_back(offset);
        table_.reflectors.push_back(fmt::format("offset{}", offsets.size()));
      }
      reflector[row] = static_cast<std::uint16_t>(entry->second);
    }
  }

  std::string_view text_;
  const std::string& file_;
  const Machine& machine_;
  const MeasurementOptions& options_;
  Layout layout_;
  CsvTable csv_;
  MeasurementTable table_;
};

}  // namespace

MeasurementTable parse_measurements(std::string_view text, const std::string& file, const Machine& machine,
                                    const MeasurementOptions& options) {
  return MeasurementReader(text, file, machine, options).measurements();
}

MeasurementTable read_measurements(const std::filesystem::path& path, const Machine& machine,
                                   const MeasurementOptions& options) {
  const MappedFile file(path);
  return parse_measurements(file.text(), path.string(), machine, options);
}

PoseList parse_poses(std::string_view text, const std::string& file, const Machine& machine,
                     const MeasurementOptions& options) {
  return MeasurementReader(text, file, machine, options).poses_only();
}

PoseList read_poses(const std::filesystem::path& path, const Machine& machine, const MeasurementOptions& options) {
  const MappedFile file(path);
  return parse_poses(file.text(), path.string(), machine, options);
}

}  // namespace abbe
