#pragma once

// The steps of a study. run_study() does them in order; each adds to the result.
#include <stop_token>
#include <vector>

#include "abbe/study/study_result.h"

namespace abbe {

/// Options of the solver as the study states them.
IdentifyOptions identify_options(const Study& study);

/// Options of an identification, besides its study; as in RunOptions.
struct IdentificationJob {
  ProgressCallback progress{};
  std::stop_token stop{};
  Summation summation{};
  WorkDriver work{};
  bool advice = true;
};

/// The identification of a study from its readings, with the volumetric error that it predicts; no map.
/// @throws Stopped if it was asked for; SumError if what the summation gives is refused
void identify_study(const Study& study, StudyResult& result, const IdentificationJob& job = {});

/// The readings that identify_study() identifies, with their model, in `result.model`: what another process needs to
/// sum pieces of them (PieceSummer). Where the study chooses orders, the model is that of the largest ones.
void prepare_study(const Study& study, StudyResult& result);

/// Reads or simulates the readings of a study, and prepares it: the problem of another process.
/// @pre the study identifies
Problem prepared_problem(const Study& study);

/// Figures of the volumetric error over the grid that all commands state (docs/conventions.md).
VolumetricFigures study_volumetric_figures(const Study& study, const StudyResult& result);

/// Map of the study's plan, or of 7 positions per axis over the known range.
/// @param work  as in RunOptions
StudyMap map_study(const Study& study, const StudyResult& result, const ProgressCallback& progress = {},
                   const WorkDriver& work = {});

}  // namespace abbe
