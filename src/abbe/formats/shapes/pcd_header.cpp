#include "abbe/formats/shapes/pcd_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/text_blocks.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

constexpr std::array<std::string_view, 11> kPcdEntries = {"VERSION", "FIELDS", "COLUMNS", "SIZE", "TYPE",     "COUNT",
                                                          "WIDTH",   "HEIGHT", "POINTS",  "DATA", "VIEWPOINT"};
// More than any program writes; keep sizes far from overflow and the time for a damaged header small.
constexpr std::size_t kMostPcdFields = 1000;
constexpr std::uint64_t kMostPcdValues = 1000000;
constexpr std::uint64_t kMostPcdPoints = 1000000000000000;

/// First word of a line; removed from it.
std::string_view take_pcd_word(std::string_view& line) {
  while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  std::size_t length = 0;
  while (length < line.size() && !is_blank(line[length])) ++length;
  const std::string_view word = line.substr(0, length);
  line.remove_prefix(length);
  return word;
}

class PcdHeaderReader {
 public:
  PcdHeaderReader(std::string_view contents, const std::string& file)
      : contents_(contents), file_(file), lines_(contents, file) {}

  PcdHeader read() {
    while (true) {
      if (lines_.at_end()) lines_.fail("", "the header does not end", "a line 'DATA ascii' or 'DATA binary'");
      offset_ = lines_.position();
      line_ = lines_.line();
      const std::string_view entry = take_pcd_word(line_);
      if (entry.empty() || entry.front() == '#') continue;
      if (std::find(kPcdEntries.begin(), kPcdEntries.end(), entry) == kPcdEntries.end()) {
        lines_.fail("", fmt::format("'{}' in the header", shown_word(entry)),
                    "VERSION, FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, POINTS or DATA");
      }
      read_entry(entry == "COLUMNS" ? "FIELDS" : entry);
      if (entry == "DATA") break;
    }
    finish();
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(std::string_view field, const std::string& problem, const std::string& expected) const {
    lines_.fail(std::string(field), problem, expected);
  }

  void read_entry(std::string_view entry) {
    if (std::find(seen_.begin(), seen_.end(), entry) != seen_.end()) fail(entry, "is given twice", "");
    seen_.push_back(entry);
    if (entry == "VERSION") {
      read_version();
    } else if (entry == "FIELDS") {
      read_fields();
    } else if (entry == "SIZE") {
      for_fields(entry, [&](PcdField& field, std::string_view word) {
        field.size = static_cast<std::size_t>(whole(entry, word, 8));
        if (field.size != 1 && field.size != 2 && field.size != 4 && field.size != 8) {
          fail(entry, fmt::format("'{}'", shown_word(word)), "1, 2, 4 or 8 bytes");
        }
      });
    } else if (entry == "TYPE") {
      for_fields(entry, [&](PcdField& field, std::string_view word) {
        if (word != "F" && word != "I" && word != "U") {
          fail(entry, fmt::format("'{}'", shown_word(word)), "F, I or U");
        }
        field.type = word.front();
      });
    } else if (entry == "COUNT") {
      for_fields(entry, [&](PcdField& field, std::string_view word) {
        field.count = static_cast<std::size_t>(whole(entry, word, kMostPcdValues));
        if (field.count == 0) fail(entry, "0 values", "at least 1");
      });
    } else if (entry == "DATA") {
      read_form();
    } else if (entry == "VIEWPOINT") {
      // PCL does not apply it to the points, so neither is it applied here.
      line_ = {};
    } else {
      std::optional<std::uint64_t>& number = entry == "WIDTH" ? width_ : entry == "HEIGHT" ? height_ : points_;
      number = whole(entry, take_pcd_word(line_), kMostPcdPoints);
      if (entry != "HEIGHT") header_.line = text_line(contents_, offset_);
    }
    if (const std::string_view more = take_pcd_word(line_); !more.empty()) {
      fail(entry, fmt::format("'{}' at the end of the line", shown_word(more)), "");
    }
  }

  std::uint64_t whole(std::string_view entry, std::string_view word, std::uint64_t most) const {
    std::uint64_t value = 0;
    const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || read.ec != std::errc() || read.ptr != word.data() + word.size() || value > most) {
      fail(entry, fmt::format("'{}'", shown_word(word)), fmt::format("a whole number of at most {}", most));
    }
    return value;
  }

  void read_version() {
    std::string_view version = take_pcd_word(line_);
    if (version.starts_with('0')) version.remove_prefix(1);
    if (version != ".5" && version != ".6" && version != ".7") {
      fail("VERSION", fmt::format("'{}'", shown_word(version)), ".5, .6 or .7");
    }
  }

  void read_fields() {
    while (true) {
      const std::string_view name = take_pcd_word(line_);
      if (name.empty()) break;
      if (header_.fields.size() == kMostPcdFields)
        fail("FIELDS", "too many", fmt::format("at most {}", kMostPcdFields));
      header_.fields.push_back({.name = std::string(name)});
    }
    if (header_.fields.empty()) fail("FIELDS", "there are none", "x y z");
  }

  template <typename Set>
  void for_fields(std::string_view entry, const Set& set) {
    if (header_.fields.empty()) fail(entry, "stands before FIELDS", "");
    for (PcdField& field : header_.fields) {
      const std::string_view word = take_pcd_word(line_);
      if (word.empty()) {
        fail(entry, "the line ends", fmt::format("{} values, one for each field", header_.fields.size()));
      }
      set(field, word);
    }
  }

  void read_form() {
    const std::string_view form = take_pcd_word(line_);
    if (form == "ascii") {
      header_.form = PcdForm::ascii;
    } else if (form == "binary") {
      header_.form = PcdForm::binary;
    } else if (form == "binary_compressed") {
      header_.form = PcdForm::binary_compressed;
    } else {
      fail("DATA", fmt::format("'{}'", shown_word(form)), "ascii, binary or binary_compressed");
    }
    // In a file that is cut off here, what follows is not missing from the line but from the file.
    if (lines_.at_end()) fail("DATA", "the file ends", "points");
  }

  void finish() {
    if (header_.fields.empty()) fail("FIELDS", "missing in the header", "a line 'FIELDS x y z'");
    if (!points_ && !width_) fail("POINTS", "missing in the header", "a line 'POINTS NUMBER'");
    const std::uint64_t height = height_.value_or(1);
    header_.points = points_ ? *points_ : *width_;
    if (width_ &&
        (height == 0 ? header_.points != 0 : header_.points % height != 0 || header_.points / height != *width_)) {
      throw InputError({file_, header_.line, 0, "POINTS"},
                       fmt::format("{} points, but {} in each of {} rows", header_.points, *width_, height),
                       "WIDTH times HEIGHT");
    }
    if (header_.points == 0)
      throw InputError({file_, header_.line, 0, "POINTS"}, "there are no points", "at least one");
    for (PcdField& field : header_.fields) {
      if (field.type == 'F' && field.size < 4) {
        fail("SIZE", fmt::format("{} bytes of a floating-point field {}", field.size, shown_word(field.name)),
             "4 or 8");
      }
      field.offset = header_.point_bytes;
      field.words = header_.point_words;
      header_.point_bytes += field.size * field.count;
      header_.point_words += field.count;
    }
    header_.data = lines_.position();
  }

  std::string_view contents_;
  const std::string& file_;
  TextCursor lines_;
  PcdHeader header_;
  std::vector<std::string_view> seen_;
  std::optional<std::uint64_t> width_, height_, points_;
  std::string_view line_;
  std::size_t offset_ = 0;
};

}  // namespace

bool is_pcd(std::string_view contents) {
  if (contents.starts_with("# .PCD")) return true;
  const std::string name;
  for (TextCursor lines(contents, name); !lines.at_end();) {
    std::string_view line = lines.line();
    const std::string_view word = take_pcd_word(line);
    if (word.empty() || word.front() == '#') continue;
    // A machine file may have a key VERSION; what follows it there is "=".
    return (word == "VERSION" && (line.starts_with(" .") || line.starts_with(" 0."))) || word == "FIELDS" ||
           word == "COLUMNS";
  }
  return false;
}

PcdHeader parse_pcd_header(std::string_view contents, const std::string& file) {
  return PcdHeaderReader(contents, file).read();
}

}  // namespace abbe
