#include "abbe/formats/controls/table_linuxcnc.h"

#include <fmt/format.h>

#include <cassert>

#include "abbe/formats/nc/program_text.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/table_numbers.h"

namespace abbe {
namespace {

constexpr int kDecimals = 7;

}  // namespace

std::string linuxcnc_text(const AxisTable& table, bool rotary, LinuxCncCompensation type) {
  assert(table.positions.size() <= kLinuxCncPoints);
  std::string text;
  for (std::size_t k = 0; k < table.positions.size(); ++k) {
    const double nominal = shown_position(table.positions[k], rotary);
    double forward = shown_position(table.forward[k], rotary), reverse = shown_position(table.reverse[k], rotary);
    if (type == LinuxCncCompensation::actual) {
      forward = nominal - forward;
      reverse = nominal - reverse;
    }
    text += fmt::format("{} {} {}\n", fixed_number(nominal, kDecimals), fixed_number(forward, kDecimals),
                        fixed_number(reverse, kDecimals));
  }
  return text;
}

AxisTable parse_linuxcnc(std::string_view text, const std::string& file, bool rotary, LinuxCncCompensation type) {
  const bool actual = type == LinuxCncCompensation::actual;
  const std::string unit = rotary ? "degrees" : "mm";
  const std::string names[3] = {"nominal", actual ? "actual forward" : "forward trim",
                                actual ? "actual reverse" : "reverse trim"};
  AxisTable table;
  TableLines lines(text, file);
  std::size_t blank_line = 0;
  while (lines.next()) {
    const std::vector<std::string_view> words = words_of(lines.line());
    if (words.empty()) {
      if (blank_line == 0) blank_line = lines.number();
      continue;
    }
    if (blank_line != 0) {
      throw InputError({.file = file, .line = blank_line}, "LinuxCNC stops reading at a blank line",
                       "three numbers on every line");
    }
    if (words.size() != 3) {
      lines.fail(words.size() < 3 ? names[words.size()] : "line", fmt::format("{} words", words.size()),
                 fmt::format("three numbers in {}: {}, {}, {}; LinuxCNC stops reading at any other line", unit,
                             names[0], names[1], names[2]));
    }
    double values[3];
    for (std::size_t c = 0; c < 3; ++c) values[c] = lines.value(words[c], names[c], "a number in " + unit);
    if (table.positions.size() == kLinuxCncPoints) {
      lines.fail("line", "a further point", fmt::format("at most {} points: LinuxCNC drops the rest", kLinuxCncPoints));
    }
    const double position = inside_position(values[0], rotary);
    if (!table.positions.empty() && !(position > table.positions.back())) {
      lines.fail(names[0], fmt::format("{} is not above the one before", words[0]), "increasing positions in " + unit);
    }
    table.positions.push_back(position);
    table.forward.push_back(inside_position(actual ? values[0] - values[1] : values[1], rotary));
    table.reverse.push_back(inside_position(actual ? values[0] - values[2] : values[2], rotary));
  }
  if (table.positions.empty()) throw InputError({.file = file}, "no points", "three numbers in " + unit + " per line");
  return table;
}

}  // namespace abbe
