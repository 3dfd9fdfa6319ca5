#include "abbe/formats/import/foreign_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <utility>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/import/gzip.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/text_blocks.h"
#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::array<std::pair<TextEncoding, std::string_view>, 4> kEncodings = {
    {{TextEncoding::utf8, "utf-8"},
     {TextEncoding::utf16_le, "utf-16le"},
     {TextEncoding::utf16_be, "utf-16be"},
     {TextEncoding::windows_1252, "windows-1252"}}};
constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF", kUtf16LeMark = "\xFF\xFE", kUtf16BeMark = "\xFE\xFF";
/// Characters of the bytes 0x80 to 0x9F, as the WHATWG Encoding Standard has them; 0: none.
constexpr std::array<std::uint16_t, 32> kWindows1252 = {0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021,
                                                        0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0,      0x017D, 0,
                                                        0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                                        0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};
/// So many bytes tell whether a text without a byte order mark is UTF-16.
constexpr std::size_t kLookedAt = 4096;

unsigned byte_at(std::string_view bytes, std::size_t at) { return static_cast<unsigned char>(bytes[at]); }

void append_utf8(std::uint32_t code, std::string& text) {
  const auto put = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
  if (code < 0x80U) {
    put(code);
  } else if (code < 0x800U) {
    put(0xC0U | code >> 6U);
    put(0x80U | (code & 0x3FU));
  } else if (code < 0x10000U) {
    put(0xE0U | code >> 12U);
    put(0x80U | (code >> 6U & 0x3FU));
    put(0x80U | (code & 0x3FU));
  } else {
    put(0xF0U | code >> 18U);
    put(0x80U | (code >> 12U & 0x3FU));
    put(0x80U | (code >> 6U & 0x3FU));
    put(0x80U | (code & 0x3FU));
  }
}

/// First byte that is not UTF-8, or npos.
std::size_t first_not_utf8(std::string_view bytes) {
  constexpr std::uint64_t kHighBits = 0x8080808080808080U;
  for (std::size_t at = 0; at < bytes.size();) {
    std::uint64_t eight = 0;
    if (at + 8 <= bytes.size()) {
      std::memcpy(&eight, bytes.data() + at, 8);
      if ((eight & kHighBits) == 0) {
        at += 8;
        continue;
      }
    }
    const std::size_t length = utf8_length(bytes, at);
    if (length == 0) return at;
    at += length;
  }
  return std::string_view::npos;
}

std::string from_utf16(std::string_view bytes, bool big_end_first, const std::string& file) {
  std::string text;
  text.reserve(bytes.size() / 2 + bytes.size() / 16);
  const auto unit = [&](std::size_t at) {
    const unsigned first = byte_at(bytes, at), second = byte_at(bytes, at + 1);
    return big_end_first ? first << 8U | second : second << 8U | first;
  };
  const auto refuse = [&](const char* problem) {
    throw InputError({.file = file, .line = text_line(text, text.size())}, problem, "a whole file of UTF-16");
  };
  for (std::size_t at = 0; at < bytes.size(); at += 2) {
    if (at + 1 == bytes.size()) refuse("half a character is left at the end");
    const std::uint32_t code = unit(at);
    if (code < 0xD800U || code > 0xDFFFU) {
      append_utf8(code, text);
      continue;
    }
    const std::uint32_t next = at + 3 < bytes.size() ? unit(at + 2) : 0;
    if (code > 0xDBFFU || next < 0xDC00U || next > 0xDFFFU) refuse("half of a pair of UTF-16 stands alone");
    append_utf8(0x10000U + ((code - 0xD800U) << 10U) + (next - 0xDC00U), text);
    at += 2;
  }
  return text;
}

std::string from_windows_1252(std::string_view bytes, const std::string& file) {
  std::string text;
  text.reserve(bytes.size() + bytes.size() / 32);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    const unsigned byte = byte_at(bytes, at);
    const unsigned code = byte >= 0x80U && byte < 0xA0U ? kWindows1252[byte - 0x80U] : byte;
    if (code == 0 && byte != 0) {
      throw InputError({.file = file, .line = text_line(bytes, at)},
                       fmt::format("byte 0x{:02X} is neither UTF-8 nor Windows-1252", byte),
                       "text in UTF-8, UTF-16, Latin-1 or Windows-1252");
    }
    append_utf8(code, text);
  }
  return text;
}

struct FoundEncoding {
  TextEncoding encoding;
  std::size_t mark;  ///< bytes of the byte order mark
  std::string reason;
};

/// UTF-16 without a byte order mark: in Latin text every other byte is zero.
std::optional<FoundEncoding> utf16_by_zeros(std::string_view bytes) {
  const std::string_view seen = bytes.substr(0, std::min(bytes.size(), kLookedAt));
  std::array<std::size_t, 2> zeros = {0, 0};
  for (std::size_t at = 0; at < seen.size(); ++at) zeros[at % 2] += seen[at] == '\0' ? 1U : 0U;
  const std::size_t pairs = seen.size() / 2;
  const auto most = [&](std::size_t zero) { return 5 * zero > 2 * pairs; };
  const auto few = [&](std::size_t zero) { return 20 * zero <= pairs; };
  if (most(zeros[1]) && few(zeros[0])) return FoundEncoding{TextEncoding::utf16_le, 0, "every second byte is zero"};
  if (most(zeros[0]) && few(zeros[1])) return FoundEncoding{TextEncoding::utf16_be, 0, "every other byte is zero"};
  return std::nullopt;
}

FoundEncoding find_encoding(std::string_view bytes, const std::string& file) {
  if (bytes.starts_with(kUtf8Mark)) return {TextEncoding::utf8, kUtf8Mark.size(), "byte order mark"};
  if (bytes.starts_with("\xFF\xFE\0\0"sv) || bytes.starts_with("\0\0\xFE\xFF"sv)) {
    throw InputError({.file = file}, "is UTF-32", "text in UTF-8, UTF-16, Latin-1 or Windows-1252");
  }
  if (bytes.starts_with(kUtf16LeMark)) return {TextEncoding::utf16_le, kUtf16LeMark.size(), "byte order mark"};
  if (bytes.starts_with(kUtf16BeMark)) return {TextEncoding::utf16_be, kUtf16BeMark.size(), "byte order mark"};
  if (std::optional<FoundEncoding> found = utf16_by_zeros(bytes)) return *found;
  const std::size_t wrong = first_not_utf8(bytes);
  if (wrong == std::string_view::npos) return {TextEncoding::utf8, 0, "all bytes are UTF-8"};
  return {TextEncoding::windows_1252, 0,
          fmt::format("byte 0x{:02X} in line {} is not UTF-8", byte_at(bytes, wrong), text_line(bytes, wrong))};
}

FoundEncoding given_encoding(std::string_view bytes, TextEncoding encoding) {
  const std::string_view mark = encoding == TextEncoding::utf8       ? kUtf8Mark
                                : encoding == TextEncoding::utf16_le ? kUtf16LeMark
                                : encoding == TextEncoding::utf16_be ? kUtf16BeMark
                                                                     : std::string_view();
  return {encoding, bytes.starts_with(mark) ? mark.size() : 0, "as given"};
}

void check_utf8(std::string_view bytes, const std::string& file) {
  const std::size_t wrong = first_not_utf8(bytes);
  if (wrong == std::string_view::npos) return;
  throw InputError({.file = file, .line = text_line(bytes, wrong)},
                   fmt::format("byte 0x{:02X} is not UTF-8", byte_at(bytes, wrong)), "text in UTF-8");
}

std::string decoded(std::string_view bytes, TextEncoding encoding, const std::string& file) {
  switch (encoding) {
    case TextEncoding::utf16_le:
      return from_utf16(bytes, false, file);
    case TextEncoding::utf16_be:
      return from_utf16(bytes, true, file);
    case TextEncoding::windows_1252:
      return from_windows_1252(bytes, file);
    case TextEncoding::utf8:
      break;
  }
  check_utf8(bytes, file);
  return std::string(bytes);
}

}  // namespace

std::string_view encoding_name(TextEncoding encoding) {
  return std::find_if(kEncodings.begin(), kEncodings.end(), [&](const auto& e) { return e.first == encoding; })->second;
}

std::optional<TextEncoding> encoding_named(std::string_view name) {
  for (const auto& [encoding, known] : kEncodings) {
    if (name == known) return encoding;
  }
  return std::nullopt;
}

std::vector<std::string> encoding_names() {
  std::vector<std::string> names;
  for (const auto& [encoding, name] : kEncodings) names.emplace_back(name);
  return names;
}

bool is_in_utf8(std::string_view bytes) {
  return !bytes.starts_with(kUtf16LeMark) && !bytes.starts_with(kUtf16BeMark) && !utf16_by_zeros(bytes) &&
         first_not_utf8(bytes) == std::string_view::npos;
}

ForeignText decode_foreign_text(std::string_view bytes, const std::string& file, const ForeignTextOptions& options) {
  ForeignText result;
  std::string unpacked;
  if (is_gzip(bytes)) {
    result.packed = true;
    unpacked = unpacked_gzip(bytes, file, options.largest_unpacked);
    bytes = unpacked;
  }
  const FoundEncoding found = options.encoding ? given_encoding(bytes, *options.encoding) : find_encoding(bytes, file);
  result.encoding = found.encoding;
  result.given = options.encoding.has_value();
  result.reason = found.reason;
  if (result.packed && found.encoding == TextEncoding::utf8) {
    check_utf8(bytes, file);
    unpacked.erase(0, found.mark);
    result.text = std::move(unpacked);
  } else {
    result.text = decoded(bytes.substr(found.mark), found.encoding, file);
  }
  if (result.text.find_first_not_of(" \t\r\n") == std::string::npos) {
    throw InputError({.file = file}, "the file is empty", "a table of readings");
  }
  const std::size_t zero = result.text.find('\0');
  if (zero != std::string::npos) {
    throw InputError({.file = file, .line = text_line(result.text, zero)}, "a zero byte: this is not text",
                     "a table of readings as text");
  }
  // Lines of old Macintosh programs end in CR alone.
  if (result.text.find('\n') == std::string::npos) std::replace(result.text.begin(), result.text.end(), '\r', '\n');
  return result;
}

ForeignText read_foreign_text(const std::filesystem::path& path, const ForeignTextOptions& options) {
  const MappedFile file(path);
  return decode_foreign_text(file.text(), path.string(), options);
}

}  // namespace abbe
