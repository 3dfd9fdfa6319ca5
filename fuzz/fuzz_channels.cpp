// Channels of states over time: any bytes give channels that answer at every time, or an InputError.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string_view>

#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/readings/channel_file.h"
#include "abbe/formats/text/input_error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const abbe::Machine machine = abbe::parse_machine(
      "name = \"m\"\nchain = \"w b X t\"\n[axis.X]\ntravel_mm = [0, 1]\n[state.air]\nkind = \"measured\"\nunit = "
      "\"degC\"\n[state.feed]\nkind = \"measured\"\nunit = \"1\"\n[state.column]\nkind = \"lag\"\nof = \"air\"\n"
      "time_constant_s = 100\n",
      "fuzz");
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    abbe::StateChannels channels;
    channels.add(text, "log.csv", machine, {});
    for (std::size_t state = 0; state < machine.states.size(); ++state) {
      const abbe::StateChannel* channel = channels.of(state);
      if (channel == nullptr) continue;
      const std::vector<double>& times = channel->time_s;
      if (channel->value.size() != times.size() ||
          std::adjacent_find(times.begin(), times.end(), std::greater_equal<>()) != times.end()) {
        std::abort();
      }
      const abbe::LaggedChannel lag(*channel, 100);
      for (const double time : times) {
        const abbe::ChannelValue at = abbe::channel_value(*channel, time), behind = lag.at(time);
        if (at.status != abbe::ChannelStatus::known || !std::isfinite(at.value)) std::abort();
        if (behind.status == abbe::ChannelStatus::known && !std::isfinite(behind.value)) std::abort();
        static_cast<void>(abbe::channel_value(*channel, time + 1));
        static_cast<void>(lag.at(time + 1));
      }
    }
  } catch (const abbe::InputError&) {
  }
  return 0;
}
