#include "abbe/formats/nc/probing_program.h"

#include <algorithm>

#include "abbe/formats/nc/measuring_dialect.h"
#include "abbe/formats/nc/program_text.h"
#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/table_numbers.h"

namespace abbe {
namespace {

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
      if (move.touches && options.dwell > 0) text += "G4 P" + trimmed_decimals(options.dwell, 4) + "\n";
      if (move.touches) {
        text += "G38.2" + words + " " + feed_text(options.probing_feed, "--probing-feed-mm-per-min") + "\n";
      } else {
        text += options.feed > 0 ? "G1" + words + " " + feed_text(options.feed) + "\n" : "G0" + words + "\n";
      }
    }
  }
  return text + "(PROBECLOSE)\nM30\n";
}

}  // namespace abbe
