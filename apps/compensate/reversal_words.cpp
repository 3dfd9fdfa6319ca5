#include "compensate/reversal_words.h"

#include <fmt/format.h>

#include <string>

namespace abbe {

void warn_of_reversals(const Machine& machine, const ErrorSet& errors) {
  std::string words;
  for (const Reversal& reversal : errors.reversals) {
    if (reversal.value == 0) continue;
    const Axis& axis = machine.axes[reversal.axis];
    const bool rotary = axis.kind == AxisKind::rotary;
    words += fmt::format("{}{} {:.4g} {}", words.empty() ? "" : ", ", axis.name, (rotary ? 1e6 : 1e3) * reversal.value,
                         rotary ? "urad" : "um");
  }
  if (words.empty()) return;
  fmt::print(stderr,
             "abbe: reversal values are not compensated, corrections are the means of both directions of approach: "
             "{}; a control has a backlash parameter for them\n",
             words);
}

}  // namespace abbe
