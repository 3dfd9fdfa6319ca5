#include "abbe/formats/nc/nc_expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/decimal_text.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr int kDeepest = 50;
constexpr double kLargestValue = 1e15;
/// Numbers that differ by less are equal to EQ and NE.
constexpr double kEqual = 1e-4;

enum class Operation {
  none,
  power,
  times,
  divide,
  modulo,
  plus,
  minus,
  eq,
  ne,
  gt,
  ge,
  lt,
  le,
  logical_and,
  logical_or,
  logical_xor
};

int precedence_of(Operation operation) {
  switch (operation) {
    case Operation::power:
      return 5;
    case Operation::times:
    case Operation::divide:
    case Operation::modulo:
      return 4;
    case Operation::plus:
    case Operation::minus:
      return 3;
    case Operation::logical_and:
    case Operation::logical_or:
    case Operation::logical_xor:
      return 1;
    case Operation::none:
      return 0;
    default:
      return 2;
  }
}

struct NamedOperation {
  std::string_view name;
  Operation operation;
};
constexpr std::array<NamedOperation, 15> kOperations = {{{"**", Operation::power},
                                                         {"*", Operation::times},
                                                         {"/", Operation::divide},
                                                         {"mod", Operation::modulo},
                                                         {"+", Operation::plus},
                                                         {"-", Operation::minus},
                                                         {"eq", Operation::eq},
                                                         {"ne", Operation::ne},
                                                         {"gt", Operation::gt},
                                                         {"ge", Operation::ge},
                                                         {"lt", Operation::lt},
                                                         {"le", Operation::le},
                                                         {"and", Operation::logical_and},
                                                         {"or", Operation::logical_or},
                                                         {"xor", Operation::logical_xor}}};

/// The operation at the cursor and its length; the cursor stays.
Operation next_operation(NcCursor& cursor, std::ptrdiff_t& length) {
  cursor.skip_blanks();
  for (const NamedOperation& candidate : kOperations) {
    length = static_cast<std::ptrdiff_t>(candidate.name.size());
    if (cursor.end - cursor.at < length) continue;
    bool same = true;
    for (std::ptrdiff_t i = 0; i < length; ++i) {
      same = same && lower_case(cursor.at[i]) == candidate.name[static_cast<std::size_t>(i)];
    }
    if (same) return candidate.operation;
  }
  return Operation::none;
}

double apply(const NcCursor& cursor, const char* begin, Operation operation, double left, double right) {
  switch (operation) {
    case Operation::power:
      if (left < 0 && right != std::floor(right)) {
        cursor.fail(begin, "a negative number to a power that is not whole");
      }
      return std::pow(left, right);
    case Operation::times:
      return left * right;
    case Operation::divide:
      if (right == 0) cursor.fail(begin, "division by zero");
      return left / right;
    case Operation::modulo: {
      if (right == 0) cursor.fail(begin, "division by zero");
      const double rest = std::fmod(left, right);
      return rest < 0 ? rest + std::abs(right) : rest;
    }
    case Operation::plus:
      return left + right;
    case Operation::minus:
      return left - right;
    case Operation::eq:
      return std::abs(left - right) < kEqual ? 1 : 0;
    case Operation::ne:
      return std::abs(left - right) < kEqual ? 0 : 1;
    case Operation::gt:
      return left > right ? 1 : 0;
    case Operation::ge:
      return left >= right ? 1 : 0;
    case Operation::lt:
      return left < right ? 1 : 0;
    case Operation::le:
      return left <= right ? 1 : 0;
    case Operation::logical_and:
      return left != 0 && right != 0 ? 1 : 0;
    case Operation::logical_or:
      return left != 0 || right != 0 ? 1 : 0;
    case Operation::logical_xor:
      return (left != 0) != (right != 0) ? 1 : 0;
    case Operation::none:
      break;
  }
  return left;
}

/// The long way: blanks between digits, or more digits than the short way takes.
double read_number_slowly(NcCursor& cursor) {
  const char* const begin = cursor.at;
  std::string text;
  bool digits = false, point = false;
  for (;;) {
    cursor.skip_blanks();
    if (cursor.at == cursor.end) break;
    const char c = *cursor.at;
    if (is_digit(c)) {
      digits = true;
    } else if (c == '.' && !point) {
      point = true;
    } else if (!((c == '-' || c == '+') && text.empty())) {
      break;
    }
    text += c;
    ++cursor.at;
  }
  double value = 0;
  if (!digits || parse_number(text, 0, value) != NumberProblem::none) {
    cursor.fail(begin, "is not a number", "a number, a parameter (#5, #<name>), an expression in [ ] or a function");
  }
  return value;
}

}  // namespace

double NcExpression::read_number(NcCursor& cursor) {
  cursor.skip_blanks();
  const char* at = cursor.at;
  const char* const end = cursor.end;
  const bool negative = at != end && *at == '-';
  if (at != end && (*at == '-' || *at == '+')) ++at;
  std::uint64_t digits = 0;
  const char* const start = at;
  for (; at != end && is_digit(*at); ++at) digits = digits * 10 + static_cast<std::uint64_t>(*at - '0');
  std::ptrdiff_t count = at - start;
  std::size_t fraction = 0;
  if (at != end && *at == '.') {
    const char* const first = ++at;
    for (; at != end && is_digit(*at); ++at) digits = digits * 10 + static_cast<std::uint64_t>(*at - '0');
    fraction = static_cast<std::size_t>(at - first);
    count += at - first;
  }
  // At most 15 digits: digits and power of ten are exact, so that the quotient is the nearest double.
  if (count == 0 || count > 15) return read_number_slowly(cursor);
  if (at != end && (*at == ' ' || *at == '\t')) {
    const char* next = at;
    while (next != end && (*next == ' ' || *next == '\t')) ++next;
    if (next != end && (is_digit(*next) || *next == '.')) return read_number_slowly(cursor);
  }
  cursor.at = at;
  double value = static_cast<double>(digits);
  if (fraction > 0) value /= kExactPowersOfTen[fraction];
  return negative ? -value : value;
}

double NcExpression::checked(const NcCursor& cursor, const char* begin, double value) const {
  if (!(std::abs(value) <= kLargestValue)) cursor.fail(begin, "has no finite value, or one beyond 1e15");
  return value;
}

double NcExpression::read_value(NcCursor& cursor) {
  const char c = cursor.peek();
  if (is_digit(c) || c == '.') return read_number(cursor);
  if (c == '-' || c == '+') {
    const char* next = cursor.at + 1;
    while (next != cursor.end && (*next == ' ' || *next == '\t')) ++next;
    if (next != cursor.end && (is_digit(*next) || *next == '.')) return read_number(cursor);
    computed_ = true;
    const char* const begin = cursor.at++;
    if (++depth_ > kDeepest) cursor.fail(begin, "the expression is nested too deeply");
    const double value = read_value(cursor);
    --depth_;
    return c == '-' ? -value : value;
  }
  computed_ = true;
  const char* const begin = cursor.at;
  if (++depth_ > kDeepest) cursor.fail(begin, "the expression is nested too deeply");
  double value = 0;
  if (c == '[') {
    value = read_bracket(cursor);
  } else if (c == '#') {
    value = read_parameter(cursor);
  } else if (c >= 'a' && c <= 'z') {
    value = read_function(cursor);
  } else {
    cursor.fail(begin, c == 0 ? "a value is missing" : "is not a value",
                "a number, a parameter (#5, #<name>), an expression in [ ] or a function");
  }
  --depth_;
  return checked(cursor, begin, value);
}

double NcExpression::read_bracket(NcCursor& cursor) {
  const char* const begin = cursor.at++;
  const double value = read_operation(cursor, 1);
  if (cursor.peek() != ']') cursor.fail(begin, "the expression does not end with ]", "an operator or ]");
  ++cursor.at;
  return value;
}

double NcExpression::read_operation(NcCursor& cursor, int precedence) {
  const char* const begin = cursor.at;
  double left = read_value(cursor);
  for (;;) {
    std::ptrdiff_t length = 0;
    const Operation operation = next_operation(cursor, length);
    const int own = precedence_of(operation);
    if (operation == Operation::none || own < precedence) return left;
    cursor.at += length;
    if (++depth_ > kDeepest) cursor.fail(begin, "the expression is nested too deeply");
    const double right = read_operation(cursor, own + 1);
    --depth_;
    left = checked(cursor, begin, apply(cursor, begin, operation, left, right));
  }
}

std::string NcExpression::read_name(NcCursor& cursor) {
  const char* const begin = cursor.at++;
  std::string name;
  while (cursor.at != cursor.end && *cursor.at != '>') {
    const char c = *cursor.at++;
    if (c == '<' || c == '(') cursor.fail(begin, "the name does not end with >");
    if (c != ' ' && c != '\t') name += lower_case(c);
  }
  if (cursor.at == cursor.end) cursor.fail(begin, "the name does not end with >");
  ++cursor.at;
  if (name.empty()) cursor.fail(begin, "the name is empty");
  return name;
}

int NcExpression::read_parameter_number(NcCursor& cursor) {
  const char* const begin = cursor.at;
  const double number = read_value(cursor);
  if (std::abs(number - std::round(number)) > 1e-4) {
    cursor.fail(begin, "the number of a parameter is not whole");
  }
  if (!(number > 0.5 && number < kNcParameters - 0.5)) {
    cursor.fail(begin, "there is no parameter of this number", "1 to 5601");
  }
  return static_cast<int>(std::lround(number));
}

double NcExpression::read_parameter(NcCursor& cursor) {
  const char* const begin = cursor.at++;
  double value = 0;
  if (cursor.peek() == '<') {
    const std::string name = read_name(cursor);
    if (!parameters_.get(name, value)) {
      cursor.fail(begin, "this parameter has no value here",
                  "a parameter that the program has set, or one of the position, units or feed (#<_x>, #<_feed>)");
    }
    return value;
  }
  const int number = read_parameter_number(cursor);
  if (NcParameters::is_of_control(number)) {
    cursor.fail(begin, "only the control knows this parameter (probing, inputs)",
                "a program whose moves do not depend on what the control measures");
  }
  if (!parameters_.get(number, value)) {
    cursor.fail(begin, "this parameter has no value here",
                "a parameter that the program or the parameter file has set");
  }
  return value;
}

bool NcExpression::is_function(std::string_view name) {
  constexpr std::array<std::string_view, 14> kFunctions = {"abs", "acos", "asin", "atan",  "cos", "exists", "exp",
                                                           "fix", "fup",  "ln",   "round", "sin", "sqrt",   "tan"};
  return std::find(kFunctions.begin(), kFunctions.end(), name) != kFunctions.end();
}

double NcExpression::read_function(NcCursor& cursor) {
  const char* const begin = cursor.at;
  std::string name;
  while (cursor.at != cursor.end && lower_case(*cursor.at) >= 'a' && lower_case(*cursor.at) <= 'z')
    name += lower_case(*cursor.at++);
  if (cursor.peek() != '[') {
    cursor.fail(begin, "is not a value", "a number, a parameter (#5, #<name>), an expression in [ ] or a function");
  }
  if (name == "exists") {
    ++cursor.at;
    if (cursor.peek() != '#') cursor.fail(begin, "EXISTS takes a parameter", "EXISTS[#<name>]");
    ++cursor.at;
    double ignored = 0;
    const bool exists =
        cursor.peek() == '<' ? parameters_.get(read_name(cursor), ignored) : read_parameter_number(cursor) > 0;
    if (cursor.peek() != ']') cursor.fail(begin, "EXISTS does not end with ]");
    ++cursor.at;
    return exists ? 1 : 0;
  }
  const double x = read_bracket(cursor);
  if (name == "abs") return std::abs(x);
  if (name == "sin") return std::sin(x * kDegree);
  if (name == "cos") return std::cos(x * kDegree);
  if (name == "tan") return std::tan(x * kDegree);
  if (name == "exp") return std::exp(x);
  if (name == "fix") return std::floor(x);
  if (name == "fup") return std::ceil(x);
  if (name == "round") return std::round(x);
  if (name == "atan") {
    if (cursor.peek() != '/') cursor.fail(begin, "ATAN takes two values", "ATAN[y]/[x]");
    ++cursor.at;
    if (cursor.peek() != '[') cursor.fail(begin, "ATAN takes two values", "ATAN[y]/[x]");
    return std::atan2(x, read_bracket(cursor)) / kDegree;
  }
  if (name == "acos" || name == "asin") {
    if (!(std::abs(x) <= 1)) cursor.fail(begin, fmt::format("the argument {} is outside -1 to 1", x));
    return (name == "acos" ? std::acos(x) : std::asin(x)) / kDegree;
  }
  if (name == "ln") {
    if (!(x > 0)) cursor.fail(begin, fmt::format("the argument {} is not positive", x));
    return std::log(x);
  }
  if (name == "sqrt") {
    if (!(x >= 0)) cursor.fail(begin, fmt::format("the argument {} is negative", x));
    return std::sqrt(x);
  }
  cursor.fail(begin, "there is no such function", "ABS ACOS ASIN ATAN COS EXISTS EXP FIX FUP LN ROUND SIN SQRT TAN");
}

}  // namespace abbe
