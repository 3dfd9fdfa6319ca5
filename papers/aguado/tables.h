#pragma once

#include <string>
#include <vector>

#include "aguado/study.h"
#include "reproduce_output.h"

namespace abbe {

/// Which of the paper's experiments a fit belongs to.
enum class AguadoExperiment { table_1, table_2, table_3, strategy };

/// A model fitted to simulated readings of the reference machine.
struct AguadoRow {
  AguadoExperiment experiment = AguadoExperiment::table_3;
  std::string model;
  int order = 0;          ///< of the polynomials of X and Z; 0: they are no part of the comparison of orders
  bool as_paper = false;  ///< the model as far as the paper states it
  bool constant = true;   ///< C has constant terms
  AguadoFit fit;

  double percent_left() const { return 100 * fit.residual.mean / fit.initial.mean; }
  double percent_left_unseen() const { return 100 * fit.unseen.mean / fit.unseen_before.mean; }
};

/// What the paper prints: Tables 1 to 3, um and per cent.
struct AguadoPublished {
  const char* name;
  double initial_mean, initial_largest, final_mean, final_largest, percent;
};
inline constexpr AguadoPublished kAguadoPublished[3] = {{"Table 1", 194.91, 213.46, 112.57, 186.06, 57.75},
                                                        {"Table 2", 598.48, 978.03, 122.38, 347.72, 21.01},
                                                        {"Table 3", 555.84, 987.67, 114.11, 247.98, 20.53}};

/// Noise of the tracker in all of them: 10 um + 5 um/m.
TrackerNoise aguado_noise();

/// The experiments of Tables 1 to 3 and the strategies of section 4, in this order.
std::vector<AguadoRow> aguado_rows(const AguadoTruth& truth, int threads);

/// Tables 1 to 3 in um, what Table 1 determines, and the strategies.
/// @param truth  errors of the reference machine
std::vector<ReproducedTable> aguado_tables(const std::vector<AguadoRow>& rows, const ErrorSet& truth);
std::vector<PublishedNumber> aguado_published(const std::vector<AguadoRow>& rows);

/// Sentences that follow from the rows, whatever they are.
std::vector<std::string> aguado_conclusions(const std::vector<AguadoRow>& rows);

/// Figures 6 and 7: volumetric error over the workspace before and after, as histograms and as maps over X and Z.
struct AguadoFigures {
  std::vector<EvaluationPlot> plots;
  SampleStatistics before, as_paper, complete;  ///< of Figure 6, mm
};
AguadoFigures aguado_figures(const AguadoTruth& truth, const std::vector<AguadoRow>& rows);

}  // namespace abbe
