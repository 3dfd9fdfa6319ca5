#pragma once

#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Error motions of one axis over nodes that they share; straight lines between.
struct ErrorTable {
  std::size_t axis = 0;
  std::vector<double> positions;            ///< [n] increasing, mm or rad
  std::vector<Component> components;        ///< in the order of the columns, each once
  std::vector<std::vector<double>> values;  ///< [components][n] actual minus nominal, mm or rad
  bool operator==(const ErrorTable&) const = default;
};

/// Errors as a control with a kinematic model of ISO 230-1 holds them.
struct ErrorTables {
  std::vector<ErrorTable> tables;
  std::vector<LocationError> locations;  ///< standard uncertainties unused
  bool operator==(const ErrorTables&) const = default;
};

/// The same as a set of errors with linear tables. A table of one node is the same everywhere.
ErrorSet errors_of(const ErrorTables& tables);

struct ErrorTableOptions {
  std::vector<bool> axes;      ///< [axes] wanted; empty: all
  double tolerance_mm = 1e-4;  ///< between straight lines and the error motion
  double tolerance_rad = 1e-7;
  std::size_t most_nodes = 10000;  ///< per axis
  double step_multiple_mm = 1e-3;  ///< see NodeSpacing::step_multiple
  double step_multiple_rad = 0;
};

struct BuiltErrorTables {
  ErrorTables tables;
  std::vector<std::vector<double>> interpolation_error;  ///< [tables][components] mm or rad
};

/// Tables of all error motions that are there, sums of their terms; all location errors.
BuiltErrorTables build_error_tables(const Machine& machine, const ErrorSet& errors, const ErrorTableOptions& options);

}  // namespace abbe
