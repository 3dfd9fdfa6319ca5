#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/history/machine_history.h"

namespace abbe {

std::string history_text(const std::vector<KeptCampaign>& campaigns) {
  std::string text;
  for (const KeptCampaign& one : campaigns) {
    text += fmt::format("{:4}  {}  {}  from {}\n", one.number, date_text(one.measured), one.campaign.name, one.source);
  }
  return text;
}

nlohmann::ordered_json history_json(const std::vector<KeptCampaign>& campaigns) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const KeptCampaign& one : campaigns) {
    json.push_back({{"number", one.number},
                    {"name", one.campaign.name},
                    {"day", date_text(one.measured)},
                    {"source", one.source},
                    {"added", one.added},
                    {"abbe", one.abbe_version}});
  }
  return json;
}

}  // namespace abbe
