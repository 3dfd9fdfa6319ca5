#pragma once

#include <optional>
#include <string>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/report/partial_errors.h"
#include "abbe/verify/table_loss.h"
#include "abbe/verify/volumetric_figures.h"
#include "compensate/table_formats.h"

namespace abbe {

/// What tables for a control do and do not do, for the report.
struct TableReport {
  const TableFormat* format = nullptr;
  const Machine* machine = nullptr;
  const ControllerTables* tables = nullptr;
  double tolerance_mm = 0, tolerance_rad = 0;  ///< of straight lines between nodes
  PoseList poses;
  std::vector<std::size_t> grid;  ///< positions per axis, chain order
  /// Predicted from the errors file over the grid of all commands (docs/conventions.md).
  VolumetricFigures volumetric;
  /// Volumetric error that these tables leave of it over `poses`, the datum fitted; mm.
  SampleStatistics left_by_tables;
  /// Over `poses`, which lie between the nodes: displacement as a control sees it, no datum fitted, the worse direction
  /// of approach.
  PoseDeviations before, after, ideal;
  std::size_t ideal_not_reached = 0;
  PartialErrors partial;  ///< what the errors file does not state
  std::vector<CarriedError> errors;
  std::vector<double>
      uncertainty;  ///< [tables] largest standard uncertainty of a correction, mm or rad; empty: not stated
  std::vector<std::string> left_out;                           ///< "X: at most 1.2 times its standard uncertainty"
  std::vector<std::string> left_out_kept;                      ///< small by themselves, but not together
  std::vector<std::pair<std::string, std::string>> reversals;  ///< name and where it is, or what takes it
  std::vector<std::string> refused;                            ///< what is above a limit
  std::vector<std::string> written;
  double largest_mm = 0;  ///< of the sum of corrections of a linear axis over the grid
  double largest_rad = 0;
  std::string largest_mm_at, largest_rad_at;
  /// Standard uncertainty of the displacement that is corrected, over `poses`; mm.
  std::optional<SampleStatistics> uncertainty_statistics;
};

void print_table_report(const TableReport& report);
void print_table_json(const TableReport& report);

/// Deviations over the grid before, with these tables and with the ideal correction, as a map for map_file.h.
std::string table_map_text(const TableReport& report, bool csv);
/// Whether the poses make a structured map (.vts) or an unstructured one (.vtu).
bool table_map_is_structured(const TableReport& report);

}  // namespace abbe
