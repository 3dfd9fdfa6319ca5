#pragma once

// Internal to formats: one block of an NC program.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/nc/nc_cursor.h"
#include "abbe/formats/nc/nc_expression.h"

namespace abbe {

/// "X12.5": a letter and its value.
struct NcWord {
  char letter = 0;  ///< in lower case
  double value = 0;
  const char* begin = nullptr;
  const char* end = nullptr;
};

/// "#5 = 3" or "#<name> = 3", which holds from the next block on.
struct NcAssignment {
  int number = 0;    ///< 0: named
  std::string name;  ///< without < >
  double value = 0;
};

/// What an O word says.
enum class NcFlowWord : std::uint8_t {
  none,
  label,  ///< "O100" alone: where M98 P100 goes
  sub,
  endsub,
  call,
  return_to_caller,
  while_loop,
  endwhile,
  do_loop,
  if_block,
  elseif,
  else_block,
  endif,
  repeat,
  endrepeat,
  break_loop,
  continue_loop,
};

/// The words of one line; what it points to is the line itself.
struct NcBlock {
  static constexpr std::size_t kMostWords = 64;
  static constexpr std::uint8_t kNoWord = 255;

  NcCursor cursor;           ///< behind the words; with an O word behind that
  bool is_deleted = false;   ///< begins with a slash
  bool is_percent = false;   ///< the line is a % sign
  bool is_computed = false;  ///< some value is not a plain number, or a parameter is set
  std::string_view number;   ///< "N100" as written; may be empty
  std::size_t word_count = 0;
  std::array<NcWord, kMostWords> words;
  std::array<std::uint8_t, 26> index{};  ///< word of a letter, or kNoWord; the first one of G and M
  std::vector<std::string_view> comments;
  std::vector<NcAssignment> assignments;
  NcFlowWord flow = NcFlowWord::none;
  std::string label;             ///< of the O word
  const char* o_word = nullptr;  ///< where it stands

  bool has(char letter) const { return index[static_cast<std::size_t>(letter - 'a')] != kNoWord; }
  const NcWord& word(char letter) const { return words[index[static_cast<std::size_t>(letter - 'a')]]; }
  double value(char letter) const { return word(letter).value; }
  std::string_view line() const { return {cursor.begin, static_cast<std::size_t>(cursor.end - cursor.begin)}; }
  bool is_empty() const { return word_count == 0 && comments.empty() && assignments.empty(); }

  /// @throws InputError that names the word
  [[noreturn]] void fail(const NcWord& word, const std::string& problem, const std::string& expected = "") const;
  [[noreturn]] void fail(char letter, const std::string& problem, const std::string& expected = "") const {
    fail(word(letter), problem, expected);
  }
  /// Names what the block begins with.
  [[noreturn]] void fail_at_begin(const std::string& problem, const std::string& expected = "") const;
};

/// Reads lines of a program into blocks. Values are computed with the parameters as they are before the block.
class NcBlockReader {
 public:
  NcBlockReader(const std::string& file, NcExpression& expression) : file_(file), expression_(expression) {}

  /// @param line  without its end
  /// @throws InputError for what is no block: an unknown character, a word given twice, a comment without end, ...
  void read(std::string_view line, std::size_t number, NcBlock& block);

  /// Reads what stands before the O word of a line, if it has one: for finding subroutines without running the program.
  /// @returns whether the line has an O word
  bool read_flow(std::string_view line, std::size_t number, NcBlock& block) const;

 private:
  /// @throws InputError where more letters follow each other than a word and a function have
  static void refuse_statement(NcCursor& cursor);
  void read_word(NcBlock& block, char letter);
  void read_assignment(NcBlock& block);
  static void begin(NcBlock& block);
  static void read_line_number(NcBlock& block);
  static void read_flow_word(NcBlock& block);

  const std::string& file_;
  NcExpression& expression_;
};

}  // namespace abbe
