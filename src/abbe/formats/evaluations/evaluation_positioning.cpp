#include "abbe/formats/evaluations/evaluation_positioning.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include "abbe/formats/import/readable_table.h"
#include "abbe/formats/text/placed_table.h"

namespace abbe {
namespace {

/// Places of the columns among those wanted.
enum PositioningColumn : std::size_t {
  kRun,
  kApproach,
  kDiagonal,
  kTargetLength,
  kTargetAngle,
  kDeviationLength,
  kDeviationAngle,
  kActualLength,
  kActualAngle,
  kMachineTemperature,
  kInstrumentTemperature,
  kTime
};

std::vector<CsvColumn> wanted_columns(bool diagonals) {
  const auto name = [](const char* base, bool required) {
    return CsvColumn{base, Quantity::dimensionless, true, required, CsvColumn::Range::any};
  };
  std::vector<CsvColumn> columns = {name("run", false), name("direction", true), name("diagonal", diagonals)};
  for (const char* const base : {"target", "deviation", "actual"}) {
    for (const Quantity quantity : {Quantity::length, Quantity::angle}) {
      columns.push_back({base, quantity, false, false, CsvColumn::Range::any});
    }
  }
  if (diagonals) return columns;
  columns.push_back({"machine", Quantity::temperature, false, false, CsvColumn::Range::any});
  columns.push_back({"instrument", Quantity::temperature, false, false, CsvColumn::Range::any});
  columns.push_back({"time", Quantity::time, false, false, CsvColumn::Range::any});
  return columns;
}

class PositioningReader {
 public:
  PositioningReader(PlacedTable table, bool diagonals) : csv_(std::move(table)) {
    rotary_ =
        !one_of(kTargetLength, kTargetAngle, "target", "target_mm for a linear axis, target_deg for a rotary one");
    if (!diagonals && csv_.columns[kDiagonal].present) {
      fail(csv_.columns[kDiagonal].header, "the file holds diagonals",
           csv_.is_file() ? "abbe evaluate diagonals, or no such column" : "no such column, or evaluate_diagonals()");
    }
    if (diagonals && rotary_) {
      fail(csv_.columns[kTargetAngle].header, "a diagonal has no angles", "target_mm: the distance along the diagonal");
    }
    const bool has_deviation = present(kDeviationLength) || present(kDeviationAngle);
    const bool has_actual = present(kActualLength) || present(kActualAngle);
    if (has_deviation == has_actual) {
      fail("deviation", has_actual ? "is given together with the actual positions" : "missing column",
           rotary_ ? "deviation_arcsec or actual_deg, one of them" : "deviation_um or actual_mm, one of them");
    }
    is_actual_ = has_actual;
    value_ = is_actual_ ? kActualLength : kDeviationLength;
    const char* const base = is_actual_ ? "actual" : "deviation";
    const bool is_length = one_of(value_, value_ + 1, base, "");
    if (!is_length) ++value_;
    if (is_length == rotary_) {
      fail(csv_.columns[value_].header,
           fmt::format("is {}, but the targets are {}", is_length ? "a length" : "an angle",
                       rotary_ ? "angles" : "lengths"),
           fmt::format("{}_{}", base, rotary_ ? "arcsec or _deg" : "um or _mm"));
    }
    if (rotary_) refuse_temperatures();
    read_directions();
    refuse_repetitions();
  }

  bool rotary() const { return rotary_; }
  std::size_t rows() const { return csv_.rows; }
  const CsvValues& diagonal() const { return csv_.columns[kDiagonal]; }
  const std::vector<double>& numbers(PositioningColumn column) const { return csv_.columns[column].numbers; }

  PositioningReading reading(std::size_t row) const {
    const double target = csv_.columns[rotary_ ? kTargetAngle : kTargetLength].numbers[row];
    const double value = csv_.columns[value_].numbers[row];
    const double deviation = is_actual_ ? value - target : value;
    // A reading of 359.999 degrees at the target 0 is no deviation of a full turn.
    if (rotary_ && std::abs(deviation) > std::numbers::pi) {
      fail_row(row, csv_.columns[value_].header, "is more than half a turn from the target",
               "angles counted on through full turns, like the targets");
    }
    return {target, deviation, directions_[row]};
  }

 private:
  bool present(std::size_t column) const { return csv_.columns[column].present; }

  [[noreturn]] void fail(const std::string& field, const std::string& problem, const std::string& expected) const {
    throw InputError(csv_.place(field), problem, expected);
  }
  [[noreturn]] void fail_row(std::size_t row, const std::string& field, const std::string& problem,
                             const std::string& expected) const {
    throw InputError(csv_.place(row, field), problem, expected);
  }

  /// True for the length, false for the angle. @throws InputError if both or none are there
  bool one_of(std::size_t length, std::size_t angle, const std::string& base, const std::string& expected) const {
    if (present(length) && present(angle)) {
      fail(csv_.columns[angle].header, "is given together with " + csv_.columns[length].header, "only one of them");
    }
    if (!present(length) && !present(angle)) fail(base, "missing column", expected);
    return present(length);
  }

  void refuse_temperatures() const {
    for (const std::size_t column : {kMachineTemperature, kInstrumentTemperature}) {
      if (!present(column)) continue;
      fail(csv_.columns[column].header, "is the temperature of a length, but the targets are angles",
           "no such column of a rotary axis");
    }
  }

  void read_directions() {
    const CsvValues& values = csv_.columns[kApproach];
    std::vector<ApproachDirection> of_word;
    for (std::size_t i = 0; i < values.names.size(); ++i) {
      const std::string& word = values.names[i];
      const bool positive = word == "+" || word == "positive";
      if (!positive && word != "-" && word != "negative") {
        std::size_t row = 0;
        while (values.words[row] != i) ++row;
        fail_row(row, "direction", fmt::format("'{}' is not a direction of approach", word.substr(0, 40)), "+ or -");
      }
      of_word.push_back(positive ? ApproachDirection::positive : ApproachDirection::negative);
    }
    for (const std::uint32_t word : values.words) directions_.push_back(of_word[word]);
  }

  /// The same run twice at a target from the same side is a copied line or a wrong direction.
  void refuse_repetitions() const {
    const CsvValues& runs = csv_.columns[kRun];
    if (!runs.present) return;
    const CsvValues& diagonals = csv_.columns[kDiagonal];
    const std::vector<double>& targets = csv_.columns[rotary_ ? kTargetAngle : kTargetLength].numbers;
    std::map<std::tuple<std::uint32_t, std::uint32_t, ApproachDirection, double>, std::size_t> seen;
    for (std::size_t row = 0; row < csv_.rows; ++row) {
      const auto key =
          std::tuple(diagonals.present ? diagonals.words[row] : 0, runs.words[row], directions_[row], targets[row]);
      const auto entry = seen.emplace(key, row);
      if (entry.second) continue;
      fail_row(row, "run",
               fmt::format("run {} approaches this target twice from the same side, first in {}",
                           runs.names[runs.words[row]].substr(0, 40), csv_.row_words(entry.first->second)),
               "one reading per run, direction and target");
    }
  }

  PlacedTable csv_;
  bool rotary_ = false, is_actual_ = false;
  std::size_t value_ = kDeviationLength;
  std::vector<ApproachDirection> directions_;
};

PositioningFile positioning_readings_of(const PositioningReader& reader) {
  PositioningFile result;
  result.rotary = reader.rotary();
  result.readings.reserve(reader.rows());
  for (std::size_t row = 0; row < reader.rows(); ++row) result.readings.push_back(reader.reading(row));
  result.machine_temperature = reader.numbers(kMachineTemperature);
  result.instrument_temperature = reader.numbers(kInstrumentTemperature);
  result.time = reader.numbers(kTime);
  return result;
}

std::vector<DiagonalReadings> diagonals_of(const PositioningReader& reader) {
  std::vector<DiagonalReadings> result;
  for (const std::string& name : reader.diagonal().names) result.push_back({name, {}});
  for (std::size_t row = 0; row < reader.rows(); ++row) {
    result[reader.diagonal().words[row]].readings.push_back(reader.reading(row));
  }
  return result;
}

}  // namespace

PositioningFile parse_positioning(std::string_view text, const std::string& file, const ColumnMapping& mapping) {
  return positioning_readings_of({{text, file, wanted_columns(false), mapping}, false});
}

PositioningFile parse_positioning(const NamedColumns& columns) {
  return positioning_readings_of({{columns, wanted_columns(false)}, false});
}

std::vector<DiagonalReadings> parse_diagonals(std::string_view text, const std::string& file,
                                              const ColumnMapping& mapping) {
  return diagonals_of({{text, file, wanted_columns(true), mapping}, true});
}

std::vector<DiagonalReadings> parse_diagonals(const NamedColumns& columns) {
  return diagonals_of({{columns, wanted_columns(true)}, true});
}

PositioningFile read_positioning(const std::filesystem::path& path, const ColumnMapping& mapping) {
  return read_readable_table(path, wanted_columns(false), mapping,
                             [&](std::string_view text) { return parse_positioning(text, path.string(), mapping); });
}

std::vector<DiagonalReadings> read_diagonals(const std::filesystem::path& path, const ColumnMapping& mapping) {
  return read_readable_table(path, wanted_columns(true), mapping,
                             [&](std::string_view text) { return parse_diagonals(text, path.string(), mapping); });
}

}  // namespace abbe
