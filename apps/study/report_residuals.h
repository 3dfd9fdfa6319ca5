#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "study/job.h"

namespace abbe {

/// One component of the readings of a set-up: what the report draws as one row of residuals.
struct ResidualComponent {
  std::string name;                ///< as the instrument's users call it: "x", "range", "radius"
  std::string unit;                ///< of `residual`: "um", "urad", "mm", "deg"; empty: the normalised ones only
  std::vector<double> normalised;  ///< [readings] whitened, (measured - modelled) / standard uncertainty
  std::vector<double> residual;    ///< [readings] measured - modelled in `unit`, or empty
};

/// Components of any instrument from its weighted residuals, without residuals in a unit.
/// @param names  one per row of the observations
std::vector<ResidualComponent> residual_components(const Observations& observations,
                                                   const std::vector<std::string>& names);

/// Components of a laser tracker: x, y, z in its frame, or range and the two directions across the beam; um.
std::vector<ResidualComponent> tracker_components(const TrackerObservations& observations);

/// The `residuals` section: every set-up with its components, at most about 5000 readings each, all outliers among
/// them.
nlohmann::ordered_json report_residuals(const Machine& machine, const StudyResult& result);

}  // namespace abbe
