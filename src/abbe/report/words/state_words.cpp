#include "abbe/report/words/state_words.h"

#include <nlohmann/json.hpp>

#include "abbe/formats/machine/state_option.h"

namespace abbe {

std::string state_line(const StateValues& at_state) {
  return at_state.empty() ? std::string() : "errors taken at " + state_words(at_state) + "\n";
}

void add_state(const StateValues& at_state, nlohmann::ordered_json& json) {
  for (const auto& [column, value] : at_state) json["at_state"][column] = value;
}

}  // namespace abbe
