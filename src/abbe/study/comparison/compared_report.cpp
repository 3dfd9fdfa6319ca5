#include "abbe/study/comparison/compared_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/machine/state_option.h"
#include "abbe/formats/text/list_text.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/report/evaluations/machine_json.h"
#include "abbe/study/report/report_data.h"

namespace abbe {
namespace {

const char* const kVolumetricChange = "volumetric change";

/// Figures of one pair; with several pairs their symbols end in its letters: "V_max_C_A".
class PairFigures {
 public:
  PairFigures(const ComparedPair& pair, bool is_only_one, EvaluationReport& report)
      : pair_(pair),
        report_(report),
        ending_(is_only_one ? "" : "_" + campaign_letter(pair.second) + "_" + campaign_letter(pair.first)),
        of_(is_only_one ? "" : ", " + pair_words(pair)) {}

  void add() {
    add_counts();
    add_volumetric();
    add_largest(false);
    add_largest(true);
  }

 private:
  EvaluationFigure& figure(const std::string& symbol, const std::string& name) {
    EvaluationFigure figure;
    figure.symbol = symbol + ending_;
    figure.name = name + of_;
    report_.figures.push_back(std::move(figure));
    return report_.figures.back();
  }

  void add_counts() {
    EvaluationFigure& changed = figure("changed", "errors that changed significantly");
    changed.quantity = Quantity::dimensionless;
    changed.unit = "";
    changed.decimals = 0;
    if (pair_.count(ChangeVerdict::changed) + pair_.count(ChangeVerdict::not_significant) > 0) {
      changed.value = static_cast<double>(pair_.count(ChangeVerdict::changed));
    } else {
      changed.missing = "significance is not known";
    }
  }

  void add_volumetric() {
    const SampleStatistics& size = pair_.change.statistics;
    const auto add_one = [&](const char* symbol, const std::string& name, double value) -> EvaluationFigure& {
      EvaluationFigure& one = figure(symbol, name);
      if (size.count > 0) {
        one.value = value;
      } else {
        one.missing = pair_.stated.poses.count() == 0 ? "there is no error to compare" : "no pose is known in both";
      }
      return one;
    };
    add_one("V_mean", fmt::format("{}, mean", kVolumetricChange), size.mean);
    add_one("V_p95", fmt::format("{}, 95 % of the poses below", kVolumetricChange), size.p95);
    EvaluationFigure& largest = add_one("V_max", fmt::format("{}, largest", kVolumetricChange), size.maximum);
    if (size.count > 0 && !pair_.expanded.empty()) largest.uncertainty = pair_.expanded[size.maximum_at];
    EvaluationFigure& share = figure("V_share", "share of the poses where it exceeds its expanded uncertainty");
    share.quantity = Quantity::dimensionless;
    share.unit = "";
    share.decimals = 3;
    share.value = pair_.share;
    if (!pair_.share) share.missing = "uncertainties are not known";
  }

  void add_largest(bool angle) {
    const ComparedError* largest = nullptr;
    for (const ComparedError& error : pair_.errors) {
      if (error.is_angle != angle || !error.per.empty() || !is_comparable(error.verdict)) continue;
      if (largest == nullptr || std::abs(error.change) > std::abs(largest->change)) largest = &error;
    }
    if (largest == nullptr) return;
    EvaluationFigure& one =
        figure(angle ? "angle" : "length",
               fmt::format("largest change of an {}: {}", angle ? "angle" : "error in length", largest->name));
    if (angle) {
      one.quantity = Quantity::angle;
      one.unit = "urad";
    }
    one.value = largest->change;
    one.uncertainty = largest->expanded_uncertainty;
  }

  const ComparedPair& pair_;
  EvaluationReport& report_;
  std::string ending_, of_;
};

bool any_pair(const ComparedCampaigns& result, bool (*fulfils)(const ComparedPair&)) {
  return std::any_of(result.pairs.begin(), result.pairs.end(), fulfils);
}

void add_facts(const CompareRequest& request, ComparedCampaigns& result) {
  EvaluationReport& report = result.report;
  report.facts.emplace_back("machine", fmt::format("{}, {}", result.machine.name, result.machine.chain()));
  for (std::size_t k = 0; k < request.campaigns.size(); ++k) {
    const IdentifiedCampaign& campaign = request.campaigns[k];
    const bool is_file = campaign.errors_file != campaign.name;
    report.facts.emplace_back(campaign_letter(k),
                              campaign.name + (is_file ? " (" + campaign.errors_file + ")" : std::string()));
  }
  for (const ComparedPair& pair : result.pairs) {
    std::string text = changed_words(pair);
    if (pair.chi_square) {
      text += fmt::format("; all together: chi-square {:.1f}, {} degrees of freedom, p {}", *pair.chi_square, pair.rank,
                          pair.probability < 1e-4 ? "< 0.0001" : fmt::format("= {:.4f}", pair.probability));
    }
    report.facts.emplace_back(pair_words(pair), text);
  }
  const ComparedPair& pair = result.pairs.front();
  if (pair.change.statistics.count > 0) report.facts.emplace_back("poses of the map", pair.stated.words);
  if (!result.at_state.empty()) report.facts.emplace_back("state of the map", state_words(result.at_state));
  for (const std::string& sentence : result.at_state.outside) report.notes.push_back(sentence + ".");
}

void add_notes_on_files(const CompareRequest& request, EvaluationReport& report) {
  for (const IdentifiedCampaign& campaign : request.campaigns) {
    const ErrorsFile& file = campaign.errors;
    if (covariance_of(file).size() == 0) {
      report.notes.push_back(campaign.errors_file +
                             " states no uncertainties: changes are stated, their significance is not known.");
    } else if (file.covariance.size() == 0) {
      report.notes.push_back(campaign.errors_file +
                             " states standard uncertainties without correlations: they are taken as independent.");
    }
    for (const std::string& reason : file.distrusted) {
      report.notes.push_back(campaign.errors_file + " is marked as not to be trusted: " + reason + ".");
    }
  }
}

void add_notes_on_travel(const CompareRequest& request, const Machine& machine, EvaluationReport& report) {
  std::string axes;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& common = machine.axes[i];
    const bool differs =
        std::any_of(request.campaigns.begin(), request.campaigns.end(), [&](const IdentifiedCampaign& campaign) {
          const Axis& one = campaign.machine.axes[i];
          return one.travel_min != common.travel_min || one.travel_max != common.travel_max ||
                 one.endless != common.endless;
        });
    if (!differs) continue;
    const double unit = position_unit(common);
    axes += fmt::format("{}{} {:g} to {:g} {}", axes.empty() ? "" : ", ", common.name, common.travel_min / unit,
                        common.travel_max / unit, position_suffix(common));
  }
  if (!axes.empty()) report.notes.push_back("The travels differ; what they have in common counts: " + axes + ".");
}

void add_notes_on_missing_errors(const ComparedCampaigns& result, EvaluationReport& report) {
  std::string before;
  for (const ComparedPair& pair : result.pairs) {
    if (!pair.partial.is_partial() || pair.partial.missing_names() == before) continue;
    before = pair.partial.missing_names();
    report.notes.push_back(
        fmt::format("{}: {} that move the tool against the workpiece are in both campaigns. Changes of the others are "
                    "in no figure: {}.",
                    pair_words(pair), pair.partial.short_words(), before));
  }
}

/// Error motions of which one campaign describes shapes that the other cannot.
void add_notes_on_functions(const ComparedCampaigns& result, EvaluationReport& report) {
  for (const ComparedPair& pair : result.pairs) {
    std::vector<std::string> names;
    for (const ComparedError& error : pair.errors) {
      for (std::size_t c = 0; c < 2; ++c) {
        if (error.beyond[c] == 0) continue;
        names.push_back(fmt::format("{} in {} up to {:.2f} {}", error.name,
                                    campaign_letter(c == 0 ? pair.first : pair.second),
                                    micro_per_unit(error.is_angle) * error.beyond[c], micro_unit(error.is_angle)));
      }
    }
    if (names.empty()) continue;
    report.notes.push_back(
        fmt::format("{}: an error motion with more functions in one campaign is compared in the functions of the "
                    "other. What only one can describe does not count as a change: {}.",
                    pair_words(pair), first_few(names, "; ")));
  }
}

void add_notes_on_gauge(const ComparedCampaigns& result, EvaluationReport& report) {
  for (const ComparedPair& pair : result.pairs) {
    if (!pair.conventions.empty()) {
      report.notes.push_back(fmt::format("{}: the campaigns set different conventions, so these were set for both: {}.",
                                         pair_words(pair), first_few(pair.conventions, "; ")));
    }
    if (pair.count(ChangeVerdict::partly) > 0) {
      report.notes.push_back(fmt::format(
          "{}: a convention sets a part of {} in one campaign and not in the other. These are not judged, and they are "
          "not in the map.",
          pair_words(pair), counted(pair.count(ChangeVerdict::partly), "error", "errors")));
    }
    if (pair.tools_differ) {
      report.notes.push_back(pair_words(pair) +
                             ": the tools differ, so the error of the tool offset is not compared; the map is that of "
                             "the tool of the first campaign.");
    }
  }
}

void add_notes(const CompareRequest& request, ComparedCampaigns& result) {
  EvaluationReport& report = result.report;
  if (any_pair(result, [](const ComparedPair& pair) { return pair.chi_square.has_value(); })) {
    report.notes.push_back(fmt::format(
        "An error has changed where its adjusted probability, p (Holm), is at most {:g} %. So the probability is at "
        "most {:g} % that any error of a pair is reported as changed if none has changed and the uncertainties are "
        "right.",
        100 * result.level, 100 * result.level));
    report.notes.push_back(
        "The campaigns are taken as independent. Uncertainties that they share, such as that of one laser or one "
        "artefact, cancel in a change, which is then known better than stated.");
  }
  report.notes.push_back(
      "A change is stated where its amount is largest over the range; its probability is that of the whole function.");
  add_notes_on_files(request, report);
  add_notes_on_travel(request, result.machine, report);
  add_notes_on_missing_errors(result, report);
  add_notes_on_functions(result, report);
  add_notes_on_gauge(result, report);
}

/// The last pair against the first campaign has the map of the page.
const ComparedPair& pair_of_the_map(const ComparedCampaigns& result) {
  return *std::max_element(result.pairs.begin(), result.pairs.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
}

void add_page(ComparedCampaigns& result) {
  EvaluationReport& report = result.report;
  report.plots = comparison_plots(result);
  const ComparedPair& pair = pair_of_the_map(result);
  report.page = nlohmann::json::object();
  report.page["machine"] = report_machine(result.machine);
  if (pair.change.statistics.count == 0) return;
  nlohmann::json map =
      report_map(result.machine, pair.stated.poses, pair.change, nullptr, &pair.change, pair.stated.words);
  map["quantity"] = fmt::format("{} {}", kVolumetricChange, pair_words(pair));
  report.page["map"] = std::move(map);
}

}  // namespace

void write_comparison_report(const CompareRequest& request, ComparedCampaigns& result) {
  EvaluationReport& report = result.report;
  report.kind = "compare";
  report.title = fmt::format("Changes of {}", result.machine.name);
  report.standard = fmt::format("ISO 230-1 errors; chi-square tests, Holm's procedure at {:g} %", 100 * result.level);
  add_facts(request, result);
  const bool is_only_one = result.pairs.size() == 1;
  for (const ComparedPair& pair : result.pairs) PairFigures(pair, is_only_one, report).add();
  if (!is_only_one) {
    report.tables.push_back(table_against_first(result));
    report.tables.push_back(table_of_drift(result));
  }
  for (const ComparedPair& pair : result.pairs) {
    EvaluationTable changes = table_of_changes(result, pair);
    if (changes.rows.empty()) continue;
    changes.with_figures = changes.in_text = is_only_one;
    report.tables.push_back(std::move(changes));
  }
  for (const ComparedPair& pair : result.pairs) {
    EvaluationTable rest = table_of_the_rest(pair);
    if (!rest.rows.empty()) report.tables.push_back(std::move(rest));
  }
  add_notes(request, result);
  report.details = comparison_details(result);
  if (request.page) add_page(result);
}

}  // namespace abbe
