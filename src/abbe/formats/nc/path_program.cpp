#include "abbe/formats/nc/path_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "abbe/formats/nc/program_text.h"
#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {
namespace {

/// Letters and digits only where "=" keeps them from the number behind: C112.5 would be an axis C or an axis C1.
bool is_axis_word(const std::string& word) {
  if (word.empty() || !is_letter(word[0])) return false;
  if (word.size() == 1) return std::string_view("FGMNOPSTfgmnopst").find(word[0]) == std::string_view::npos;
  return word.back() == '=' &&
         std::all_of(word.begin(), word.end() - 1, [](char c) { return is_letter(c) || is_digit(c) || c == '_'; });
}

class ProgramWriter {
 public:
  ProgramWriter(const Machine& machine, const PathProgramOptions& options) : machine_(machine), options_(options) {
    last_.resize(machine.axes.size());
  }

  std::string write(const ToolPath& path, const std::vector<std::vector<double>>& commands) {
    for (const std::string& line : options_.comments) text_ += program_comment(line);
    text_ += "G21 G90 G94\n";
    std::size_t region = 0;
    for (std::size_t i = 0; i < path.steps.size(); ++i) {
      const ToolPathStep& step = path.steps[i];
      if (path.regions > 1 && (i == 0 || step.region != region)) {
        text_ += program_comment(fmt::format("region {}", step.region + 1));
        region = step.region;
      }
      step.working ? work(step, commands[i], i > 0 ? commands[i - 1] : commands[i]) : rapid(commands[i]);
      const bool goes_on = i + 1 < path.steps.size() && path.steps[i + 1].working;
      if (step.dwell > 0) {
        mode(false);
        beam(true);
        text_ += "G4 P" + fixed_number(step.dwell, 3) + "\n";
      }
      if (!goes_on) beam(false);
    }
    mode(false);
    return text_ + "M30\n";
  }

 private:
  /// Words of the axes that move; those of the first block are complete.
  std::string moves(const std::vector<double>& command) {
    std::string words;
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
      const std::string value = fixed_number(in_degrees_or_mm(machine_.axes[i], command[i]), options_.decimals);
      if (value == last_[i]) continue;
      last_[i] = value;
      words += " " + axis_word(machine_.axes[i].name, options_) + value;
    }
    return words;
  }

  void rapid(const std::vector<double>& command) {
    mode(false);
    beam(false);
    const std::string words = moves(command);
    if (!words.empty()) text_ += "G0" + words + "\n";
  }

  void work(const ToolPathStep& step, const std::vector<double>& command, const std::vector<double>& before) {
    beam(true);
    mode(options_.inverse_time && step.feed > 0);
    const std::string words = moves(command);
    if (words.empty()) return;
    text_ += "G1" + words;
    if (step.feed > 0) {
      // Where the tool turns on the spot the axes give the time: as on a radius of 100 mm.
      double length = step.length;
      if (length < 1e-6) {
        double squared = 0;
        for (std::size_t i = 0; i < command.size(); ++i) {
          const double weight = machine_.axes[i].kind == AxisKind::rotary ? 100 : 1;
          squared += weight * weight * (command[i] - before[i]) * (command[i] - before[i]);
        }
        length = std::max(std::sqrt(squared), 1e-6);
      }
      text_ += " F" + fixed_number(60 * step.feed / (options_.inverse_time ? length : 1), 4);
    }
    text_ += "\n";
  }

  void beam(bool on) {
    if (on != beam_) text_ += on ? "M3\n" : "M5\n";
    beam_ = on;
  }
  void mode(bool inverse) {
    if (inverse != inverse_) text_ += inverse ? "G93\n" : "G94\n";
    inverse_ = inverse;
  }

  const Machine& machine_;
  const PathProgramOptions& options_;
  std::string text_;
  std::vector<std::string> last_;
  bool beam_ = false, inverse_ = false;
};

}  // namespace

std::string axis_word(const std::string& name, const PathProgramOptions& options) {
  const auto word = options.words.find(name);
  if (word != options.words.end()) return word->second;
  return name.size() == 1 ? name : name + "=";
}

std::map<std::string, std::string> axis_words(const Machine& machine, const std::vector<std::string>& texts,
                                              const std::string& option) {
  PathProgramOptions options;
  for (const std::string& text : texts) {
    const InputError::Place place{.field = option + " " + text};
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    if (equals == std::string::npos || equals + 1 == text.size() || machine.find_axis(name) == Machine::npos) {
      throw InputError(place, "not an axis of this machine and its word", "AXIS=WORD, such as C1=C");
    }
    const std::string word = text.substr(equals + 1);
    if (!is_axis_word(word)) {
      throw InputError(
          place, "no word of an axis",
          "a letter other than F, G, M, N, O, P, S, T, or a name that ends in '=', such as C1=C or C1=C1=");
    }
    if (!options.words.emplace(name, word).second) throw InputError(place, "this axis has a word already");
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (axis_word(machine.axes[i].name, options) == axis_word(machine.axes[k].name, options)) {
        throw InputError({.field = option}, "two axes have the word " + axis_word(machine.axes[i].name, options),
                         "a word of its own for each axis");
      }
    }
  }
  return options.words;
}

std::string path_program(const Machine& machine, const ToolPath& path, const std::vector<std::vector<double>>& commands,
                         const PathProgramOptions& options) {
  return ProgramWriter(machine, options).write(path, commands);
}

std::string path_csv(const Machine& machine, const ToolPath& path, const std::vector<std::vector<double>>& commands) {
  std::string text = "step,point,region,beam";
  for (const Axis& axis : machine.axes) text += "," + axis.name + (axis.kind == AxisKind::rotary ? "_deg" : "_mm");
  text += ",length_mm,feed_mm_per_min,dwell_s\n";
  for (std::size_t i = 0; i < path.steps.size(); ++i) {
    const ToolPathStep& step = path.steps[i];
    // Points count from 1 as people do; 0: a pose between them.
    text += fmt::format("{},{},{},{}", i + 1, step.point == ToolPathStep::kNoPoint ? 0 : step.point + 1,
                        step.region + 1, step.working ? 1 : 0);
    for (std::size_t k = 0; k < machine.axes.size(); ++k) {
      text += "," + shortest_text(in_degrees_or_mm(machine.axes[k], commands[i][k]));
    }
    text += fmt::format(",{},{},{}\n", shortest_text(step.length), shortest_text(60 * step.feed),
                        shortest_text(step.dwell));
  }
  return text;
}

}  // namespace abbe
