#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/runtime/abbe_runtime_states.h"

namespace abbe {

/// What a frozen compensation (*.abbec) is for and what was found when it was made; units as in abbe_runtime.h.
struct CheckedFrozenFile {
  std::string file;  ///< its name, for texts
  abbe_runtime_information about{};
  std::vector<abbe_runtime_axis> axes;         ///< chain order
  std::vector<abbe_runtime_channel> channels;  ///< that a controller has to give
  std::vector<abbe_runtime_lag> lags;
};

/// Loads a frozen compensation as a controller does. Opens no file.
/// @param file  name for texts and messages
/// @throws InputError for bytes that a controller would refuse
CheckedFrozenFile check_frozen_file(std::string_view bytes, const std::string& file);

/// For people, as `abbe check` prints it; complete lines.
std::string frozen_file_text(const CheckedFrozenFile& frozen);

/// For programs; units in the keys.
nlohmann::ordered_json frozen_file_json(const CheckedFrozenFile& frozen);

}  // namespace abbe
