#include "abbe/report/words/left_out_words.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "abbe/machine/position_words.h"
#include "abbe/report/evaluations/position_json.h"

namespace abbe {

std::string left_out_text(const Machine& machine, double factor, const LeftOutErrors& left_out, const char* indent) {
  const auto listed = [](const std::vector<std::string>& names) {
    return names.empty() ? std::string("none") : fmt::format("{}", fmt::join(names, ", "));
  };
  std::string text = fmt::format("{}left out, below {:g} standard uncertainties everywhere: {}\n", indent, factor,
                                 listed(left_out.names));
  if (!left_out.kept.empty()) {
    text += fmt::format("{}kept, as they are below it by themselves but not together with others: {}\n", indent,
                        listed(left_out.kept));
  }
  if (left_out.where.empty()) return text;
  return text +
         fmt::format("{}what is left out shifts the functional point by at most {:.3f} um over the travel, at {}\n",
                     indent, 1e3 * left_out.largest_shift, position_words(machine, left_out.where));
}

void state_left_out(const Machine& machine, const LeftOutErrors& left_out, nlohmann::ordered_json& json) {
  json["left_out"] = left_out.names;
  json["left_out_kept"] = left_out.kept;
  json["left_out_largest_um"] = 1e3 * left_out.largest_shift;
  if (!left_out.where.empty()) json["left_out_largest_at"] = position_json(machine, left_out.where);
}

}  // namespace abbe
