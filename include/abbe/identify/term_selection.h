#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "abbe/identify/identify.h"

namespace abbe {

/// A term of the error model that may be left out, or whose order may be lower: an error with a state.
struct CandidateTerm {
  std::string name;                              ///< "EXX*ambient"
  std::vector<std::vector<std::size_t>> levels;  ///< parameters (ErrorSet::parameters()) that every level adds
  std::size_t least = 0;                         ///< levels that are always in the model
};

/// Readings of one set of observations by time: the parts that are held out, each without a break.
struct TimeBlocks {
  std::vector<std::size_t> block;      ///< [readings] its block, from 0 over all sets of observations
  std::vector<std::uint8_t> near;      ///< [readings * blocks] reading * blocks + block: too near to take part in its fit
  std::size_t blocks = 0;              ///< of all sets of observations together
};

/// Divides readings by time into blocks with about as many readings each; readings of one time stay together.
/// @param time_s   per set of observations, [readings]
/// @param blocks   wanted in all; every set has at least two
/// @param gap_s    readings nearer than this to a block take no part in the fit without it
/// @returns per set of observations
std::vector<TimeBlocks> divide_by_time(const std::vector<std::vector<double>>& time_s, std::size_t blocks,
                                       double gap_s);

struct TermSelectionOptions {
  double significance = 0.05;   ///< a term is taken if the held-out error falls with this significance, paired over
                                ///< blocks ...
  double minimum_gain = 0.001;  ///< ... and by at least this relative amount
  IdentifyOptions identify;     ///< least squares
};

/// A term that was taken, in the order taken.
struct TakenTerm {
  std::size_t candidate = 0;
  std::size_t levels = 0;   ///< in the model afterwards
  double before = 0;        ///< root mean square of the held-out residuals, standard uncertainties
  double after = 0;
  double probability = 0;   ///< of so large a fall by chance
};

struct TermSelection {
  bool done = false;                 ///< false: the model without the candidates could not be identified
  IdentifyStatus status = IdentifyStatus::not_run;
  std::vector<std::size_t> levels;   ///< [candidates] chosen
  std::vector<TakenTerm> taken;
  double first_rms = 0, last_rms = 0;  ///< without candidates, and with those taken
  std::size_t blocks = 0;              ///< that could be predicted
  std::size_t left_out = 0;            ///< blocks without which some parameter that they need is not determined
  std::size_t tried = 0;               ///< models
};

/// Takes the term that lowers the held-out error most, as long as one lowers it significantly.
///
/// The model is linear in what the terms add: readings of all blocks give their normal equations once, at the solution
/// without candidates, and every trial is solved from these. A trial costs a few small products, so that many channels
/// can be tried with many errors. Blocks are contiguous in time, because neighbours in a time series share what
/// the model lacks: readings held out at random would be predicted by them and not by the model.
/// @param problem  with all candidates; observations and errors stand where they stood afterwards
TermSelection select_terms(const Problem& problem, const std::vector<CandidateTerm>& candidates,
                           const std::vector<TimeBlocks>& blocks, const TermSelectionOptions& options = {});

}  // namespace abbe
