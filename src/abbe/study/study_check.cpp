#include "abbe/study/study_check.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/formats/text/list_text.h"
#include "abbe/study/customer/customer_study.h"

namespace abbe {

bool StudyCheck::is_explained() const { return campaign.is_explained(); }

std::size_t StudyCheck::judged_places() const {
  std::size_t places = 0;
  for (const CampaignSetup& setup : campaign.setups) places += setup.judged_places;
  return places;
}

StudyCheck check_study(const Study& study, const JobOptions& options) {
  check_customer_report(study);
  StudyCheck check{gather_readings(study, options)};
  stop_if_asked(options.stop);
  find_start_values(study.machine, check.campaign);
  return check;
}

std::string study_check_text(const Study& study, const StudyCheck& check) {
  std::string text = fmt::format("{}: {}   ({})\n", study.name, study.machine.name, study.machine.chain());
  const char* const kind = check.campaign.truth ? "simulated " : "";
  for (const CampaignSetup& setup : check.campaign.setups) {
    text += fmt::format("{} ({}): {}{}\n", setup.name, setup.instrument, kind,
                        counted(setup.reading_count(), "reading", "readings"));
  }
  for (const std::string& warning : check.campaign.warnings) text += fmt::format("warning: {}\n", warning);
  if (check.judged_places() == 0) {
    text += "no pose of a tracker is found from enough readings: they cannot be checked against the nominal machine\n";
  } else if (check.is_explained()) {
    text += "the nominal machine explains the readings of all stations that can be checked\n";
  }
  return text;
}

nlohmann::ordered_json study_check_json(const Study& study, const StudyCheck& check) {
  nlohmann::ordered_json json = {{"study", study.name}, {"machine", study.machine.name}};
  json["simulated"] = check.campaign.truth.has_value();
  json["setups"] = nlohmann::ordered_json::array();
  for (const CampaignSetup& setup : check.campaign.setups) {
    nlohmann::ordered_json one = {{"name", setup.name}, {"instrument", setup.instrument}};
    one["readings"] = setup.reading_count();
    one["judged_places"] = setup.judged_places;
    one["unexplained"] = nlohmann::ordered_json::array();
    for (const UnexplainedReadings& place : setup.unexplained) {
      one["unexplained"].push_back({{"place", place.place},
                                    {"share", place.share},
                                    {"causes", place.causes},
                                    {"rms_mm_without", place.mended_rms_mm}});
    }
    json["setups"].push_back(std::move(one));
  }
  json["warnings"] = check.campaign.warnings;
  json["explained"] = check.is_explained();
  return json;
}

}  // namespace abbe
