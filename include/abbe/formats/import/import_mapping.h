#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/import/foreign_text.h"
#include "abbe/formats/import/import_kind.h"
#include "abbe/formats/import/table_layout.h"
#include "abbe/formats/text/unit.h"

namespace abbe {

/// One column that is written, and where it comes from.
struct MappedColumn {
  std::string name;             ///< as Abbe reads it, with its unit: "measured_x_mm"
  std::string from;             ///< the name in the header of the file; empty: by number
  std::size_t from_column = 0;  ///< from 1; 0: by name
  std::string unit;             ///< of the file, such as "inch"; empty for texts and numbers without one
  ImportConvention convention = ImportConvention::as_written;
  std::vector<std::string> positive, negative;  ///< of a direction: the words of the file; ccw is positive
};

/// How tables of one program are read: everything that abbe import decides, so that the next file is read likewise.
struct ImportMapping {
  ImportKind kind = ImportKind::points;
  std::string format{};                  ///< of an instrument, by its name; empty: a table, which has a layout
  std::optional<TextEncoding> encoding;  ///< absent: found from the bytes of each file
  TableLayout layout{};
  std::vector<MappedColumn> columns{};
  std::string file{};  ///< it was read from, for messages; empty: none
};

/// Names of the units of a quantity in mapping files: "mm", "inch", ...
std::vector<std::string> import_unit_names(Quantity quantity);

/// A `*.import.toml` file; see docs/import.md. @throws InputError
ImportMapping read_import_mapping(const std::filesystem::path& path);
/// The same from text. @param file  name for messages
ImportMapping parse_import_mapping(const std::string& text, const std::string& file);

/// Text of such a file; parse_import_mapping() gives back the same mapping.
/// @param remarks  [columns] comments above the columns, lines without their marks; or empty
std::string import_mapping_text(const ImportMapping& mapping,
                                const std::vector<std::vector<std::string>>& remarks = {});

}  // namespace abbe
