#pragma once

// Internal to formats: numbers, parameters and expressions of NC programs.
#include <string>

#include "abbe/formats/nc/nc_cursor.h"
#include "abbe/formats/nc/nc_parameters.h"

namespace abbe {

/// Reads values as RS274/NGC writes them: 1.5, #5, #<name>, [1 + #5], sin[30], with signs before them.
///
/// Operators in the order in which they bind: **; * / MOD; + -; EQ NE GT GE LT LE; AND OR XOR; those that bind alike
/// from left to right. Angles in degrees. EQ and NE take numbers as equal that differ by less than 0.0001, MOD is never
/// negative.
/// Source: LinuxCNC, G-code overview, "Expressions", "Binary operators", "Functions"; NIST RS274/NGC version 3, 3.3.2.
class NcExpression {
 public:
  explicit NcExpression(const NcParameters& parameters) : parameters_(parameters) {}

  /// @throws InputError if there is none, or if it is not finite
  double read_value(NcCursor& cursor);
  /// Whether expressions have a function of this name, in lower case.
  static bool is_function(std::string_view name);

  /// A plain number without sign rules of expressions: "-1.5", "+.5", "12."; blanks between digits are allowed.
  static double read_number(NcCursor& cursor);
  /// Whether what was read since it was last asked was anything but plain numbers.
  bool was_computed() {
    const bool computed = computed_;
    computed_ = false;
    return computed;
  }

  /// What stands between < and >, without blanks, in lower case; `cursor` stands on "<" and then behind ">".
  static std::string read_name(NcCursor& cursor);
  /// Number of a parameter behind "#". @throws InputError
  int read_parameter_number(NcCursor& cursor);

 private:
  double read_parameter(NcCursor& cursor);
  double read_bracket(NcCursor& cursor);
  double read_operation(NcCursor& cursor, int precedence);
  double read_function(NcCursor& cursor);
  double checked(const NcCursor& cursor, const char* begin, double value) const;

  const NcParameters& parameters_;
  int depth_ = 0;
  bool computed_ = false;
};

}  // namespace abbe
