#include "abbe/formats/controls/table_skew.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "abbe/formats/nc/program_text.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/table_numbers.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

constexpr double kSide_mm = 100;

/// "AC,BD,AD" of a rhombus whose sides enclose the angle with this cotangent.
std::string rhombus_text(double factor) {
  const double cosine = factor / std::sqrt(1 + factor * factor);
  return fmt::format("{},{},{}", trimmed_decimals(kSide_mm * std::sqrt(2 + 2 * cosine), 6),
                     trimmed_decimals(kSide_mm * std::sqrt(2 - 2 * cosine), 6), trimmed_decimals(kSide_mm, 6));
}

double factor_of(const TableLines& lines, const std::string& plane, std::string_view lengths) {
  double values[3];
  const char* const names[3] = {"AC", "BD", "AD"};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t comma = k < 2 ? lengths.find(',') : lengths.size();
    if (comma == std::string_view::npos) lines.fail(plane, "three lengths are needed", "AC,BD,AD in mm");
    values[k] = lines.value(without_blanks(lengths.substr(0, comma)), plane + " " + names[k], "a length in mm");
    if (!(values[k] > 0)) lines.fail(plane + " " + names[k], "is not above zero", "a length in mm");
    lengths.remove_prefix(k < 2 ? comma + 1 : lengths.size());
  }
  const double square = 2 * values[0] * values[0] + 2 * values[1] * values[1] - 4 * values[2] * values[2];
  if (!(square > 0)) lines.fail(plane, "no such parallelogram", "diagonals that are long enough for the side");
  const double side = std::sqrt(square) / 2;
  const double cosine = (values[0] * values[0] - side * side - values[2] * values[2]) / (2 * side * values[2]);
  if (!(std::abs(cosine) <= std::numbers::sqrt2 / 2)) {
    lines.fail(plane, "an angle beyond 45 degrees", "nearly equal diagonals");
  }
  // tan(pi/2 - acos(c)) without its rounding.
  const double factor = cosine / std::sqrt(1 - cosine * cosine);
  return std::abs(factor) <= 1 ? factor : std::copysign(1.0, factor);
}

}  // namespace

std::string klipper_skew_text(const SkewFactors& factors) {
  return fmt::format("SET_SKEW XY={} XZ={} YZ={}\nSKEW_PROFILE SAVE=abbe\nSAVE_CONFIG\n", rhombus_text(factors.xy),
                     rhombus_text(factors.xz), rhombus_text(factors.yz));
}

SkewFactors parse_klipper_skew(std::string_view text, const std::string& file) {
  SkewFactors factors;
  TableLines lines(text, file);
  bool found = false;
  while (lines.next()) {
    const std::vector<std::string_view> words = words_of(lines.line().substr(0, lines.line().find('#')));
    if (words.empty() || words[0] == "SKEW_PROFILE" || words[0] == "SAVE_CONFIG") continue;
    if (words[0] != "SET_SKEW" || found) {
      lines.fail("", fmt::format("'{}' is not understood", shown_word(words[0])), "SET_SKEW once");
    }
    found = true;
    bool given[3] = {};
    for (std::size_t k = 1; k < words.size(); ++k) {
      const std::size_t equals = words[k].find('=');
      const std::string_view plane = words[k].substr(0, equals);
      const std::size_t which = plane == "XY" ? 0U : plane == "XZ" ? 1U : plane == "YZ" ? 2U : 3U;
      if (which == 3 || equals == std::string_view::npos || given[which]) {
        lines.fail(shown_word(words[k]), "is not understood", "XY=AC,BD,AD, XZ=..., YZ=..., each once");
      }
      given[which] = true;
      const double factor = factor_of(lines, std::string(plane), words[k].substr(equals + 1));
      (which == 0 ? factors.xy : which == 1 ? factors.xz : factors.yz) = factor;
    }
  }
  if (!found) throw InputError({.file = file}, "no factors", "SET_SKEW XY=AC,BD,AD");
  return factors;
}

std::string marlin_skew_text(const SkewFactors& factors) {
  return fmt::format("M852 I{} J{} K{}\nM500\n", fixed_number(factors.xy, 9), fixed_number(factors.xz, 9),
                     fixed_number(factors.yz, 9));
}

SkewFactors parse_marlin_skew(std::string_view text, const std::string& file) {
  SkewFactors factors;
  TableLines lines(text, file);
  bool found = false;
  while (lines.next()) {
    const std::vector<std::string_view> words = words_of(lines.line().substr(0, lines.line().find(';')));
    if (words.empty() || words[0] == "M500") continue;
    if (words[0] != "M852" || found) {
      lines.fail("", fmt::format("'{}' is not understood", shown_word(words[0])), "M852 once");
    }
    found = true;
    bool given[3] = {};
    for (std::size_t k = 1; k < words.size(); ++k) {
      const char letter = words[k][0];
      const std::size_t which = letter == 'I' || letter == 'S' ? 0U : letter == 'J' ? 1U : letter == 'K' ? 2U : 3U;
      if (which == 3 || given[which]) lines.fail(shown_word(words[k]), "is not understood", "I, J and K, each once");
      given[which] = true;
      const double factor = lines.value(words[k].substr(1), std::string(1, letter), "a factor from -1 to 1");
      if (!(std::abs(factor) <= 1)) lines.fail(std::string(1, letter), "out of range", "a factor from -1 to 1");
      (which == 0 ? factors.xy : which == 1 ? factors.xz : factors.yz) = factor;
    }
  }
  if (!found) throw InputError({.file = file}, "no factors", "M852 I... J... K...");
  return factors;
}

}  // namespace abbe
