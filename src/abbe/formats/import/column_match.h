#pragma once

// Internal to formats: which column of a file is which column of a kind, by names.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/import/import_kind.h"
#include "abbe/formats/import/proposed_mapping.h"
#include "abbe/formats/import/table_facts.h"

namespace abbe {

inline constexpr std::size_t kNoSource = static_cast<std::size_t>(-1);

/// Columns of a file for the columns of a kind.
struct ColumnMatch {
  std::vector<std::size_t> source;   ///< [columns of the kind] index of the file's column, or kNoSource
  std::vector<bool> own_name;        ///< [columns of the kind] the header is the one that Abbe reads
  std::vector<std::string> doubts;   ///< [columns of the kind] a sentence, or empty
  std::size_t actual = kNoSource;    ///< of a positioning test: actual positions beside deviations, which are not read
  std::vector<std::string> missing;  ///< bases that are needed and not there; "measured_x" for all of a point

  bool is_complete() const { return missing.empty(); }
};

ColumnMatch match_by_names(ImportKind kind, const std::vector<ImportColumn>& wanted,
                           const std::vector<ColumnFacts>& file);
/// Of a file without a header: numbers in their order. Everything is in doubt.
/// @param polar  null: the point of a tracker is in coordinates
ColumnMatch match_by_order(ImportKind kind, const std::vector<ImportColumn>& wanted,
                           const std::vector<ColumnFacts>& file, const PolarOrder* polar = nullptr);

/// A column that has the name of a wanted one and a unit that is none of its quantity.
struct WrongUnit {
  std::size_t source = 0;  ///< index of the file's column
  std::string unit;        ///< as written
};

/// The first such column, for messages.
std::optional<WrongUnit> wrong_unit(const ImportColumn& wanted, const std::vector<ColumnFacts>& file);

/// Whether a column is one of those that are taken by their order.
bool is_taken_by_order(const ImportColumn& column);

/// What a word of a column of directions means: +1, -1, or 0 for any other word. Counter-clockwise is +1.
int direction_of_word(ImportColumn::Holds holds, const std::string& word);

}  // namespace abbe
