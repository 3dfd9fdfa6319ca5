#include "abbe/formats/readings/indication_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/error_fields.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {
namespace {

// The covariance of the errors found has (6 positions)^2 entries.
constexpr std::size_t kLargestPositionCount = 500;
constexpr std::size_t kLargestProbeCount = 1000;
// Below any instrument; weights beside those of a dial stay within double precision.
constexpr double kSmallestUncertainty = 1e-9;

/// 0, 1, 2 for X, Y, Z if the axis is parallel to one of them.
std::optional<std::size_t> principal_direction(const Axis& axis) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (axis.direction == Eigen::Vector3d::Unit(static_cast<Eigen::Index>(i))) return i;
  }
  return std::nullopt;
}

/// "-Y" of a direction along a machine axis; empty for any other.
std::string direction_text(const Eigen::Vector3d& direction) {
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (direction == Eigen::Vector3d::Unit(i)) return std::string(1, "XYZ"[i]);
    if (direction == -Eigen::Vector3d::Unit(i)) return std::string("-") + "XYZ"[i];
  }
  return "";
}

std::optional<Eigen::Vector3d> parse_direction(std::string_view text) {
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Vector3d direction = sign * Eigen::Vector3d::Unit(i);
      const std::string name = direction_text(direction);
      if (text == name || (sign > 0 && text == "+" + name)) return direction;
    }
  }
  return std::nullopt;
}

class IndicationReader {
 public:
  IndicationReader(std::string_view text, const std::string& file, const Machine& machine,
                   const IndicationOptions& options)
      : text_(text), file_(file), machine_(machine), options_(options) {}

  IndicationTable read() {
    std::vector<CsvColumn> columns;
    for (const Axis& axis : machine_.axes) {
      columns.push_back({axis.name, axis_quantity(axis), false, false, CsvColumn::Range::any});
    }
    const std::size_t direction = columns.size();
    columns.push_back({"direction", Quantity::dimensionless, true, true, CsvColumn::Range::any});
    for (const char* base : {"place_x", "place_y", "place_z", "indication"}) {
      columns.push_back({base, Quantity::length, false, true, CsvColumn::Range::any});
    }
    columns.push_back({"u", Quantity::length, false, false, CsvColumn::Range::positive});
    csv_ = read_csv(text_, file_, columns, {}, 1);
    find_axis();
    direction_ = &csv_.columns[direction];
    for (std::size_t i = 0; i < 3; ++i) place_[i] = &csv_.columns[direction + 1 + i];
    indication_ = &csv_.columns[direction + 4];
    uncertainty_ = &csv_.columns[direction + 5];
    find_positions();
    find_probes();
    fill();
    return std::move(table_);
  }

 private:
  [[noreturn]] void fail_row(std::size_t row, const std::string& field, const std::string& problem,
                             const std::string& expected) const {
    throw InputError({file_, csv_line(text_, row), 0, field}, problem, expected);
  }

  void find_axis() {
    std::vector<std::size_t> present;
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
      if (csv_.columns[i].present) present.push_back(i);
    }
    std::string names;
    for (const Axis& axis : machine_.axes) {
      names += (names.empty() ? "one of " : ", ") + axis.name + (axis.kind == AxisKind::linear ? "_mm" : "_deg");
    }
    if (present.empty()) throw InputError({file_, 0, 0, ""}, "no column with the commands of an axis", names);
    if (present.size() > 1) {
      throw InputError({file_, 0, 0, csv_.columns[present[1]].header},
                       fmt::format("is given together with {}", csv_.columns[present[0]].header),
                       "readings of one axis a file");
    }
    table_.axis = present[0];
    const Axis& axis = machine_.axes[table_.axis];
    const std::optional<std::size_t> direction = principal_direction(axis);
    if (!direction) {
      throw InputError({file_, 0, 0, csv_.columns[table_.axis].header},
                       fmt::format("axis {} is inclined in this machine", axis.name), "an axis along X, Y or Z");
    }
    table_.readings.kind = axis.kind;
    table_.readings.direction = *direction;
    table_.readings.sense = axis.sense();
  }

  void find_positions() {
    std::vector<double>& positions = table_.readings.positions;
    positions = csv_.columns[table_.axis].numbers;
    std::sort(positions.begin(), positions.end());
    positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
    if (positions.size() > kLargestPositionCount) {
      throw InputError({file_, 0, 0, csv_.columns[table_.axis].header},
                       fmt::format("{} different positions", positions.size()),
                       fmt::format("at most {}", kLargestPositionCount));
    }
  }

  void find_probes() {
    std::vector<Eigen::Vector3d> directions;
    for (const std::string& name : direction_->names) {
      const std::optional<Eigen::Vector3d> direction = parse_direction(name);
      directions.push_back(direction.value_or(Eigen::Vector3d::Zero()));
    }
    const Eigen::Index along = static_cast<Eigen::Index>(table_.readings.direction);
    std::map<std::tuple<std::string, double, double, double>, std::size_t> known;
    probe_of_row_.resize(csv_.rows);
    for (std::size_t row = 0; row < csv_.rows; ++row) {
      const std::size_t word = direction_->words[row];
      const Eigen::Vector3d& direction = directions[word];
      if (direction.isZero()) {
        fail_row(row, direction_->header, fmt::format("'{}' is not a direction", direction_->names[word]),
                 "X, Y, Z, -X, -Y or -Z");
      }
      const Eigen::Vector3d place(place_[0]->numbers[row], place_[1]->numbers[row], place_[2]->numbers[row]);
      std::vector<DisplacementProbe>& probes = table_.readings.probes;
      const auto [entry, is_new] =
          known.emplace(std::tuple(direction_text(direction), place.x(), place.y(), place.z()), probes.size());
      const double stated = uncertainty_->present   ? uncertainty_->numbers[row]
                            : direction[along] != 0 ? options_.along_axis
                                                    : options_.across_axis;
      if (uncertainty_->present && stated < kSmallestUncertainty) {
        fail_row(row, uncertainty_->header, fmt::format("is {:.9g} um", 1e3 * stated), "at least 1e-6 um");
      }
      if (!(stated > 0)) throw InputError({file_, 0, 0, "u_um"}, "missing column", "the standard uncertainty, u_um");
      if (is_new) {
        if (probes.size() == kLargestProbeCount) {
          fail_row(row, place_[0]->header, "too many different probes", fmt::format("at most {}", kLargestProbeCount));
        }
        probes.push_back({direction, place, stated});
      } else if (probes[entry->second].standard_uncertainty != stated) {
        fail_row(row, uncertainty_->header, "this probe had another uncertainty in an earlier row",
                 fmt::format("{:.9g} um", 1e3 * probes[entry->second].standard_uncertainty));
      }
      probe_of_row_[row] = entry->second;
    }
  }

  std::string probe_name(std::size_t probe) const {
    const DisplacementProbe& p = table_.readings.probes[probe];
    return fmt::format("direction {} at ({:.9g}, {:.9g}, {:.9g}) mm", direction_text(p.direction), p.place.x(),
                       p.place.y(), p.place.z());
  }
  std::string position_name(std::size_t position) const {
    const Axis& axis = machine_.axes[table_.axis];
    const Unit& unit = unit_named(axis_quantity(axis), axis.kind == AxisKind::linear ? "mm" : "deg");
    return fmt::format("{} = {:.9g} {}", axis.name, table_.readings.positions[position] / unit.factor, unit.suffix);
  }

  void fill() {
    AxisIndications& readings = table_.readings;
    const std::size_t count = readings.positions.size(), probes = readings.probes.size();
    constexpr std::size_t kNone = static_cast<std::size_t>(-1);
    std::vector<std::size_t> row_of(count * probes, kNone);
    for (std::size_t row = 0; row < csv_.rows; ++row) {
      const std::size_t position =
          static_cast<std::size_t>(std::lower_bound(readings.positions.begin(), readings.positions.end(),
                                                    csv_.columns[table_.axis].numbers[row]) -
                                   readings.positions.begin());
      std::size_t& entry = row_of[position * probes + probe_of_row_[row]];
      if (entry != kNone) {
        fail_row(row, indication_->header,
                 fmt::format("a second reading in {} at {}, after line {}", probe_name(probe_of_row_[row]),
                             position_name(position), csv_line(text_, entry)),
                 "one reading of every probe at every position");
      }
      entry = row;
    }
    readings.indications.resize(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(probes));
    for (std::size_t i = 0; i < row_of.size(); ++i) {
      if (row_of[i] == kNone) {
        throw InputError({file_, 0, 0, indication_->header},
                         fmt::format("no reading in {} at {}", probe_name(i % probes), position_name(i / probes)),
                         "one reading of every probe at every position");
      }
      readings.indications(static_cast<Eigen::Index>(i / probes), static_cast<Eigen::Index>(i % probes)) =
          indication_->numbers[row_of[i]];
    }
  }

  std::string_view text_;
  const std::string& file_;
  const Machine& machine_;
  const IndicationOptions& options_;
  CsvTable csv_;
  const CsvValues* direction_ = nullptr;
  std::array<const CsvValues*, 3> place_{};
  const CsvValues* indication_ = nullptr;
  const CsvValues* uncertainty_ = nullptr;
  std::vector<std::size_t> probe_of_row_;
  IndicationTable table_;
};

}  // namespace

IndicationTable parse_indications(std::string_view text, const std::string& file, const Machine& machine,
                                  const IndicationOptions& options) {
  return IndicationReader(text, file, machine, options).read();
}

IndicationTable read_indications(const std::filesystem::path& path, const Machine& machine,
                                 const IndicationOptions& options) {
  const MappedFile file(path);
  return parse_indications(file.text(), path.string(), machine, options);
}

std::string indications_text(const Machine& machine, const IndicationTable& table) {
  const Axis& axis = machine.axes[table.axis];
  const char* const suffix = axis.kind == AxisKind::linear ? "mm" : "deg";
  const Unit &command = unit_named(axis_quantity(axis), suffix), &um = unit_named(Quantity::length, "um");
  std::string text =
      csv_field(axis.name + "_" + suffix) + ",direction,place_x_mm,place_y_mm,place_z_mm,indication_um,u_um\n";
  const AxisIndications& readings = table.readings;
  for (std::size_t i = 0; i < readings.positions.size(); ++i) {
    for (std::size_t j = 0; j < readings.probes.size(); ++j) {
      const DisplacementProbe& probe = readings.probes[j];
      const std::string direction = direction_text(probe.direction);
      assert(!direction.empty());
      text += quantity_text(readings.positions[i], command) + "," + direction;
      for (Eigen::Index k = 0; k < 3; ++k) text += "," + shortest_text(probe.place[k]);
      const double indication = readings.indications(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      text += "," + quantity_text(indication, um) + "," + quantity_text(probe.standard_uncertainty, um) + "\n";
    }
  }
  return text;
}

}  // namespace abbe
