#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "abbe/identify/identify.h"

namespace abbe {

/// What one reading says about the axes: which of them stand where they stand in most readings of their group.
enum class ReadingClass {
  linear_moves,  ///< all rotary axes stand at their reference
  rotary_moves,  ///< all linear axes stand at one common position
  both_move
};

/// Class of every reading of one set of observations.
///
/// The rotary axes' reference is the commonest combination of their positions, the linear axes' likewise (to 1e-6 mm or
/// rad). Readings with both at the reference count as linear_moves.
std::vector<ReadingClass> classify_readings(const Machine& machine, const Observations& observations);

enum class Strategy {
  joint,        ///< everything from all readings
  independent,  ///< linear axes from linear_moves, then rotary axes from rotary_moves with the linear ones fixed
  combined  ///< linear axes from linear_moves, then everything from all other readings, with the first result and its
            ///< full information as joint prior
};

/// One step: which readings, which of the problem's estimated parameters.
struct Stage {
  std::string name;
  std::vector<std::vector<std::uint8_t>> use;      ///< per observations, per reading
  std::vector<std::size_t> machine_parameters;     ///< subset of Problem::machine_parameters
  std::vector<std::vector<std::size_t>> unknowns;  ///< per observations, subset of its selected unknowns
  bool with_joint_prior = false;                   ///< the stage before enters with its information
};

/// Stages of a strategy. Source: Aguado et al., section 4, with the automatic classification above.
std::vector<Stage> plan_stages(const Problem& problem, Strategy strategy);

struct StagedIdentification {
  std::vector<Identification> stages;  ///< one per stage; the last holds the estimates of its own parameters
  Identification total;                ///< all estimated parameters, with the covariance carried forward
};

/// Runs the stages one after the other. For joint this is identify().
///
/// independent: the second stage takes the first stage's estimates (errors of the linear axes, set-up) as fixed and
/// passes their uncertainty on: Cov = Cov(later | earlier) + S Cov_earlier S', S = -Z (Z'HZ)^-1 Z'H_le the sensitivity
/// of the later estimates to the earlier ones (GUM 5.2). Set-up unknowns of observations without linear_moves readings
/// are estimated in the second stage. Status and message of `total` are those of the first stage whose status is not
/// converged; `total.converged` says whether every stage has reached a minimum.
StagedIdentification identify_in_stages(Problem& problem, Strategy strategy, const IdentifyOptions& options = {});

}  // namespace abbe
