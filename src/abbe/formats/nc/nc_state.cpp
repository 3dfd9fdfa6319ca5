#include "abbe/formats/nc/nc_state.h"

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

std::uint32_t words_of_machine(const NcProgramOptions& options) {
  std::uint32_t words = 0;
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    if (options.words[k]) words |= axis_bit(k);
  }
  return words;
}

}  // namespace

NcState::NcState(const NcProgramOptions& options)
    : tools(options.tools, options.tool), position(words_of_machine(options)) {
  modes.inches = modes.feed_inches = options.inches;
  for_axes(position.machine_words(), [&](std::size_t k) {
    if (options.start[k]) {
      position.begin_at(k, is_rotary_word(k) ? *options.start[k] / kDegree : *options.start[k]);
    }
  });
}

}  // namespace abbe
