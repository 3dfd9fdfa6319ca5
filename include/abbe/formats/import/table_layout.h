#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// What stands between two fields of a row. `blanks`: any number of blanks and tabs.
enum class FieldSeparator { comma, semicolon, tab, blanks };
enum class DecimalMark { point, comma };
/// What stands between groups of three digits before the decimal mark. `blank` is also a no-break or thin space.
enum class ThousandsMark { none, comma, point, blank, apostrophe };

/// "comma", "semicolon", "tab", "blanks"; "point", "comma"; "none", "comma", ...
std::string_view separator_name(FieldSeparator separator);
std::string_view decimal_name(DecimalMark decimal);
std::string_view thousands_name(ThousandsMark thousands);
/// All names, in the order of the values.
std::vector<std::string_view> separator_names();
std::vector<std::string_view> decimal_names();
std::vector<std::string_view> thousands_names();

/// How a table that another program wrote is laid out. Lines count from 1; blank lines count too.
struct TableLayout {
  FieldSeparator separator = FieldSeparator::comma;
  DecimalMark decimal = DecimalMark::point;
  ThousandsMark thousands = ThousandsMark::none;
  std::string comment;          ///< what comment lines begin with, such as "#"; empty: there are none
  std::size_t header_line = 0;  ///< names of the columns; 0: there are none
  std::size_t unit_line = 0;    ///< units of the columns; 0: not in a row of their own
  std::size_t first_line = 1;   ///< of the rows; other lines above it are passed over
};

/// A layout and what its header says.
struct FoundLayout {
  TableLayout layout;
  std::vector<std::string> names;    ///< [columns] as in the header; empty texts where it says nothing
  std::vector<std::string> units;    ///< [columns] as in the row of units, likewise
  bool short_header = false;         ///< rows have a field more than the header: behind the last separator, empty
  std::vector<std::string> reasons;  ///< a sentence each
  std::vector<std::string> doubts;   ///< what somebody has to look at, a sentence each
};

/// A column in words for a terminal: "column 4 'X soll'", "column 4" without a name. @param column  from 0
std::string column_words(std::size_t column, std::string_view name);

/// What the caller knows.
struct LayoutHints {
  std::optional<FieldSeparator> separator{};
  std::optional<DecimalMark> decimal{};
};

/// Finds the layout of a table. All rows together decide about the decimal mark: "1,234" means one and a bit beside
/// "12,5", and more than a thousand beside "12.5".
/// @param text  UTF-8, of decode_foreign_text()
/// @param file  name for messages
/// @throws InputError if there are no two columns, if rows speak for both decimal marks, and if no number tells which
///   one it is: then with the option that does
FoundLayout find_layout(std::string_view text, const std::string& file, const LayoutHints& hints = {});

/// What the header of a file says whose layout is known. @throws InputError if the lines are not there
FoundLayout layout_as_given(std::string_view text, const std::string& file, const TableLayout& layout);

}  // namespace abbe
