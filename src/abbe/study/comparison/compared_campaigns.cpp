#include "abbe/study/comparison/compared_campaigns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "abbe/errors/error_states.h"
#include "abbe/formats/files/file_name.h"
#include "abbe/formats/files/results_files.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/machine/map_file.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/common_states.h"
#include "abbe/study/comparison/compared_errors.h"
#include "abbe/study/comparison/compared_report.h"
#include "abbe/study/comparison/comparison_gauge.h"
#include "abbe/study/comparison/comparison_model.h"
#include "abbe/study/report/results.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

constexpr std::size_t kMostCampaigns = 26;  // they are called A to Z
constexpr double kLargestLevel = 0.5;

/// "march" of "results/march/" and of "march.errors.toml".
std::string name_of_campaign(std::string path) {
  while (path.size() > 1 && path.ends_with('/')) path.pop_back();
  std::string name = file_name(path);
  for (const char* const ending : {".errors.toml", ".toml"}) {
    if (!name.ends_with(ending) || name == ending) continue;
    name.resize(name.size() - std::string(ending).size());
    break;
  }
  return name;
}

void check_request(const CompareRequest& request) {
  if (request.campaigns.size() < 2 || request.campaigns.size() > kMostCampaigns) {
    throw InputError({.field = "campaigns"}, fmt::format("{} to compare", request.campaigns.size()),
                     fmt::format("two to {}: results folders of abbe run, or errors files", kMostCampaigns));
  }
  if (!(request.level > 0 && request.level <= kLargestLevel)) {
    throw InputError({.field = "--level-percent"}, fmt::format("{:g} is no level of a test", 100 * request.level),
                     fmt::format("a percentage above 0, at most {:g}", 100 * kLargestLevel));
  }
}

/// Maps of the change of a pair, of the errors that can be compared: what only one campaign knows, or nobody, is no
/// change.
class ChangeMap {
 public:
  /// @param states  [states] of measured and lag states, where the change is mapped
  ChangeMap(const ComparisonModel& model, const std::vector<double>& states, ComparedPair& pair)
      : machine_(model.machine), states_(states), pair_(pair) {
    errors_.composition = model.errors.composition;
    std::vector<Index> kept;
    for (std::size_t i = 0; i < model.list.size(); ++i) {
      const ModelledError& of = model.list[i];
      const bool is_tool = of.kind == ModelledError::Kind::tool_offset;
      const bool counts = i < pair.errors.size() && is_comparable(pair.errors[i].verdict);
      place_.push_back({static_cast<Index>(kept.size()), counts ? of.size : 0});
      // Every set has a tool offset error.
      if (!counts && !is_tool) continue;
      for (Index k = 0; k < of.size; ++k) kept.push_back(of.first + k);
      add_structure(model, of);
    }
    for (std::size_t c = 0; c < 2; ++c) {
      const CampaignInModel& whole = model.campaigns[c];
      campaigns_[c].values = whole.values(kept);
      if (whole.covariance.size() > 0) campaigns_[c].covariance = whole.covariance(kept, kept);
    }
    if (place_.back().size == 0) take_out_tool();
    if (!has_states(errors_)) return;
    at_state(machine_, errors_, states_, &by_parameters_);
    for (CampaignInModel& campaign : campaigns_) {
      if (campaign.covariance.size() == 0) continue;
      campaign.covariance = (by_parameters_ * campaign.covariance * by_parameters_.transpose()).eval();
    }
  }

  void take_out_tool() {
    campaigns_[1].values.tail(3) = campaigns_[0].values.tail(3);
    for (CampaignInModel& campaign : campaigns_) {
      if (campaign.covariance.size() == 0) continue;
      campaign.covariance.bottomRows(3).setZero();
      campaign.covariance.rightCols(3).setZero();
    }
  }

  void make() {
    if (std::all_of(place_.begin(), place_.end(), [](const Place& place) { return place.size == 0; })) return;
    pair_.partial = partial_errors(machine_, ErrorsFile{.errors = errors_, .covariance = {}, .provenance = {}});
    pair_.stated = stated_grid(machine_, {&errors_});
    const ErrorSet first = errors(campaigns_[0].values), second = errors(campaigns_[1].values);
    const bool stated = campaigns_[0].covariance.size() > 0 && campaigns_[1].covariance.size() > 0;
    pair_.change = mapped(second, first, stated ? &campaigns_[1].covariance : nullptr);
    if (stated) add_uncertainty(mapped(first, second, &campaigns_[0].covariance));
    for (std::size_t i = 0; i < pair_.errors.size(); ++i) {
      if (place_[i].size > 0) pair_.errors[i].at_tool = largest_by(place_[i], first);
    }
  }

 private:
  /// Where the parameters of an error are among those that are kept; size 0: they do not count.
  struct Place {
    Index first = 0, size = 0;
  };

  void add_structure(const ComparisonModel& model, const ModelledError& of) {
    switch (of.kind) {
      case ModelledError::Kind::motion:
        for (const ErrorMotion& term : model.terms(of)) errors_.motions.push_back(term);
        break;
      case ModelledError::Kind::location:
        errors_.locations.push_back({.axis = of.axis, .component = of.component, .state = of.state});
        break;
      case ModelledError::Kind::reversal:
        errors_.reversals.push_back({.axis = of.axis});
        break;
      case ModelledError::Kind::tool_offset:
        break;
    }
  }

  ErrorSet errors(const Eigen::VectorXd& values) const {
    ErrorSet set = errors_;
    set.set_parameters(as_list(values));
    return has_states(errors_) ? at_state(machine_, set, states_) : set;
  }

  ErrorMap mapped(const ErrorSet& actual, const ErrorSet& reference, const Eigen::MatrixXd* covariance) const {
    ErrorMapOptions options;
    options.remove_rigid_motion = true;
    ParameterCovariance parameters;
    if (covariance != nullptr) {
      parameters.covariance = *covariance;
      for (std::size_t p = 0; p < actual.parameter_count(); ++p) parameters.parameters.push_back(p);
      options.covariance = &parameters;
    }
    return error_map(machine_, actual, &reference, pose_source(pair_.stated.poses), options);
  }

  /// Adds the variances of the other campaign: the change seen from there is the same, the other way round.
  void add_uncertainty(const ErrorMap& other) {
    ErrorMap& map = pair_.change;
    const auto add = [](std::vector<double>& to, const std::vector<double>& from) {
      for (std::size_t k = 0; k < to.size(); ++k) to[k] = std::hypot(to[k], from[k]);
    };
    for (std::size_t c = 0; c < map.uncertainty.size(); ++c) add(map.uncertainty[c], other.uncertainty[c]);
    add(map.norm_uncertainty, other.norm_uncertainty);
    std::size_t beyond = 0, all = 0;
    for (std::size_t k = 0; k < map.count(); ++k) {
      pair_.expanded.push_back(2 * std::hypot(map.uncertainty[0][k], map.uncertainty[1][k], map.uncertainty[2][k]));
      if (map.covered[k] == 0) continue;
      ++all;
      if (map.norm[k] > pair_.expanded[k]) ++beyond;
    }
    if (all > 0) pair_.share = static_cast<double>(beyond) / static_cast<double>(all);
  }

  double largest_by(const Place& place, const ErrorSet& first) const {
    Eigen::VectorXd values = campaigns_[0].values;
    values.segment(place.first, place.size) = campaigns_[1].values.segment(place.first, place.size);
    ErrorMapOptions options;
    options.remove_rigid_motion = true;
    options.orientation = false;
    const ErrorMap map = error_map(machine_, errors(values), &first, pose_source(pair_.stated.poses), options);
    return map.statistics.count > 0 ? map.statistics.maximum : 0;
  }

  const Machine& machine_;
  const std::vector<double>& states_;
  ComparedPair& pair_;
  ErrorSet errors_;                // of what counts, at zero
  Eigen::MatrixXd by_parameters_;  // of the errors at the states
  std::vector<Place> place_;
  std::array<CampaignInModel, 2> campaigns_;
};

/// Names of errors that one file does not have, and that are no others in its words.
void take_out_missing(const ComparisonModel& model, ComparedPair& pair) {
  std::vector<ComparedError> kept;
  for (std::size_t i = 0; i < pair.errors.size(); ++i) {
    const ModelledError& of = model.list[i];
    if ((of.is_in[0] && of.is_in[1]) || is_comparable(pair.errors[i].verdict)) {
      kept.push_back(std::move(pair.errors[i]));
    } else {
      (of.is_in[0] ? pair.only_first : pair.only_second).push_back(pair.errors[i].name);
    }
  }
  pair.errors = std::move(kept);
}

ComparedPair compared_pair(const CompareRequest& request, const Machine& machine, const std::vector<double>& states,
                           std::size_t first, std::size_t second) {
  const IdentifiedCampaign &a = request.campaigns[first], &b = request.campaigns[second];
  ComparisonModel model = comparison_model(machine, a, b);
  ComparedPair pair;
  pair.first = first;
  pair.second = second;
  pair.apart = model.apart;
  pair.tools_differ = model.tools_differ;
  GaugeChange gauge = bring_into_one_gauge(a, b, model);
  pair.conventions = std::move(gauge.conventions);
  compare_errors(
      model, {.level = request.level, .curves = request.page || request.curves, .one_gauge = !gauge.is_moved}, pair);
  ChangeMap(model, states, pair).make();
  take_out_missing(model, pair);
  return pair;
}

/// Values of measured and lag states where changes are mapped: as requested, else the references.
std::vector<double> states_of_map(const CompareRequest& request, ComparedCampaigns& result) {
  const Machine& machine = result.machine;
  std::vector<double> values = state_options(machine, "--state", request.states);
  for (const IdentifiedCampaign& campaign : request.campaigns) {
    for (const std::string& sentence : values_outside_covered(machine, campaign.errors, values))
      result.at_state.outside.push_back(campaign.name + ": " + sentence);
  }
  std::vector<std::uint8_t> used(values.size(), 0);
  for (const IdentifiedCampaign& campaign : request.campaigns) {
    const std::vector<std::uint8_t> own = used_states(campaign.machine, campaign.errors.errors);
    for (std::size_t j = 0; j < own.size(); ++j) used[j] = used[j] != 0 || own[j] != 0 ? 1 : 0;
  }
  for (std::size_t j = 0; j < values.size(); ++j) {
    const MachineState& state = machine.states[j];
    if (!is_input(state.kind)) continue;
    if (!std::isfinite(values[j])) values[j] = state.reference;
    if (used[j] != 0) result.at_state.emplace_back(state_column(state), values[j]);
  }
  return values;
}

}  // namespace

void make_names_different(std::vector<IdentifiedCampaign>& campaigns, const std::vector<std::string>& paths) {
  const auto times = [&](const std::string& name) {
    return std::count_if(campaigns.begin(), campaigns.end(), [&](const auto& one) { return one.name == name; });
  };
  std::vector<bool> twice;
  for (const IdentifiedCampaign& campaign : campaigns) twice.push_back(times(campaign.name) > 1);
  for (std::size_t i = 0; i < campaigns.size(); ++i) {
    if (twice[i]) campaigns[i].name = paths[i];
  }
  std::map<std::string, int> seen;
  for (IdentifiedCampaign& campaign : campaigns) {
    const int number = ++seen[campaign.name];
    if (number > 1) campaign.name += fmt::format(" ({})", number);
  }
}

IdentifiedCampaign read_campaign(const std::string& path, const std::optional<Machine>& machine,
                                 StatesOfErrors states) {
  const std::string results = is_results_folder(path) ? path : std::string();
  IdentifiedCampaign campaign;
  campaign.name = name_of_campaign(path);
  campaign.errors_file = results.empty() ? path : file_of_results(results, "errors.toml");
  if (!machine && results.empty()) {
    throw InputError({.field = "--machine"}, "is missing, and " + path + " is not a results folder",
                     "a machine file for campaigns that are errors files, or results folders of abbe run");
  }
  campaign.machine = machine ? *machine : read_machine(file_of_results(results, "machine.toml"));
  campaign.errors = read_errors(campaign.errors_file, campaign.machine, states);
  return campaign;
}

CompareRequest read_campaigns(const std::vector<std::string>& campaigns, const std::string& machine_file) {
  CompareRequest request;
  std::optional<Machine> machine;
  if (!machine_file.empty()) machine = read_machine(machine_file);
  for (const std::string& path : campaigns)
    request.campaigns.push_back(read_campaign(path, machine, StatesOfErrors::allowed));
  make_names_different(request.campaigns, campaigns);
  return request;
}

bool is_comparable(ChangeVerdict verdict) {
  return verdict == ChangeVerdict::changed || verdict == ChangeVerdict::not_significant ||
         verdict == ChangeVerdict::not_known;
}

std::size_t ComparedPair::count(ChangeVerdict verdict) const {
  return static_cast<std::size_t>(
      std::count_if(errors.begin(), errors.end(), [&](const ComparedError& one) { return one.verdict == verdict; }));
}

bool ComparedCampaigns::is_judged() const {
  return std::all_of(pairs.begin(), pairs.end(), [](const ComparedPair& pair) {
    const std::size_t judged = pair.count(ChangeVerdict::changed) + pair.count(ChangeVerdict::not_significant);
    return judged > 0 && pair.count(ChangeVerdict::not_known) == 0 && pair.count(ChangeVerdict::partly) == 0;
  });
}

ComparedCampaigns compare_campaigns(const CompareRequest& given, const JobOptions& options) {
  check_request(given);
  ComparedCampaigns result;
  result.machine = common_machine(given.campaigns);
  const bool any_states = std::any_of(given.campaigns.begin(), given.campaigns.end(),
                                      [](const auto& campaign) { return has_states(campaign.errors.errors); });
  CompareRequest common;
  if (any_states) {
    common = given;
    bring_to_common_states(result.machine, common.campaigns);
  }
  const CompareRequest& request = any_states ? common : given;
  const std::vector<double> states = states_of_map(request, result);
  result.level = request.level;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t k = 0; k < request.campaigns.size(); ++k) {
    result.names.push_back(request.campaigns[k].name);
    if (k > 0) pairs.emplace_back(0, k);
  }
  for (std::size_t k = 2; k < request.campaigns.size(); ++k) pairs.emplace_back(k - 1, k);
  const auto progress = stoppable_progress(options);
  for (const auto& [first, second] : pairs) {
    progress(result.pairs.size(), pairs.size());
    result.pairs.push_back(compared_pair(request, result.machine, states, first, second));
  }
  progress(pairs.size(), pairs.size());
  write_comparison_report(request, result);
  apply_tolerances(request.tolerances, result.report);
  return result;
}

std::vector<std::pair<std::string, std::string>> comparison_files(const ComparedCampaigns& result) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const ComparedPair& pair : result.pairs) {
    if (pair.change.statistics.count == 0) continue;
    MapData data = map_data(result.machine, pair.stated.poses, pair.stated.grid, pair.change, nullptr, &pair.change);
    for (MapField& field : data.fields) {
      if (field.name == "before") field.name = "change";
      if (field.name == "before_rotation") field.name = "change_rotation";
    }
    const std::string name = result.pairs.size() == 1 ? "change" : "change-" + pair_suffix(pair);
    files.emplace_back(name + ".csv", map_csv(data));
    files.emplace_back(name + (map_is_structured(data) ? ".vts" : ".vtu"), map_vtk(data));
  }
  return files;
}

}  // namespace abbe
