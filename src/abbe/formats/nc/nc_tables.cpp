// Parameter files and tool tables of LinuxCNC.
#include <cmath>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/nc/nc_codes.h"
#include "abbe/formats/nc/nc_cursor.h"
#include "abbe/formats/nc/nc_expression.h"
#include "abbe/formats/nc/nc_program.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

/// Calls `take` with every line that has something in it.
template <typename Take>
void for_lines(std::string_view text, const std::string& file, Take&& take) {
  std::size_t begin = 0, number = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const char* const first = text.data() + begin;
    NcCursor cursor{first, first, text.data() + end, ++number, &file};
    begin = end + 1;
    const char c = cursor.peek();
    if (c != 0 && c != ';') take(cursor);
  }
}

/// A number with or without an exponent, up to a blank. @throws InputError
double table_number(NcCursor& cursor, const char* expected) {
  cursor.skip_blanks();
  const char* const begin = cursor.at;
  while (cursor.at != cursor.end && *cursor.at != ' ' && *cursor.at != '\t' && *cursor.at != '\r' &&
         *cursor.at != ';') {
    ++cursor.at;
  }
  double value = 0;
  std::string_view digits(begin, static_cast<std::size_t>(cursor.at - begin));
  if (parse_number(digits, 0, value) != NumberProblem::none || !(std::abs(value) <= kLargestInput)) {
    cursor.fail(begin, "is not a number that can be used", expected);
  }
  return value;
}

int whole_number(NcCursor& cursor, int largest, const char* expected) {
  cursor.skip_blanks();
  const char* const begin = cursor.at;
  const double value = table_number(cursor, expected);
  if (value != std::round(value) || value < 0 || value > largest) cursor.fail(begin, "is not a whole number", expected);
  return static_cast<int>(value);
}

}  // namespace

std::map<int, double> parse_nc_parameters(std::string_view text, const std::string& file) {
  std::map<int, double> parameters;
  for_lines(text, file, [&](NcCursor& cursor) {
    const char* const begin = cursor.at;
    const int number = whole_number(cursor, kNcParameters - 1, "the number of a parameter, 1 to 5601");
    if (number < 1) cursor.fail(begin, "there is no parameter of this number", "1 to 5601");
    const double value = table_number(cursor, "the value of the parameter");
    const char c = cursor.peek();
    if (c != 0 && c != ';') cursor.fail(cursor.at, "is not expected here", "a number and a value in each line");
    if (!parameters.emplace(number, value).second) cursor.fail(begin, "this parameter has a value already");
  });
  return parameters;
}

NcToolTable parse_nc_tools(std::string_view text, const std::string& file, bool in_inches) {
  NcToolTable tools;
  for_lines(text, file, [&](NcCursor& cursor) {
    int number = -1;
    WordValues offset{};
    const char* const line = cursor.at;
    for (char c = cursor.peek(); c != 0 && c != ';'; c = cursor.peek()) {
      const char* const begin = cursor.at++;
      const std::size_t axis = nc_axis(c);
      if (c == 't') {
        number = whole_number(cursor, 1'000'000'000, "the number of a tool");
      } else if (axis < kAxisWords) {
        const bool is_rotary = axis >= 3 && axis <= 5;
        const double value = table_number(cursor, "an offset in mm or degrees");
        offset[axis] = is_rotary ? value * kDegree : in_inches ? value * 25.4 : value;
      } else if (c == 'p' || c == 'd' || c == 'i' || c == 'j' || c == 'q') {
        table_number(cursor, "a number");
      } else {
        cursor.fail(begin, "is not a word of a tool table", "T P X Y Z A B C U V W D I J Q and a comment behind ;");
      }
    }
    if (number < 0) cursor.fail(line, "the number of the tool is missing", "T");
    if (!tools.emplace(number, offset).second) cursor.fail(line, "this tool is in the table already");
  });
  return tools;
}

std::map<int, double> read_nc_parameters(const std::filesystem::path& path) {
  return parse_nc_parameters(read_text_file(path), path.string());
}

NcToolTable read_nc_tools(const std::filesystem::path& path, bool in_inches) {
  return parse_nc_tools(read_text_file(path), path.string(), in_inches);
}

}  // namespace abbe
