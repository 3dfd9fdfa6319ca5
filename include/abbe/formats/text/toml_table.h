#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/unit.h"

namespace abbe {

/// Strict view of one table of a TOML file. Every key that is asked for is remembered; finish() refuses all others.
///
/// A number with a unit is asked for by its base name and quantity: length "travel" accepts travel_mm, travel_um and
/// travel_m, and answers in mm. All readers throw InputError with file, line, column and the full key. UTF-8 byte order
/// mark and CRLF are accepted; nan, inf and magnitudes over kLargestInput are not.
class TomlTable {
 public:
  /// Parses a whole file given as text. @param file  name for messages
  static TomlTable parse(std::string text, const std::string& file);

  const std::string& file() const;
  /// Full name of a key of this table: "axis.X.travel_mm".
  std::string full_name(std::string_view key) const;

  bool has(std::string_view key) const;
  /// True if the base stands here with any suffix of the quantity.
  bool has(std::string_view base, Quantity quantity) const;
  bool is_text(std::string_view key) const;
  /// Keys in the order of the file.
  std::vector<std::string> keys() const;

  /// On one line: without control characters.
  std::string text(std::string_view key);
  /// Of any number of lines.
  std::string free_text(std::string_view key);
  std::string text_or(std::string_view key, std::string otherwise);
  /// A name that files are called by, as those of set-ups are. @throws InputError for one that would lead to another
  /// folder, hide the file or not be shown: with "/", control characters, a dot in front, or of more than 100 bytes
  std::string file_name(std::string_view key);
  /// Name of a file, resolved against a folder. @throws InputError  none of that name is there
  std::filesystem::path file(std::string_view key, const std::filesystem::path& folder, const std::string& expected);
  bool boolean_or(std::string_view key, bool otherwise);
  std::int64_t integer(std::string_view key, std::int64_t smallest, std::int64_t largest);
  std::int64_t integer_or(std::string_view key, std::int64_t otherwise, std::int64_t smallest, std::int64_t largest);
  std::vector<std::int64_t> integers(std::string_view key, std::int64_t smallest, std::int64_t largest);
  /// A text or an array of texts.
  std::vector<std::string> texts(std::string_view key);
  std::vector<std::string> texts_or_none(std::string_view key);

  /// A number in the inside unit of its quantity.
  double number(std::string_view base, Quantity quantity);
  double number_or(std::string_view base, Quantity quantity, double otherwise);
  std::optional<double> optional_number(std::string_view base, Quantity quantity);
  /// As number_or, and not below zero.
  double size_or(std::string_view base, Quantity quantity, double otherwise);
  /// An array of numbers. @param count  length expected, or npos for any
  std::vector<double> numbers(std::string_view base, Quantity quantity, std::size_t count = npos);
  std::optional<std::vector<double>> optional_numbers(std::string_view base, Quantity quantity,
                                                      std::size_t count = npos);
  static constexpr std::size_t npos = static_cast<std::size_t>(-1);

  /// One of several words. @returns its index
  std::size_t word(std::string_view key, std::initializer_list<std::string_view> words);
  std::size_t word(std::string_view key, const std::vector<std::string_view>& words);
  std::size_t word_or(std::string_view key, std::size_t otherwise, std::initializer_list<std::string_view> words);

  TomlTable table(std::string_view key);
  std::optional<TomlTable> optional_table(std::string_view key);
  /// Array of tables [[key]]; empty if absent.
  std::vector<TomlTable> tables(std::string_view key);

  /// Refuses keys that nobody asked for, with the nearest spelling or the accepted units.
  void finish();

  /// Where a key stands, for messages about it that come later.
  InputError::Place place(std::string_view key) const;
  /// Throws InputError at a key (any key of this table, or empty for the table itself).
  [[noreturn]] void fail(std::string_view key, const std::string& problem, const std::string& expected = "") const;
  /// As fail, for a quantity: finds the key as it was written with its unit.
  [[noreturn]] void fail_quantity(std::string_view base, Quantity quantity, const std::string& problem,
                                  const std::string& expected = "") const;

 private:
  struct State;
  explicit TomlTable(std::shared_ptr<State> state) : state_(std::move(state)) {}
  std::shared_ptr<State> state_;
};

/// Text in quotes with the escapes of TOML.
std::string toml_string(std::string_view text);

/// "key = [...]" with one text a line; nothing if there are none.
std::string toml_texts(std::string_view key, const std::vector<std::string>& texts);

/// "key_deg = [...]" if degrees read back to the same bits, else in rad. One value: without brackets if `scalar`.
std::string toml_angles(std::string_view base, const std::vector<double>& values, bool scalar = false);

}  // namespace abbe
