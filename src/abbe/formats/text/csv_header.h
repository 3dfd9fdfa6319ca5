#pragma once

// Internal to formats: the header line of a CSV file.
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/csv_reader.h"

namespace abbe {

inline constexpr std::size_t kUnreadColumn = static_cast<std::size_t>(-1);

/// What to do with one column of the file.
struct CsvFileColumn {
  std::string name;                    ///< as written
  std::size_t wanted = kUnreadColumn;  ///< index of the wanted column
  const Unit* unit = nullptr;          ///< null for texts
};

/// Next line from `at` on, without its line end; moves `at` behind it.
std::string_view csv_next_line(std::string_view text, std::size_t& at);
/// True if a line is blank or a comment.
bool csv_is_passed_over(std::string_view line);
/// Without spaces and tabs at both ends.
std::string_view csv_trimmed(std::string_view field);
/// Takes one field off a line. @returns false if a quote is not closed or is followed by more text
bool csv_take_field(std::string_view& line, std::string_view& field, std::string& unquoted, bool& more);

/// The names of a header, for readers that do not know all names beforehand.
struct CsvNames {
  std::size_t line = 0;            ///< of the header; 0: there is none
  std::vector<std::string> names;  ///< as written; up to the first that cannot be read
};
CsvNames csv_names(std::string_view text);

/// Matches the header with what is wanted. @throws InputError
std::vector<CsvFileColumn> csv_match_header(std::string_view header, const std::string& file, std::size_t line,
                                            const std::vector<CsvColumn>& wanted, const ColumnMapping& mapping);

}  // namespace abbe
