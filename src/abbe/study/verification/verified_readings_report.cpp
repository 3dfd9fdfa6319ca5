#include "abbe/study/verification/verified_readings_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/formats/text/list_text.h"
#include "abbe/report/drawings/svg_plot.h"
#include "abbe/report/evaluations/machine_json.h"
#include "abbe/report/evaluations/statistics_json.h"

namespace abbe {
namespace {

constexpr std::size_t kMostDrawn = 1500;  // points of a plot

EvaluationFigure& add_figure(EvaluationReport& report, const std::string& symbol, const std::string& name) {
  EvaluationFigure figure;
  figure.symbol = symbol;
  figure.name = name;
  report.figures.push_back(std::move(figure));
  return report.figures.back();
}

void add_number(EvaluationReport& report, const char* symbol, const std::string& name, int decimals,
                std::optional<double> value, const char* missing) {
  EvaluationFigure& figure = add_figure(report, symbol, name);
  figure.quantity = Quantity::dimensionless;
  figure.unit = "";
  figure.decimals = decimals;
  figure.value = value;
  if (!value) figure.missing = missing;
}

void add_statistics(EvaluationReport& report, const std::string& when, const std::string& of,
                    const SampleStatistics& statistics) {
  const auto add = [&](const char* ending, const std::string& name, double value) {
    EvaluationFigure& figure = add_figure(report, when + ending, name + ", " + of);
    if (statistics.count > 0) {
      figure.value = value;
    } else {
      figure.missing = "only angles are read";
    }
  };
  add("_mean", "mean residual", statistics.mean);
  add("_p95", "95 % of the residuals below", statistics.p95);
  add("_max", "largest residual", statistics.maximum);
}

std::string micro_text_of(double mm) { return fmt::format("{:.2f}", 1e3 * mm); }

/// A row for each station, reflector, run or other label of the set-ups.
EvaluationTable table_of_labels(const Campaign& campaign, const std::vector<SetupResiduals>& residuals) {
  EvaluationTable table;
  table.caption = "Residuals in \xC2\xB5m by what the readings were taken with";
  table.headers = {"set-up", "readings of", "readings", "mean before", "mean after", "95 % after", "largest after"};
  const auto add = [&](const std::string& setup, const std::string& name, const std::vector<double>& before,
                       const std::vector<double>& after) {
    if (after.empty()) return;
    const SampleStatistics b = sample_statistics(before), a = sample_statistics(after);
    table.rows.push_back({setup, name, fmt::format("{}", a.count), micro_text_of(b.mean), micro_text_of(a.mean),
                          micro_text_of(a.p95), micro_text_of(a.maximum)});
  };
  for (std::size_t s = 0; s < campaign.setups.size(); ++s) {
    const CampaignSetup& setup = campaign.setups[s];
    const auto chosen = [&](const auto& fulfils, const std::vector<double>& lengths) {
      std::vector<double> result;
      for (std::size_t k = 0; k < lengths.size(); ++k) {
        if (lengths[k] >= 0 && fulfils(k)) result.push_back(lengths[k]);
      }
      return result;
    };
    const auto all = [](std::size_t) { return true; };
    add(setup.name, "all", chosen(all, residuals[s].before), chosen(all, residuals[s].after));
    for (const ReadingLabel& label : setup.facts().labels) {
      if (label.names.size() < 2) continue;
      for (std::size_t i = 0; i < label.names.size(); ++i) {
        const auto is_this = [&](std::size_t k) { return label.of_reading[k] == i; };
        add(setup.name, label.kind + " " + label.names[i], chosen(is_this, residuals[s].before),
            chosen(is_this, residuals[s].after));
      }
    }
  }
  table.with_figures = table.in_text = true;
  return table;
}

EvaluationPlot plot_of(const VerifiedReadings& result) {
  XyPlot plot("Residuals of the readings", "reading", "residual in \xC2\xB5m");
  const std::size_t count = result.after.size(), drawn = std::min(count, kMostDrawn);
  std::vector<PlotPoint> before, after;
  for (std::size_t i = 0; i < drawn; ++i) {
    const std::size_t k = i * count / drawn;
    before.push_back({static_cast<double>(k), 1e3 * result.before[k]});
    after.push_back({static_cast<double>(k), 1e3 * result.after[k]});
  }
  plot.include_y(0);
  plot.points(std::move(before), Marker::circle, {PlotColour::second}, "nominal machine");
  plot.points(std::move(after), Marker::circle, {PlotColour::first}, "with the identified errors");
  return {"residuals", "Length of measured less modelled, the set-ups fitted", plot.picture(), false, false};
}

nlohmann::ordered_json details_of(const VerifiedReadings& result) {
  const IndependentReadings& judged = result.judged;
  nlohmann::ordered_json json = {{"readings", result.readings}, {"not_covered", result.not_covered}};
  if (!result.after.empty()) {
    json["before_um"] = statistics_um(result.before_statistics);
    json["after_um"] = statistics_um(result.after_statistics);
  }
  json["chi_square"] = judged.chi_square;
  json["degrees_of_freedom"] = judged.degrees_of_freedom;
  json["probability"] = judged.p_value;
  json["components"] = judged.components;
  json["components_within"] = judged.components_within;
  json["uncertainties_of_errors_known"] = result.uncertainties_known;
  json["verdicts"] = nlohmann::ordered_json::array();
  for (const ReadingsVerdict& verdict : result.verdicts) {
    json["verdicts"].push_back({{"name", verdict.name}, {"text", verdict.text}, {"met", verdict.met}});
  }
  json["warnings"] = result.warnings;
  return json;
}

}  // namespace

void write_readings_report(const ReadingsToVerify& request, const Campaign& campaign, VerifiedReadings& result) {
  EvaluationReport& report = result.report;
  const Study& study = request.study;
  report.kind = "readings";
  report.title = fmt::format("Readings of {} against identified errors", study.name);
  report.standard = "chi-square test; uncertainties of the readings and of the errors (GUM)";
  report.facts.emplace_back("machine", fmt::format("{}, {}", study.machine.name, study.machine.chain()));
  report.facts.emplace_back(
      "errors", fmt::format("{}, {}", request.errors_file,
                            counted(request.identified.errors.parameter_count(), "parameter", "parameters")));
  std::string readings = counted(result.readings, campaign.truth ? "simulated reading" : "reading",
                                 campaign.truth ? "simulated readings" : "readings");
  if (result.not_covered > 0)
    readings += fmt::format(", {} left out where the errors are not known", result.not_covered);
  report.facts.emplace_back("readings", readings);
  for (const ReadingsVerdict& verdict : result.verdicts) report.facts.emplace_back(verdict.name, verdict.text);

  add_statistics(report, "before", "nominal machine", result.before_statistics);
  add_statistics(report, "after", "with the identified errors", result.after_statistics);
  const IndependentReadings& judged = result.judged;
  const bool has_lengths = !result.after.empty();
  add_number(report, "reduction", "mean residual before over after", 2,
             has_lengths ? std::optional<double>(result.reduction()) : std::nullopt, "only angles are read");
  add_number(report, "within", "share of the numbers read within their expanded uncertainty (0.954 expected)", 3,
             judged.components > 0 ? std::optional<double>(static_cast<double>(judged.components_within) /
                                                           static_cast<double>(judged.components))
                                   : std::nullopt,
             "the fit of the set-ups reproduces every number");
  add_number(report, "ratio", "what is left over what the uncertainties explain, root mean square", 3,
             judged.degrees_of_freedom > 0 ? std::optional<double>(result.ratio()) : std::nullopt,
             "there are no more readings than unknowns of the set-ups");
  if (has_lengths) {
    report.tables.push_back(table_of_labels(campaign, result.setups));
    report.plots.push_back(plot_of(result));
  }
  report.notes.push_back(
      "Where the instruments stood, and what else the study leaves open of the set-ups, is fitted to these readings, "
      "for both machines. So a rigid displacement of the workpiece is in no residual.");
  if (!result.uncertainties_known) {
    report.notes.push_back(request.errors_file + " states no uncertainties: only those of the readings count.");
  } else if (request.identified.covariance.size() == 0) {
    report.notes.push_back(request.errors_file +
                           " states standard uncertainties without correlations: they are taken as independent.");
  }
  for (const std::string& reason : request.identified.distrusted) {
    report.notes.push_back(request.errors_file + " is marked as not to be trusted: " + reason + ".");
  }
  for (const std::string& warning : result.warnings) report.notes.push_back(warning + ".");
  report.details = details_of(result);
  report.page = nlohmann::json::object();
  report.page["machine"] = report_machine(study.machine);
}

}  // namespace abbe
