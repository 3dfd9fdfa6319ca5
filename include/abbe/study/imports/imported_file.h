#pragma once

// A table that another program wrote, as `abbe import` reads it:
//
//   #include <abbe/formats/machine/machine_file.h>
//   #include <abbe/study/imports/imported_file.h>
//
//   #include <cstdio>
//
//   int main() {
//     abbe::ImportRequest request;
//     request.file = "examples/import/total-station.txt";
//     request.text = abbe::read_foreign_text(request.file);
//     request.machine = abbe::read_machine("examples/machines/three-axis-mill.machine.toml");
//     request.hints.clockwise = true;
//     const abbe::ImportedTable result = abbe::import_table(request);
//     for (const abbe::ProposedColumn& column : result.columns) {
//       std::printf("%s: column %zu\n", column.column.name.c_str(), column.source + 1);
//     }
//     std::printf("%zu rows, %s\n", result.rows.rows, result.is_certain() ? "certain" : "in doubt");
//     return 0;  // result.rows.csv is what abbe reads; imported_table_text(result) has the reasons
//   }
//
// It prints:
//
//   point: column 1
//   X_mm: column 2
//   Y_mm: column 3
//   Z_mm: column 4
//   range_m: column 7
//   azimuth_deg: column 5
//   elevation_deg: column 6
//   12 rows, certain
//
// What is found and how: docs/import.md.

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/import/foreign_text.h"
#include "abbe/formats/import/import_mapping.h"
#include "abbe/formats/import/imported_rows.h"
#include "abbe/formats/import/instrument_format.h"
#include "abbe/formats/import/proposed_mapping.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// A table, or a file of an instrument, and what is known of it. Messages name a field by the option of `abbe import`
/// that sets it, given below.
struct ImportRequest {
  ForeignText text;
  std::string file;                      ///< name for texts and messages
  std::string format{};                  ///< --format: of import_format_names(); empty: found from the contents
  std::optional<ImportKind> kind;        ///< --as; absent: found from the columns
  std::optional<Machine> machine;        ///< --machine: of a tracker's commands
  std::optional<ImportMapping> mapping;  ///< --mapping: nothing is proposed, and nothing is in doubt
  ImportHints hints;                     ///< --separator, --decimal, --length-unit, ...; not with a mapping
  bool accept_doubts = false;            ///< --accept-uncertain
  int threads = 0;                       ///< 0: all; the result does not depend on it
};

/// An imported table. It holds no reference to the request.
struct ImportedTable {
  std::string file;
  TextEncoding encoding = TextEncoding::utf8;
  std::string encoding_reason;
  bool packed = false;               ///< it was compressed by gzip
  std::string format{kTableFormat};  ///< of import_format_names()
  std::string format_reason;         ///< of a form of an instrument
  FoundLayout found;                 ///< with reasons and doubts; of a file of an instrument only the columns count
  ImportMapping mapping;             ///< as it was used
  std::string kind_reason;
  std::vector<ProposedColumn> columns;  ///< with reasons and doubts, in the order of the mapping
  std::vector<std::string> not_read;    ///< other columns and parts, in words
  std::vector<InstrumentFact> facts;    ///< what a file of an instrument says beside its readings
  ImportedRows rows;                    ///< its CSV was read back by the reader of its kind
  bool doubts_accepted = false;

  /// False of a file of an instrument that only states something.
  bool has_readings() const { return !columns.empty(); }
  /// All doubts, with the column that they are about.
  std::vector<std::string> doubts() const;
  /// Whether nothing is in doubt that was not accepted.
  bool is_certain() const { return doubts_accepted || doubts().empty(); }
};

/// Reads a table by its mapping, or by the one that it proposes. Opens no file and prints nothing.
/// @throws InputError as find_layout(), propose_mapping() and imported_rows(), and for rows that the reader of the kind
///   refuses, such as commands outside the travel of their axis; with the line of the table
ImportedTable import_table(const ImportRequest& request);

/// The mapping as a file, with the reasons as comments; import_table() with it gives the same CSV.
/// @throws InputError if the file has no readings
std::string imported_mapping_text(const ImportedTable& result);
/// For people; complete lines.
std::string imported_table_text(const ImportedTable& result);
/// What the user must do if the result is not certain, for the command.
std::string_view what_to_do_next(const ImportedTable& result);
/// For programs.
nlohmann::ordered_json imported_table_json(const ImportedTable& result);

}  // namespace abbe
