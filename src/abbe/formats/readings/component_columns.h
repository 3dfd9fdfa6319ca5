#pragma once

// Internal to formats: columns of what a reading consists of, in files of any instrument.
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/unit.h"
#include "abbe/instruments/instrument.h"

namespace abbe {

/// How much the length of a quaternion may differ from 1.
inline constexpr double kQuaternionLength = 1e-3;

Quantity component_quantity(const ReadingComponent& component);

/// Groups of columns, added to those that are wanted of a file, and taken from its table.
class ComponentColumns {
 public:
  ComponentColumns(const Instrument& instrument, std::vector<CsvColumn>& wanted);

  /// Known numbers, measured numbers and their uncertainties.
  /// @throws InputError if columns are there in part, or contradict each other, and for a covariance that is not
  ///   positive definite
  void take(std::string_view text, const std::string& file, CsvTable& table, InstrumentReadings& readings) const;

 private:
  bool all_or_none(const std::string& file, const CsvTable& table, std::size_t first, std::size_t count,
                   const std::string& otherwise) const;
  void take_orientation(std::string_view text, const std::string& file, CsvTable& table,
                        InstrumentReadings& readings) const;
  void take_uncertainty(std::string_view text, const std::string& file, CsvTable& table,
                        InstrumentReadings& readings) const;

  const Instrument& instrument_;
  std::vector<CsvColumn> wanted_;
  bool has_orientation_;
  std::size_t input_ = 0, angles_ = 0, vector_ = 0, component_ = 0, uncertainty_ = 0, covariance_ = 0;
};

/// A column with a covariance of two components.
struct ComponentCovariance {
  std::string base;   ///< "cov_x_turn_y"
  Quantity quantity;  ///< decides the units its name may have
  const char* unit;   ///< in which it is written
};
/// Of all, in the order of InstrumentReadings::covariance.
std::vector<ComponentCovariance> component_covariances(const Instrument& instrument);

}  // namespace abbe
