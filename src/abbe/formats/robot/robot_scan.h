#pragma once

// Internal to formats: words, numbers and brackets of a robot program, with their places in the file.
#include <cstddef>
#include <string>
#include <string_view>

#include "abbe/formats/robot/robot_program.h"

namespace abbe {

/// Letters without regard to their case.
bool same_robot_word(std::string_view a, std::string_view b);

class RobotScan {
 public:
  /// @param comment  character that begins a comment up to the end of its line, or 0: there are none. Comments and
  ///                 texts in double quotes are blanks for the scan.
  RobotScan(std::string_view text, const std::string& file, char comment);

  std::size_t at = 0;
  /// Blanks count as text: to be asked after peek() where only they may be left.
  bool at_end() const { return at >= code_.size(); }
  /// The next character that is not blank, which the scan then stands at; 0 at the end.
  char peek();
  /// Goes behind the next character that is not blank, if it is this one.
  bool take(char c);
  /// @throws InputError  another character is next
  void expect(char c, const std::string& field, const std::string& expected);
  /// The word (letters, digits, _ and $) that begins here after blanks; empty if none does.
  std::string_view word();
  /// The next word of the text, over everything else; empty at the end.
  std::string_view next_word();
  bool is_number();
  /// @throws InputError  no number is next, or one that is not finite or above kLargestInput
  RobotNumber number(const std::string& field, const std::string& expected);
  std::size_t line_of(std::size_t place) const;
  std::string_view code() const { return code_; }
  [[noreturn]] void fail(std::size_t place, const std::string& field, const std::string& problem,
                         const std::string& expected) const;

 private:
  std::size_t number_end(std::size_t begin) const;

  std::string code_;
  std::string file_;
  mutable std::size_t counted_to_ = 0, counted_lines_ = 1;  ///< lines up to a place
};

/// Sorted by line: positions that are not corrected. The readers of the languages add to `program`.
void read_rapid(RobotProgram& program);
void read_krl(RobotProgram& program);
void read_fanuc_ls(RobotProgram& program);
void read_urscript(RobotProgram& program);

}  // namespace abbe
