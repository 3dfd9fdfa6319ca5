#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace abbe {

/// JSON text with two spaces of indentation, keys in their order, numbers as shortest decimals, short arrays of numbers
/// on one line. The same value gives the same bytes. @throws NotFinite
std::string json_text(const nlohmann::ordered_json& value);

}  // namespace abbe
