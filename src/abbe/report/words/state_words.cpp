#include "abbe/report/words/state_words.h"

#include <nlohmann/json.hpp>

#include "abbe/formats/machine/state_option.h"

namespace abbe {

std::string state_line(const StateValues& at_state) {
  std::string text = at_state.empty() ? std::string() : "errors taken at " + state_words(at_state) + "\n";
  for (const std::string& sentence : at_state.outside) text += "warning: " + sentence + "\n";
  return text;
}

void add_state(const StateValues& at_state, nlohmann::ordered_json& json) {
  for (const auto& [column, value] : at_state) json["at_state"][column] = value;
  if (!at_state.outside.empty()) json["states_outside_measured"] = at_state.outside;
}

}  // namespace abbe
