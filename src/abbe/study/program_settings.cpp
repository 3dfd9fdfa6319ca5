#include "abbe/study/program_settings.h"

#include <fmt/format.h>

#include <utility>

#include "abbe/formats/nc/path_program.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

bool is_rotary_word(std::size_t word) { return word >= 3 && word < 6; }

}  // namespace

WordAxes program_word_axes(const Machine& machine, const std::vector<std::string>& texts,
                           const std::string& machine_file) {
  PathProgramOptions named;
  named.words = axis_words(machine, texts, "--word");
  WordAxes words;
  bool any = false;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    const std::string word = axis_word(machine.axes[axis].name, named);
    for (std::size_t i = 0; i < kAxisWords; ++i) {
      if (word != axis_word_text(static_cast<AxisWord>(i))) continue;
      const bool rotary = machine.axes[axis].kind == AxisKind::rotary;
      if (rotary != is_rotary_word(i)) {
        throw InputError({.field = "--word"},
                         fmt::format("axis {} is {}, its word {} is not", machine.axes[axis].name,
                                     rotary ? "rotary" : "linear", word),
                         "A, B or C for rotary axes, X, Y, Z, U, V or W for linear ones");
      }
      words.axis[i] = axis;
      any = true;
    }
  }
  if (!any) {
    throw InputError({.file = machine_file}, "no axis has a word of programs", "--word AXIS=WORD, such as --word C1=C");
  }
  return words;
}

std::size_t axis_of_word(const WordAxes& words, const std::string& word, const std::string& text) {
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    if (word == axis_word_text(static_cast<AxisWord>(i)) && words.axis[i] != Machine::npos) return words.axis[i];
  }
  throw InputError({.field = "--start " + text}, fmt::format("'{}' is not a word of an axis of the machine", word),
                   "WORD_unit=position, such as X_mm=100 or C_deg=30");
}

void set_program_start(const Machine& machine, const WordAxes& words, const HeldAxis& start, bool tool_centre,
                       const std::string& text, NcProgramOptions& options) {
  const Axis& axis = machine.axes[start.axis];
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    if (words.axis[i] != start.axis) continue;
    const bool within = start.position >= axis.travel_min && start.position <= axis.travel_max;
    if ((!tool_centre || is_rotary_word(i)) && !axis.endless && !within) {
      const double unit = position_unit(axis);
      throw InputError(
          {.field = "--start " + text}, "outside the axis's travel",
          fmt::format("{:g} to {:g} {}", axis.travel_min / unit, axis.travel_max / unit, position_suffix(axis)));
    }
    options.start[i] = start.position;
  }
}

AllowedProblems allowed_problems(std::span<const std::string> names) {
  AllowedProblems allowed;
  const std::pair<const char*, bool*> all[] = {
      {"not-covered", &allowed.not_covered},     {"outside-travel", &allowed.outside_travel},
      {"held-start", &allowed.held_start},       {"position-left", &allowed.position_left},
      {"not-converged", &allowed.not_converged}, {"not-proven", &allowed.not_proven}};
  for (const std::string& name : names) {
    bool known = false;
    for (const auto& [text, flag] : all) {
      if (name == text) *flag = known = true;
    }
    if (known) continue;
    throw InputError({.field = "--allow " + name}, "unknown",
                     "not-covered, outside-travel, held-start, position-left, not-converged or not-proven");
  }
  return allowed;
}

ProgramLimits usual_program_limits(std::size_t size) {
  const double megabytes = 1e-6 * static_cast<double>(size);
  return {200 + 20 * megabytes, 5 + 0.1 * megabytes};
}

}  // namespace abbe
