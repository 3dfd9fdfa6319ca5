#pragma once

// Internal to formats: files of readings that another program wrote, for the readers of abbe fit, register, deviate and
// evaluate. What such a reader can read as it stands is read as it stands.
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {

/// The contents of a file: unpacked where gzip packed them.
class UnpackedFile {
 public:
  /// @throws InputError as MappedFile, and for damaged gzip or more than 1 GiB of contents
  explicit UnpackedFile(const std::filesystem::path& path);
  bool is_packed() const { return unpacked_.has_value(); }
  std::string_view text() const { return unpacked_ ? std::string_view(*unpacked_) : mapped_.text(); }

 private:
  MappedFile mapped_;
  std::optional<std::string> unpacked_;
};

/// The same in UTF-8, if it is in UTF-16, Latin-1 or Windows-1252. @returns nothing for UTF-8, and for bytes that are
/// none of these, such as comments in another encoding
/// @throws InputError for bytes with zeros that are not text
std::optional<std::string> text_in_utf8(std::string_view bytes, const std::string& file);

/// A table that read_csv() cannot read as it stands, as one that it reads: fields separated by commas, decimal points,
/// units that Abbe reads in the names of the columns. Every line stays in its place, so that messages name the lines of
/// the file; what is no row and no header becomes a blank line.
/// @param wanted  columns of the reader. Others keep their names
/// @returns nothing if that changes nothing, or if no table with a header is found
/// @throws InputError if nothing tells decimals from thousands, for a unit that has two meanings, and for a column in
///   another unit than `mapping` says
std::optional<std::string> plain_table(std::string_view text, const std::string& file,
                                       const std::vector<CsvColumn>& wanted, const ColumnMapping& mapping);

/// Points without a header, in lines of numbers separated by blanks. @returns as plain_table()
/// @throws InputError if nothing tells decimals from thousands
std::optional<std::string> plain_points(std::string_view text, const std::string& file);

/// What `parse` makes of a text, or else of the text as plain_table() has it.
template <class Parse>
auto parse_readable_table(std::string_view text, const std::string& file, const std::vector<CsvColumn>& wanted,
                          const ColumnMapping& mapping, const Parse& parse) {
  std::optional<std::string> plain;
  try {
    return parse(text);
  } catch (const InputError&) {
    plain = plain_table(text, file, wanted, mapping);
    if (!plain) throw;
  }
  return parse(std::string_view(*plain));
}

/// The same of a file in any encoding, which may be compressed by gzip.
template <class Parse>
auto read_readable_table(const std::filesystem::path& path, const std::vector<CsvColumn>& wanted,
                         const ColumnMapping& mapping, const Parse& parse) {
  const UnpackedFile file(path);
  const std::optional<std::string> decoded = text_in_utf8(file.text(), path.string());
  return parse_readable_table(decoded ? std::string_view(*decoded) : file.text(), path.string(), wanted, mapping,
                              parse);
}

}  // namespace abbe
