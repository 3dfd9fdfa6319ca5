#include "abbe/formats/nc/program_text.h"

#include <fmt/format.h>

#include "abbe/geometry/angle_units.h"

namespace abbe {

double in_degrees_or_mm(const Axis& axis, double command) {
  return axis.kind == AxisKind::rotary ? command / kDegree : command;
}

std::string fixed_number(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  return text.find_first_not_of("-0.") == std::string::npos && text[0] == '-' ? text.substr(1) : text;
}

std::string program_comment(std::string text) {
  for (char& c : text) {
    if (c == '(' || c == ')' || static_cast<unsigned char>(c) < ' ') c = ' ';
  }
  return "(" + text + ")\n";
}

}  // namespace abbe
