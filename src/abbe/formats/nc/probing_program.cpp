#include "abbe/formats/nc/probing_program.h"

#include <algorithm>

#include "abbe/formats/nc/measuring_dialect.h"
#include "abbe/formats/nc/program_text.h"
#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

std::string short_number(double value) {
  std::string text = fixed_number(value, 4);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

void check_log_name(const std::string& log) {
  const bool is_plain = std::all_of(log.begin(), log.end(), [](char c) {
    return is_letter(c) || is_digit(c) || c == '.' || c == '-' || c == '_' || c == '/';
  });
  if (!log.empty() && is_plain) return;
  throw InputError({.field = "--probe-log"}, "'" + log + "' is no name that a comment of the program can hold",
                   "letters, digits, '.', '-', '_' and '/'");
}

}  // namespace

std::string probing_program(const Machine& machine, const std::vector<ProbingStep>& steps,
                            const ProbingProgramOptions& options) {
  check_log_name(options.log);
  MeasuringProgramOptions naming;
  naming.dialect = NcDialect::linuxcnc;
  naming.words = options.words;
  std::string text;
  for (const std::string& line : options.comments) text += "(" + plain_words(line) + ")\n";
  text += "G21 G90 G94 G40 G49 G80 G61\n";
  text += "(PROBEOPEN " + options.log + ")\n";
  std::vector<std::string> last(machine.axes.size());
  for (const ProbingStep& step : steps) {
    text += "(" + plain_words(step.words) + ")\n";
    for (const ProbingMove& move : step.moves) {
      std::string words;
      for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const std::string value = fixed_number(in_degrees_or_mm(machine.axes[i], move.pose[i]), options.decimals);
        if (value == last[i]) continue;
        words += " " + measuring_word(machine.axes[i], naming) + value;
        last[i] = move.touches ? std::string() : value;
      }
      if (words.empty()) continue;
      if (move.touches && options.dwell > 0) text += "G4 P" + short_number(options.dwell) + "\n";
      const double feed = move.touches ? options.probing_feed : options.feed;
      text += (move.touches ? "G38.2" : feed > 0 ? "G1" : "G0") + words;
      if (feed > 0) text += " F" + short_number(60 * feed);
      text += "\n";
    }
  }
  return text + "(PROBECLOSE)\nM30\n";
}

}  // namespace abbe
