#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/formats/study/study.h"
#include "abbe/identify/identify.h"
#include "abbe/identify/problem.h"
#include "abbe/study/study_result.h"

namespace abbe {

/// An expansion of a study among the parameters of its model.
struct ExpansionParameters {
  const IdentifiedMotion* identified = nullptr;
  std::size_t motion = 0;       ///< index into ErrorSet::motions
  std::size_t coefficient = 0;  ///< index into ErrorSet::parameters(), of its second function; the first is before it
};

/// Those of a plan that are in a model. The plan has to outlive the result.
std::vector<ExpansionParameters> expansion_parameters(const IdentificationPlan& plan, const ErrorSet& errors);

/// 1 for parameters of expansions, [parameters]: their priors are those of the expansions alone.
std::vector<std::uint8_t> are_of_expansions(const IdentificationPlan& plan, const ErrorSet& errors);

/// Takes out of the estimates what is no part of an expansion, and coefficients that are known exactly.
void keep_expansion_estimates(const IdentificationPlan& plan, Problem& problem);

/// Adds what is known of the coefficients within an uncertainty.
void add_expansion_priors(const IdentificationPlan& plan, Problem& problem);

/// Whether nothing of a state but expansions is identified, each with some knowledge of its coefficient.
bool has_known_expansions_only(const IdentificationPlan& plan, std::size_t state);

/// Appends to true errors that were drawn the expansions of the study.
void add_true_expansions(const Study& study, std::uint64_t seed, ErrorSet& errors);

/// An expansion as it was identified.
struct FoundExpansion {
  std::string axis, state;
  double coefficient = 0;           ///< 1/K
  double expanded_uncertainty = 0;  ///< k = 2, 1/K; 0: known exactly, or by a convention
  double fixed_point = 0;           ///< mm
  SetupNumber stated;               ///< before the readings, 1/K
  bool is_fixed = false;            ///< by a convention of the gauge
  std::string correlated;           ///< parameter with which it is correlated most; empty: none
  double correlation = 0;
};

/// @param plan  of the terms that were identified
std::vector<FoundExpansion> found_expansions(const Study& study, const StudyResult& result);

}  // namespace abbe
