#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/study/study_result.h"

namespace abbe {

/// One component of the readings of a set-up: what the report draws as one row of residuals.
struct ResidualComponent {
  std::string name;                ///< as the instrument's users call it: "x", "range", "length"
  std::string unit;                ///< of `residual`: "um" or "urad"
  std::vector<double> normalised;  ///< [readings] whitened, (measured - modelled) / standard uncertainty
  std::vector<double> residual;    ///< [readings] measured - modelled in `unit`
};

/// Components of any instrument at the present point of its observations.
std::vector<ResidualComponent> residual_components(const Observations& observations);

/// The `residuals` section: every set-up with its components, at most about 5000 readings each, all outliers among
/// them.
nlohmann::ordered_json report_residuals(const Machine& machine, const StudyResult& result);

}  // namespace abbe
