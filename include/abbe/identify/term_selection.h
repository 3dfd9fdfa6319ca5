#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "abbe/identify/identify.h"
#include "abbe/identify/time_blocks.h"

namespace abbe {

/// A term of the error model that may be left out, or whose order may be lower: an error with a state.
struct CandidateTerm {
  std::string name;                              ///< "EXX*ambient"
  std::vector<std::vector<std::size_t>> levels;  ///< parameters (ErrorSet::parameters()) that every level adds
  std::size_t least = 0;                         ///< levels that are always in the model
};

struct TermSelectionOptions {
  double significance = 0.05;   ///< a term is taken if it is significant beside all that are tried at a time ...
  double minimum_gain = 0.001;  ///< ... and the held-out error falls by at least this relative amount
  IdentifyOptions identify;     ///< least squares
};

/// A term that was taken, in the order taken.
struct TakenTerm {
  std::size_t candidate = 0;
  std::size_t levels = 0;  ///< in the model afterwards
  double before = 0;       ///< root mean square of the held-out residuals, standard uncertainties
  double after = 0;
  double probability = 0;  ///< of so large an effect by chance, of this term alone
};

struct TermSelection {
  bool done = false;  ///< false: the model without the candidates could not be identified
  IdentifyStatus status = IdentifyStatus::not_run;
  std::vector<std::size_t> levels;  ///< [candidates] chosen
  std::vector<TakenTerm> taken;
  double first_rms = 0, last_rms = 0;  ///< without candidates, and with those taken
  std::size_t blocks = 0;              ///< that could be predicted
  std::size_t left_out = 0;            ///< blocks without which some parameter that they need is not determined
  std::size_t tried = 0;               ///< models
};

/// Takes the term that lowers the held-out error most, as long as one does that is significant.
///
/// Significant: Wald's chi-square of the term in the fit to all readings, over the dispersion of the blocks, beyond the
/// quantile of significance / models tried (Bonferroni). The dispersion is that of the scores of the blocks when the
/// term is in the model (Liang and Zeger, Biometrika 73 (1986) 13), at least 1 and at least its median over all that
/// are tried: it counts what makes readings of a block alike. A paired test of the falls of the blocks would not do: an
/// effect of a warm-up is large in few blocks, and falls there only.
/// The model is linear in what the terms add: readings of all blocks give their normal equations once, at the solution
/// without candidates, and every trial is solved from these. A trial costs a few small products, so that many channels
/// can be tried with many errors. Blocks are contiguous in time, because neighbours in a time series share what
/// the model lacks: readings held out at random would be predicted by them and not by the model.
/// @param problem  with all candidates; observations and errors stand where they stood afterwards
TermSelection select_terms(const Problem& problem, const std::vector<CandidateTerm>& candidates,
                           const std::vector<TimeBlocks>& blocks, const TermSelectionOptions& options = {});

/// The best model of some of the terms, and how it predicts.
struct ModelOfTerms {
  TermSelection selection;
  std::vector<double> squares;             ///< [blocks] mean squared residual in variances of the readings; NaN: none
  std::vector<std::size_t> block;          ///< [blocks] its number in TimeBlocks
  std::vector<Eigen::VectorXd> estimates;  ///< [blocks] of the problem, without the readings of the block
};

/// Chooses again and again, with some of the terms left out altogether. Blocks are summed once, at the solution without
/// any of the terms.
class TermModels {
 public:
  /// @param problem  with all candidates; observations and errors stand where they stood afterwards
  TermModels(const Problem& problem, const std::vector<CandidateTerm>& candidates,
             const std::vector<TimeBlocks>& blocks, const TermSelectionOptions& options = {});
  ~TermModels();
  TermModels(const TermModels&) = delete;
  TermModels& operator=(const TermModels&) = delete;

  /// Of the model without any; not done: it could not be identified, and there is nothing to choose from.
  const TermSelection& base() const;
  /// @param allowed  [candidates] 0: not in the model, not even its lowest levels
  ModelOfTerms best_of(const std::vector<std::uint8_t>& allowed);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace abbe
