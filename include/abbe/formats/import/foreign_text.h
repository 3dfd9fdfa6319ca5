#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// How the characters of a file are written as bytes. Windows-1252 has the characters of Latin-1 and some more.
enum class TextEncoding { utf8, utf16_le, utf16_be, windows_1252 };

/// "utf-8", "utf-16le", "utf-16be", "windows-1252".
std::string_view encoding_name(TextEncoding encoding);
std::optional<TextEncoding> encoding_named(std::string_view name);
/// The names of all, for options.
std::vector<std::string> encoding_names();

/// The text of a file that another program wrote.
struct ForeignText {
  std::string text;  ///< UTF-8 without a byte order mark; lines end in LF or CRLF
  TextEncoding encoding = TextEncoding::utf8;
  std::string reason;   ///< how the encoding is known: "byte order mark"
  bool given = false;   ///< the encoding was given by the caller
  bool packed = false;  ///< the file was compressed by gzip
};

struct ForeignTextOptions {
  std::optional<TextEncoding> encoding;                 ///< absent: found from the bytes
  std::size_t largest_unpacked = std::size_t{1} << 30;  ///< bytes; a few kilobytes of gzip can unpack to terabytes
};

/// Whether bytes are UTF-8, with a byte order mark or without one.
bool is_in_utf8(std::string_view bytes);

/// Finds the encoding from a byte order mark, from the zero bytes of UTF-16, or from whether the bytes are UTF-8; what
/// is none of these is Windows-1252. Unpacks gzip first, whatever the name of the file.
/// @param file  name for messages
/// @throws InputError for bytes that the encoding does not have, text with zero bytes, damaged gzip, and gzip that
///   unpacks to more than the limit
ForeignText decode_foreign_text(std::string_view bytes, const std::string& file,
                                const ForeignTextOptions& options = {});
/// The same for a file. @throws InputError also if it cannot be read or is empty
ForeignText read_foreign_text(const std::filesystem::path& path, const ForeignTextOptions& options = {});

}  // namespace abbe
