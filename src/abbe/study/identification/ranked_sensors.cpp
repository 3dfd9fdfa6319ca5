#include "abbe/study/identification/ranked_sensors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "abbe/machine/state.h"
#include "abbe/study/planning/planned_states.h"
#include "abbe/study/planning/planned_terms.h"
#include "abbe/study/study_steps.h"

namespace abbe {
namespace {

using Eigen::Index;
using Sensors = std::vector<std::uint8_t>;  // [sensors] 1: there

/// Held-out residuals of a set of sensors, block by block.
struct OfSensors {
  ModelOfTerms model;
  std::vector<double> lengths;  ///< [blocks] mean square of lengths, mm^2; NaN: none
};

class SensorRanking {
 public:
  SensorRanking(const Study& study, const Campaign& campaign, const Problem& problem, const IdentifyOptions& options)
      : problem_(problem),
        start_(present_values(problem)),
        terms_(planned_terms(study, problem.errors, TermsWanted::all)),
        blocks_(blocks_of_time(study, campaign, "sensors are ranked")),
        models_(problem, candidates(), blocks_, {.identify = options}) {
    std::set<std::size_t> sensors;
    for (const PlannedTerm& term : terms_) {
      for (const std::size_t sensor : sensors_of_state(study.machine, term.state)) sensors.insert(sensor);
    }
    sensors_.assign(sensors.begin(), sensors.end());
    for (const std::size_t sensor : sensors_) names_.push_back(state_column(study.machine.states[sensor]));
    for (const PlannedTerm& term : terms_) needs_.push_back(sensors_of_state(study.machine, term.state));
  }
  ~SensorRanking() { set_observations(problem_, start_); }
  SensorRanking(const SensorRanking&) = delete;
  SensorRanking& operator=(const SensorRanking&) = delete;

  const TermSelection& base() const { return models_.base(); }
  const std::vector<std::size_t>& sensors() const { return sensors_; }
  const std::vector<std::string>& names() const { return names_; }

  OfSensors of(const Sensors& has) {
    Sensors allowed;
    for (const std::vector<std::size_t>& needs : needs_) {
      allowed.push_back(
          std::all_of(needs.begin(), needs.end(),
                      [&](std::size_t sensor) {
                        return has[static_cast<std::size_t>(std::find(sensors_.begin(), sensors_.end(), sensor) -
                                                            sensors_.begin())] != 0;
                      })
              ? 1
              : 0);
    }
    OfSensors result{models_.best_of(allowed), {}};
    for (std::size_t b = 0; b < result.model.squares.size(); ++b) {
      const bool predicted = std::isfinite(result.model.squares[b]);
      result.lengths.push_back(predicted ? squared_lengths(result.model.block[b], result.model.estimates[b])
                                         : std::nan(""));
    }
    result.model.estimates.clear();
    return result;
  }

  /// The figures over the blocks that another set predicts as well.
  HeldOutSensors figures(const Sensors& has, const OfSensors& of, const std::vector<std::uint8_t>& counted) const {
    HeldOutSensors result;
    for (std::size_t s = 0; s < has.size(); ++s) {
      if (has[s] != 0) result.sensors.push_back(s);
    }
    double count = 0, sum = 0, squares = 0, lengths = 0, with_length = 0;
    for (std::size_t b = 0; b < counted.size(); ++b) {
      if (counted[b] == 0) continue;
      count += 1;
      sum += of.model.squares[b];
      squares += of.model.squares[b] * of.model.squares[b];
      if (!std::isfinite(of.lengths[b])) continue;
      lengths += of.lengths[b];
      with_length += 1;
    }
    if (count == 0) return result;
    const double mean = sum / count;
    result.rms = std::sqrt(mean);
    if (count > 1) result.standard_error = std::sqrt(std::max(0.0, squares / count - mean * mean) / (count - 1));
    if (with_length > 0) result.length_rms = std::sqrt(lengths / with_length);
    for (std::size_t c = 0; c < terms_.size(); ++c) {
      if (of.model.selection.levels[c] > 0) result.terms.push_back(terms_[c].term.name);
    }
    return result;
  }

 private:
  std::vector<CandidateTerm> candidates() const {
    std::vector<CandidateTerm> all;
    for (const PlannedTerm& term : terms_) all.push_back(term.term);
    return all;
  }

  double squared_lengths(std::size_t block, const Eigen::VectorXd& estimates) const {
    set_observations(problem_, estimates);
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t o = 0; o < problem_.observations.size(); ++o) {
      const SelectedObservations& selected = problem_.observations[o];
      for (std::size_t k = 0; k < blocks_[o].block.size(); ++k) {
        const bool used = selected.use.empty() || selected.use[k] != 0;
        if (!used || blocks_[o].block[k] != block) continue;
        const std::optional<double> length = selected.observations->length_of_deviation(k);
        if (!length) continue;
        sum += *length * *length;
        ++count;
      }
    }
    return count == 0 ? std::nan("") : sum / static_cast<double>(count);
  }

  const Problem& problem_;
  Eigen::VectorXd start_;
  std::vector<PlannedTerm> terms_;
  std::vector<TimeBlocks> blocks_;
  TermModels models_;
  std::vector<std::size_t> sensors_;               ///< states of the machine
  std::vector<std::string> names_;                 ///< [sensors]
  std::vector<std::vector<std::size_t>> needs_{};  ///< [terms] states of the machine
};

void find_alike(const Study& study, const Campaign& campaign, const std::vector<std::size_t>& sensors,
                RankedSensors& result) {
  std::vector<std::vector<double>> values(sensors.size());
  for (const CampaignSetup& setup : campaign.setups) {
    const std::vector<std::vector<double>>& state = setup.readings.poses.state;
    // A lag has a column of its own, and its channel may have none.
    const bool complete = std::all_of(sensors.begin(), sensors.end(), [&](std::size_t sensor) {
      return sensor < state.size() && state[sensor].size() == setup.readings.count();
    });
    if (!complete) return;
    for (std::size_t s = 0; s < sensors.size(); ++s) {
      values[s].insert(values[s].end(), state[sensors[s]].begin(), state[sensors[s]].end());
    }
  }
  if (values.empty()) return;
  Eigen::MatrixXd course(static_cast<Index>(values.front().size()), static_cast<Index>(values.size()));
  for (std::size_t s = 0; s < values.size(); ++s) {
    for (std::size_t k = 0; k < values[s].size(); ++k)
      course(static_cast<Index>(k), static_cast<Index>(s)) = values[s][k];
    result.courses.push_back(study.machine.states[sensors[s]].name);
  }
  result.alike = like_sensors(course);
}

/// The smallest number whose error is within a standard error of the smallest one.
std::size_t enough_of(const std::vector<HeldOutSensors>& forward) {
  const auto square = [](const HeldOutSensors& one) {
    return std::isfinite(one.rms) ? one.rms * one.rms : std::numeric_limits<double>::infinity();
  };
  const auto best = std::min_element(forward.begin(), forward.end(),
                                     [&](const auto& a, const auto& b) { return square(a) < square(b); });
  std::size_t enough = 0;
  while (square(forward[enough]) > square(*best) + best->standard_error) ++enough;
  return enough;
}

}  // namespace

RankedSensors rank_sensors(const Study& study, const Campaign& campaign, const Problem& problem,
                           const IdentifyOptions& options) {
  SensorRanking ranking(study, campaign, problem, options);
  RankedSensors result;
  result.names = ranking.names();
  result.status = ranking.base().status;
  result.done = ranking.base().done;
  if (!result.done) return result;
  const std::size_t count = result.names.size();
  std::map<Sensors, OfSensors> known;
  const auto of = [&](const Sensors& has) -> const OfSensors& {
    const auto found = known.find(has);
    return found != known.end() ? found->second : known.emplace(has, ranking.of(has)).first->second;
  };
  // Blocks that the largest model and the smallest one predict.
  std::vector<std::uint8_t> counted;
  const OfSensors &all = of(Sensors(count, 1)), &none = of(Sensors(count, 0));
  for (std::size_t b = 0; b < all.model.squares.size(); ++b) {
    const bool both = std::isfinite(all.model.squares[b]) && std::isfinite(none.model.squares[b]);
    counted.push_back(both ? 1 : 0);
    result.blocks += both ? 1U : 0U;
  }
  if (result.blocks < 2) {
    result.done = false;
    result.status = IdentifyStatus::rank_deficient;
    return result;
  }
  const auto figures = [&](const Sensors& has) { return ranking.figures(has, of(has), counted); };
  const SensorSelection order = select_sensors(result.names, [&](const Sensors& has) {
    const HeldOutSensors one = figures(has);
    return std::isfinite(one.rms) ? one.rms : std::numeric_limits<double>::max();
  });
  Sensors has(count, 0);
  result.forward.push_back(figures(has));
  for (const SensorStep& step : order.forward) {
    has[step.sensor] = 1;
    result.forward.push_back(figures(has));
  }
  for (const SensorStep& step : order.without) {
    Sensors others(count, 1);
    others[step.sensor] = 0;
    result.without.push_back(figures(others));
  }
  result.enough = enough_of(result.forward);
  find_alike(study, campaign, ranking.sensors(), result);
  return result;
}

}  // namespace abbe
