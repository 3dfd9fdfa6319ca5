#pragma once

// Internal to study: two campaigns in one gauge.
#include <string>
#include <vector>

#include "abbe/study/comparison/comparison_model.h"

namespace abbe {

/// What was done to bring two campaigns into one gauge.
struct GaugeChange {
  bool is_moved = false;                 ///< anything was
  std::vector<std::string> conventions;  ///< equations that were set for both, in words
};

/// Brings the errors of both campaigns into one gauge, to first order: an S-transformation of values and covariances.
///
/// Some errors of a machine differ in words only: a slope of the straightness of Y is a squareness, a constant error of
/// an axis is another place of the workpiece. Such directions change no pose of the tool in the workpiece, but for one
/// rigid motion of the workpiece and one of the tool, which their users set up. A convention decides where a campaign
/// did not. Campaigns with other instruments or ranges can have other conventions, and their difference is then no
/// change of the machine. If both have set the same combinations to the same values, nothing is done. Else every such
/// direction that one of them has set by a convention is fixed for both by the conventions of docs/conventions.md over
/// the range in common. A direction that both have determined stays as it is.
///
/// Nothing is done either if one of them states no covariance: what it has set cannot be known.
/// Source: W. Baarda, S-transformations and criterion matrices (1973); P. Teunissen, Zero order design (1985).
GaugeChange bring_into_one_gauge(const IdentifiedCampaign& first, const IdentifiedCampaign& second,
                                 ComparisonModel& model);

}  // namespace abbe
