#pragma once

#include <array>
#include <string>
#include <vector>

#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/evaluations/differential_expansion.h"
#include "abbe/verify/evaluations/positioning.h"
#include "abbe/verify/evaluations/positioning_uncertainty.h"

namespace abbe {

/// A figure of the evaluation as one of the report, with the reason in words if it was not evaluated.
EvaluationFigure report_figure(const std::string& symbol, const std::string& name, const EvaluatedFigure& figure,
                               bool rotary = false);

/// Readings that were corrected to 20 degC before they were evaluated.
struct PositioningCorrection {
  DifferentialExpansion expansion;
  bool has_machine = false, has_instrument = false;  ///< bodies with a temperature
  BodyTemperatures lowest, highest;                  ///< over the readings
  PositioningEvaluation as_read;
  /// Expanded uncertainties (k = 2) of positioning_figures() by the correction, mm.
  std::array<double, kPositioningFigures> expanded{};
  std::vector<PositioningUncertainty::Contribution> contributions;
};

/// Figures, table of the targets, plot and notes of an axis by ISO 230-2.
/// @param uncertainty  null: none was stated
/// @param correction   of the readings of `evaluation`; null: they are as read
EvaluationReport positioning_report(const PositioningEvaluation& evaluation, bool rotary, const std::string& file,
                                    const PositioningUncertainty* uncertainty,
                                    const PositioningCorrection* correction = nullptr);

/// A requirement of ISO 230-2 on targets and runs that readings do not meet.
struct PositioningShortfall {
  enum class Kind {
    few_runs,      ///< fewest
    uneven_runs,   ///< fewest, most
    few_targets,   ///< wanted, travel with its unit, found
    equal_spacing  ///< no numbers
  };
  Kind kind = Kind::few_runs;
  std::vector<std::string> numbers;  ///< in the order above
};

/// All such requirements, in the order above.
std::vector<PositioningShortfall> positioning_shortfalls(const PositioningEvaluation& evaluation, bool rotary);

/// The same in words; empty if all are met.
std::vector<std::string> positioning_notes(const PositioningEvaluation& evaluation, bool rotary);

/// The target positions for programs: one object each, units in the keys.
nlohmann::ordered_json targets_json(const PositioningEvaluation& evaluation, bool rotary);

}  // namespace abbe
