#pragma once

// Files that instruments and controls write in a form of their own, as abbe import reads them. A form is a row of
// instrument_formats() and a reader in a file of its own; nothing else names one.
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/import/import_kind.h"
#include "abbe/formats/import/proposed_mapping.h"

namespace abbe {

/// What a file says beside its readings, as it says it: "Air temp", "20.34 20.38 0".
struct InstrumentFact {
  std::string name, value;
};

/// A column of readings. Its fields are as Abbe reads them, in the unit of the file.
struct InstrumentColumn {
  std::string name;             ///< what the file calls it; `from` of mapping files
  std::string base;             ///< the column of the kind that it becomes: "deviation"
  std::string unit{};           ///< as in mapping files, such as "um"; empty: it has none
  bool unit_is_stated = false;  ///< by the file, or by the description of its form
  std::string reason{};         ///< one sentence
  std::vector<std::string> doubts{};
};

/// The readings of a file, and what was found in it.
struct InstrumentTable {
  ImportKind kind = ImportKind::points;
  std::vector<InstrumentColumn> columns;
  std::string rows;                   ///< fields separated by commas, in quotes where they need them; lines end in LF
  std::vector<std::size_t> lines;     ///< [rows] where they are in the file, from 1
  std::vector<std::string> reasons;   ///< a sentence each
  std::vector<std::string> doubts;    ///< about the file as a whole, a sentence each
  std::vector<InstrumentFact> facts;  ///< shown, and otherwise not used
  std::vector<std::string> not_read;  ///< keys and parts that were passed over, in words
};

/// Its columns as import proposes them, in their order.
std::vector<ProposedColumn> proposed_columns(const InstrumentTable& table);

struct Recognition {
  std::string reason;   ///< "HEADER:: in line 1"
  bool certain = true;  ///< false: other programs may write the same
};

struct InstrumentFormat {
  std::string_view name;   ///< of options and mapping files: "renishaw-laser"
  std::string_view words;  ///< "file of a Renishaw laser interferometer"
  /// Looks at the beginning of a text. @returns nothing if it is no such file
  std::optional<Recognition> (*recognise)(std::string_view text);
  /// @throws InputError with file, line, field and what was expected
  InstrumentTable (*read)(std::string_view text, const std::string& file, const ImportHints& hints);
};

/// All forms, in the order in which a text is compared with them.
const std::vector<InstrumentFormat>& instrument_formats();
/// Null if there is none of that name.
const InstrumentFormat* instrument_format_named(std::string_view name);

/// "table", for files in no such form.
inline constexpr std::string_view kTableFormat = "table";
/// "table" and the names of all forms, for options.
std::vector<std::string> import_format_names();

struct RecognisedFormat {
  const InstrumentFormat* format = nullptr;
  Recognition recognition;
};

/// The first form that is certain, or else the first that is possible. @returns nothing for a table
std::optional<RecognisedFormat> recognise_instrument(std::string_view text);

}  // namespace abbe
