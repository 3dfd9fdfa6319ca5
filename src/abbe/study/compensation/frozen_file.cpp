#include "abbe/study/compensation/frozen_file.h"

#include <fmt/format.h>

#include <array>
#include <memory>
#include <nlohmann/json.hpp>

#include "abbe/formats/text/input_error.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

std::string frozen_axis_name(const abbe_runtime_axis& axis) {
  return axis.letter + (axis.number > 0 ? std::to_string(axis.number) : std::string());
}

/// The errors are not known all over the travel. Fourier series and constants hold everywhere.
bool is_narrower(const abbe_runtime_axis& axis) {
  if (axis.endless != 0) return axis.map_max < 1e5;
  const double room = 1e-6 * (axis.travel_max - axis.travel_min);
  return axis.map_min > axis.travel_min + room || axis.map_max < axis.travel_max - room;
}

std::string range_text(const char* what, double from, double to, bool rotary) {
  const AxisKind kind = rotary ? AxisKind::rotary : AxisKind::linear;
  const double unit = position_unit(kind);
  return fmt::format("{} {:g} to {:g} {}", what, from / unit, to / unit, position_suffix(kind));
}

}  // namespace

CheckedFrozenFile check_frozen_file(std::string_view bytes, const std::string& file) {
  std::array<char, 256> why{};
  abbe_runtime* handle = nullptr;
  const int result = abbe_runtime_load(bytes.data(), bytes.size(), why.data(), why.size(), &handle);
  if (result != ABBE_OK) {
    throw InputError({.file = file}, why.data(), "a whole file of abbe compensate freeze, of this version");
  }
  const std::unique_ptr<abbe_runtime, decltype(&abbe_runtime_free)> runtime(handle, &abbe_runtime_free);
  CheckedFrozenFile frozen;
  frozen.file = file;
  abbe_runtime_describe(runtime.get(), &frozen.about);
  frozen.axes.resize(static_cast<std::size_t>(frozen.about.axes));
  for (int i = 0; i < frozen.about.axes; ++i) {
    abbe_runtime_describe_axis(runtime.get(), i, &frozen.axes[static_cast<std::size_t>(i)]);
  }
  frozen.channels.resize(static_cast<std::size_t>(abbe_runtime_channels(runtime.get())));
  for (std::size_t c = 0; c < frozen.channels.size(); ++c)
    abbe_runtime_describe_channel(runtime.get(), static_cast<int>(c), &frozen.channels[c]);
  frozen.lags.resize(static_cast<std::size_t>(abbe_runtime_lags(runtime.get())));
  for (std::size_t k = 0; k < frozen.lags.size(); ++k)
    abbe_runtime_describe_lag(runtime.get(), static_cast<int>(k), &frozen.lags[k]);
  return frozen;
}

std::string frozen_file_text(const CheckedFrozenFile& frozen) {
  const abbe_runtime_information& about = frozen.about;
  std::string text;
  text += fmt::format("{}: frozen compensation of {}, whole\n", frozen.file, about.machine);
  text += fmt::format("  {} bytes, abbe {}, checksum {:016x} (machine and errors {:016x})\n", about.bytes,
                      about.version, about.checksum, about.source_checksum);
  text +=
      fmt::format("  {}\n", about.tool_centre != 0 ? "tool centre control and corrected axis positions"
                                                   : "corrected axis positions only: the point does not give the axes");
  for (const abbe_runtime_axis& axis : frozen.axes) {
    text += fmt::format("  {:<4}", frozen_axis_name(axis));
    text += axis.endless != 0 ? "endless" : range_text("travel", axis.travel_min, axis.travel_max, axis.rotary != 0);
    if (is_narrower(axis)) text += range_text(", errors known", axis.map_min, axis.map_max, axis.rotary != 0);
    text += "\n";
  }
  text += fmt::format("  tools of {:g} to {:g} mm; without one ({:g}, {:g}, {:g}) mm\n", about.tool_length_min,
                      about.tool_length_max, about.tool[0], about.tool[1], about.tool[2]);
  text += fmt::format("  largest correction of the tool {:.1f} um, of its direction {:.1f} urad\n",
                      1e3 * about.largest_correction_mm, 1e6 * about.largest_correction_rad);
  for (const abbe_runtime_channel& channel : frozen.channels) {
    text +=
        fmt::format("  state {}: {:g} to {:g}{}, reference {:g}\n", channel.name, channel.range_min, channel.range_max,
                    std::string_view(channel.unit) == "1" ? "" : fmt::format(" {}", channel.unit), channel.reference);
  }
  for (const abbe_runtime_lag& lag : frozen.lags) {
    text += fmt::format("  state {}: lag of {}, {:g} s\n", lag.name,
                        frozen.channels[static_cast<std::size_t>(lag.channel)].name, lag.time_constant_s);
  }
  if (about.has_uncertainty != 0) {
    text += fmt::format("  standard uncertainty of the tool's correction: {:.2f} um on average, at most {:.2f} um\n",
                        1e3 * about.mean_uncertainty_mm, 1e3 * about.largest_uncertainty_mm);
  } else {
    text += fmt::format("  standard uncertainty of the tool's correction: not stated\n");
  }
  return text;
}

nlohmann::ordered_json frozen_file_json(const CheckedFrozenFile& frozen) {
  const abbe_runtime_information& about = frozen.about;
  nlohmann::ordered_json json;
  json["machine"] = about.machine;
  json["bytes"] = about.bytes;
  json["version"] = about.version;
  json["checksum"] = fmt::format("{:016x}", about.checksum);
  json["source_checksum"] = fmt::format("{:016x}", about.source_checksum);
  json["axes"] = about.axes;
  json["tool_centre"] = about.tool_centre != 0;
  json["tool_mm"] = {about.tool[0], about.tool[1], about.tool[2]};
  json["tool_length_mm"] = {about.tool_length_min, about.tool_length_max};
  json["largest_correction_um"] = 1e3 * about.largest_correction_mm;
  json["largest_correction_urad"] = 1e6 * about.largest_correction_rad;
  if (about.has_uncertainty != 0) {
    json["standard_uncertainty_um"] = {{"mean", 1e3 * about.mean_uncertainty_mm},
                                       {"largest", 1e3 * about.largest_uncertainty_mm}};
  }
  for (const abbe_runtime_channel& channel : frozen.channels) {
    json["states"].push_back({{"name", channel.name},
                              {"unit", channel.unit},
                              {"reference", channel.reference},
                              {"range", {channel.range_min, channel.range_max}}});
  }
  for (const abbe_runtime_lag& lag : frozen.lags) {
    json["lags"].push_back({{"name", lag.name},
                            {"of", frozen.channels[static_cast<std::size_t>(lag.channel)].name},
                            {"time_constant_s", lag.time_constant_s}});
  }
  return json;
}

}  // namespace abbe
