#include "compensate/reversal_words.h"

#include <fmt/format.h>

#include <string>

namespace abbe {

std::string reversal_size(const Machine& machine, std::size_t axis, double value) {
  const bool rotary = machine.axes[axis].kind == AxisKind::rotary;
  return fmt::format("{:.4g} {}", (rotary ? 1e6 : 1e3) * value, rotary ? "urad" : "um");
}

void warn_of_reversals(const Machine& machine, const ErrorSet& errors) {
  std::string words;
  for (const Reversal& reversal : errors.reversals) {
    if (reversal.value == 0) continue;
    words += fmt::format("{}{} {}", words.empty() ? "" : ", ", machine.axes[reversal.axis].name,
                         reversal_size(machine, reversal.axis, reversal.value));
  }
  if (words.empty()) return;
  fmt::print(stderr,
             "abbe: reversal values are not compensated, corrections are the means of both directions of approach: "
             "{}; a control has a backlash parameter for them\n",
             words);
}

}  // namespace abbe
