#include "abbe/identify/term_selection.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "abbe/identify/distributions.h"
#include "abbe/identify/held_out_blocks.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
constexpr double kExactReadings = 1e-6;  // mean squared residual, in variances of the readings: rounding

class TermSearch {
 public:
  /// @param always  lowest levels of the terms in the model at which the blocks are summed
  TermSearch(const Problem& problem, const std::vector<CandidateTerm>& candidates,
             const std::vector<TimeBlocks>& blocks, const TermSelectionOptions& options, bool always)
      : problem_(problem), candidates_(candidates), options_(options), allowed_(candidates.size(), 1) {
    for (const CandidateTerm& candidate : candidates_) result.levels.push_back(always ? candidate.least : 0);
    if (!identify_base()) return;
    blocks_ = std::make_unique<HeldOutBlocks>(problem_, blocks, options_.identify);
    start();
  }

  /// Begins again with the lowest levels of the terms that are allowed, and without the others.
  void begin(const std::vector<std::uint8_t>& allowed) {
    allowed_ = allowed;
    result.taken.clear();
    result.tried = 0;
    result.levels.assign(candidates_.size(), 0);
    present_ = base_;
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      if (allowed_[c] == 0) continue;
      const HeldOutBlocks::Columns first = added(c, candidates_[c].least);
      present_.insert(present_.end(), first.begin(), first.end());
      result.levels[c] = candidates_[c].least;
    }
    start();
  }

  /// Takes the best term, if it is worth it.
  bool take_one() {
    if (blocks_->mean_square() < kExactReadings) return false;
    const std::vector<Trial> trials = tried();
    std::vector<double> dispersions;
    for (const Trial& trial : trials) dispersions.push_back(trial.test.dispersion);
    // The least that all candidates show: what the model lacks makes neighbours alike, whatever is tried.
    const double common = dispersions.empty() ? 1 : middle(std::move(dispersions));
    const Trial* best = nullptr;
    double best_probability = 1;
    for (const Trial& trial : trials) {
      if (trial.gain < options_.minimum_gain * blocks_->mean_square() || (best != nullptr && trial.gain <= best->gain))
        continue;
      const double probability = chi_square_exceedance(trial.test.wald / std::max({1.0, common, trial.test.dispersion}),
                                                       static_cast<double>(trial.columns.size()));
      if (probability * static_cast<double>(trials.size()) >= options_.significance) continue;
      // A lower order that would do as well comes first.
      if (best != nullptr && best->candidate == trial.candidate) continue;
      best = &trial;
      best_probability = probability;
    }
    if (best == nullptr) return false;
    const double before = std::sqrt(blocks_->mean_square());
    present_.insert(present_.end(), best->columns.begin(), best->columns.end());
    result.levels[best->candidate] = best->levels;
    predict();
    result.taken.push_back({best->candidate, best->levels, before, result.last_rms, best_probability});
    return true;
  }

  const HeldOutBlocks& held_out() const { return *blocks_; }

  TermSelection result;

 private:
  /// A candidate with one or two more levels.
  struct Trial {
    std::size_t candidate = 0, levels = 0;
    HeldOutBlocks::Columns columns;
    double gain = 0;  ///< fall of the mean squared residual of held-out blocks
    TermTest test;
  };

  void start() {
    predict();
    result.first_rms = result.last_rms;
    result.done = result.blocks > 0;
    if (!result.done) result.status = IdentifyStatus::rank_deficient;
  }

  static double middle(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
  }

  std::vector<Trial> tried() {
    std::vector<Trial> trials;
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      if (allowed_[c] == 0) continue;
      // By two levels too: an even dependence may need the second and not the first.
      for (std::size_t more = 1; more <= 2 && result.levels[c] + more <= candidates_[c].levels.size(); ++more) {
        Trial trial{.candidate = c, .levels = result.levels[c] + more, .columns = {}, .test = {}};
        trial.columns = added(c, trial.levels);
        ++result.tried;
        const std::vector<double> gains = blocks_->gains_of(trial.columns);
        if (gains.empty()) continue;
        const std::optional<TermTest> test = blocks_->test(trial.columns);
        if (!test) continue;
        trial.test = *test;
        trial.gain = mean(gains);
        trials.push_back(std::move(trial));
      }
    }
    return trials;
  }

  static double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  }

  bool in_model(std::size_t parameter) const {
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      for (std::size_t l = result.levels[c]; l < candidates_[c].levels.size(); ++l) {
        const std::vector<std::size_t>& level = candidates_[c].levels[l];
        if (std::find(level.begin(), level.end(), parameter) != level.end()) return false;
      }
    }
    return true;
  }

  /// Columns that a candidate adds to reach this many levels.
  HeldOutBlocks::Columns added(std::size_t candidate, std::size_t levels) const {
    HeldOutBlocks::Columns columns;
    for (std::size_t l = result.levels[candidate]; l < levels; ++l) {
      for (const std::size_t parameter : candidates_[candidate].levels[l]) {
        columns.push_back(static_cast<Index>(find_estimated(problem_, {ParameterId::kMachine, parameter})));
      }
    }
    return columns;
  }

  bool identify_base() {
    std::vector<double> values = problem_.errors.parameters();
    Problem base = problem_;
    base.machine_parameters.clear();
    for (const std::size_t parameter : problem_.machine_parameters) {
      if (in_model(parameter)) {
        base.machine_parameters.push_back(parameter);
      } else {
        values[parameter] = 0;
      }
    }
    base.errors.set_parameters(values);
    problem_.errors.set_parameters(values);
    const Identification identified = identify(base, options_.identify);
    result.status = identified.status;
    if (identified.status != IdentifyStatus::converged) return false;
    problem_.errors = base.errors;
    for (std::size_t i = 0; i < base.machine_parameters.size(); ++i) {
      present_.push_back(
          static_cast<Index>(find_estimated(problem_, {ParameterId::kMachine, base.machine_parameters[i]})));
    }
    for (std::size_t i = problem_.machine_parameters.size(); i < estimated_count(problem_); ++i) {
      present_.push_back(static_cast<Index>(i));
    }
    base_ = present_;
    return true;
  }

  void predict() {
    blocks_->set_present(present_);
    result.blocks = blocks_->predicted();
    result.left_out = blocks_->count() - result.blocks;
    result.last_rms = std::sqrt(blocks_->mean_square());
  }

  Problem problem_;
  std::vector<CandidateTerm> candidates_;
  TermSelectionOptions options_;
  std::vector<std::uint8_t> allowed_;      // [candidates]
  HeldOutBlocks::Columns present_, base_;  // parameters of the model so far, and without candidates
  std::unique_ptr<HeldOutBlocks> blocks_;
};

}  // namespace

TermSelection select_terms(const Problem& problem, const std::vector<CandidateTerm>& candidates,
                           const std::vector<TimeBlocks>& blocks, const TermSelectionOptions& options) {
  const Eigen::VectorXd start = present_values(problem);
  TermSearch search(problem, candidates, blocks, options, true);
  while (search.result.done && search.take_one()) {
  }
  set_observations(problem, start);
  return search.result;
}

struct TermModels::Implementation {
  TermSearch search;
  TermSelection base;
};

TermModels::TermModels(const Problem& problem, const std::vector<CandidateTerm>& candidates,
                       const std::vector<TimeBlocks>& blocks, const TermSelectionOptions& options) {
  const Eigen::VectorXd start = present_values(problem);
  implementation_.reset(new Implementation{TermSearch(problem, candidates, blocks, options, false), {}});
  implementation_->base = implementation_->search.result;
  set_observations(problem, start);
}

TermModels::~TermModels() = default;

const TermSelection& TermModels::base() const { return implementation_->base; }

ModelOfTerms TermModels::best_of(const std::vector<std::uint8_t>& allowed) {
  TermSearch& search = implementation_->search;
  if (!base().done) return {};
  search.begin(allowed);
  while (search.result.done && search.take_one()) {
  }
  ModelOfTerms model{search.result, search.held_out().squares(), {}, {}};
  for (std::size_t b = 0; b < model.squares.size(); ++b) {
    model.block.push_back(search.held_out().number_of(b));
    model.estimates.push_back(search.held_out().estimates_without(b));
  }
  return model;
}

}  // namespace abbe
