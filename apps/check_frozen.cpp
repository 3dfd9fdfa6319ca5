#include "check_frozen.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "abbe/formats/files/standard_input.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/runtime/abbe_runtime.h"
#include "exit_code.h"

namespace abbe {
namespace {

using Runtime = std::unique_ptr<abbe_runtime, decltype(&abbe_runtime_free)>;

Runtime load(const std::string& file) {
  const std::string bytes = read_text_file(file);
  std::array<char, 256> why{};
  abbe_runtime* handle = nullptr;
  const int result = abbe_runtime_load(bytes.data(), bytes.size(), why.data(), why.size(), &handle);
  if (result != ABBE_OK) {
    throw InputError({.file = file}, why.data(), "a whole file of abbe compensate freeze, of this version");
  }
  return {handle, &abbe_runtime_free};
}

std::string axis_name(const abbe_runtime_axis& axis) {
  return axis.letter + (axis.number > 0 ? std::to_string(axis.number) : std::string());
}

/// The errors are not known all over the travel. Fourier series and constants hold everywhere.
bool is_narrower(const abbe_runtime_axis& axis) {
  if (axis.endless != 0) return axis.map_max < 1e5;
  const double room = 1e-6 * (axis.travel_max - axis.travel_min);
  return axis.map_min > axis.travel_min + room || axis.map_max < axis.travel_max - room;
}

void print_range(const char* what, double from, double to, bool rotary) {
  const AxisKind kind = rotary ? AxisKind::rotary : AxisKind::linear;
  const double unit = position_unit(kind);
  fmt::print("{} {:g} to {:g} {}", what, from / unit, to / unit, position_suffix(kind));
}

void print_frozen(const std::string& file, const abbe_runtime* runtime, const abbe_runtime_information& about) {
  fmt::print("{}: frozen compensation of {}, whole\n", file, about.machine);
  fmt::print("  {} bytes, abbe {}, checksum {:016x} (machine and errors {:016x})\n", about.bytes, about.version,
             about.checksum, about.source_checksum);
  fmt::print("  {}\n", about.tool_centre != 0 ? "tool centre control and corrected axis positions"
                                              : "corrected axis positions only: the point does not give the axes");
  for (int i = 0; i < about.axes; ++i) {
    abbe_runtime_axis axis{};
    abbe_runtime_describe_axis(runtime, i, &axis);
    fmt::print("  {:<4}", axis_name(axis));
    if (axis.endless != 0) {
      fmt::print("endless");
    } else {
      print_range("travel", axis.travel_min, axis.travel_max, axis.rotary != 0);
    }
    if (is_narrower(axis)) {
      print_range(", errors known", axis.map_min, axis.map_max, axis.rotary != 0);
    }
    fmt::print("\n");
  }
  fmt::print("  tools of {:g} to {:g} mm; without one ({:g}, {:g}, {:g}) mm\n", about.tool_length_min,
             about.tool_length_max, about.tool[0], about.tool[1], about.tool[2]);
  fmt::print("  largest correction of the tool {:.1f} um, of its direction {:.1f} urad\n",
             1e3 * about.largest_correction_mm, 1e6 * about.largest_correction_rad);
  if (about.has_uncertainty != 0) {
    fmt::print("  standard uncertainty of the tool's correction: {:.2f} um on average, at most {:.2f} um\n",
               1e3 * about.mean_uncertainty_mm, 1e3 * about.largest_uncertainty_mm);
  } else {
    fmt::print("  standard uncertainty of the tool's correction: not stated\n");
  }
}

nlohmann::ordered_json frozen_json(const abbe_runtime_information& about) {
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
  return json;
}

}  // namespace

bool is_frozen_file(const std::string& file) {
  if (file == kStandardInput)
    return MappedFile(file).text().starts_with(
        "\x89"
        "ABBEC");
  return std::filesystem::path(file).extension() == ".abbec";
}

int check_frozen(const std::string& file, bool json) {
  const Runtime runtime = load(file);
  abbe_runtime_information about{};
  abbe_runtime_describe(runtime.get(), &about);
  if (json) {
    fmt::print("{}", json_text(frozen_json(about)));
  } else {
    print_frozen(file, runtime.get(), about);
  }
  return kDone;
}

}  // namespace abbe
