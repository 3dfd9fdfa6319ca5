#include "abbe/study/compensation/program_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "abbe/formats/nc/path_program.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

struct NamedProblem {
  const char* name;
  bool AllowedProblems::*allowed;
};

constexpr auto kNamedProblems = std::to_array<NamedProblem>({
    {"not-covered", &AllowedProblems::not_covered},
    {"outside-travel", &AllowedProblems::outside_travel},
    {"held-start", &AllowedProblems::held_start},
    {"position-left", &AllowedProblems::position_left},
    {"not-converged", &AllowedProblems::not_converged},
    {"not-proven", &AllowedProblems::not_proven},
});

/// "a, b or c"
std::string names_of_problems() {
  std::string names;
  for (const NamedProblem& problem : kNamedProblems) {
    names += &problem == &kNamedProblems.front() ? "" : &problem == &kNamedProblems.back() ? " or " : ", ";
    names += problem.name;
  }
  return names;
}

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
                         fmt::format("axis {} is {}, but its word {} is not", machine.axes[axis].name,
                                     rotary ? "rotary" : "linear", word),
                         "A, B or C for rotary axes, X, Y, Z, U, V or W for linear ones");
      }
      words.axis[i] = axis;
      any = true;
    }
  }
  if (!any) {
    throw InputError({.file = machine_file}, "no axis of the machine has a program word",
                     "--word AXIS=WORD, such as --word C1=C");
  }
  return words;
}

std::size_t axis_of_word(const WordAxes& words, const std::string& word, const std::string& text) {
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    if (word == axis_word_text(static_cast<AxisWord>(i)) && words.axis[i] != Machine::npos) return words.axis[i];
  }
  throw InputError({.field = "--start " + text}, fmt::format("no axis of the machine has the word '{}'", word),
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
  for (const std::string& name : names) {
    const auto* const found = std::find_if(kNamedProblems.begin(), kNamedProblems.end(),
                                           [&](const NamedProblem& problem) { return name == problem.name; });
    if (found == kNamedProblems.end()) throw InputError({.field = "--allow " + name}, "unknown", names_of_problems());
    allowed.*found->allowed = true;
  }
  return allowed;
}

ProgramLimits default_program_limits(std::size_t size) {
  const double megabytes = 1e-6 * static_cast<double>(size);
  return {200 + 20 * megabytes, 5 + 0.1 * megabytes};
}

}  // namespace abbe
