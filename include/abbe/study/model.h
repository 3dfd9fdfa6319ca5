#pragma once

#include <memory>
#include <string>
#include <vector>

#include "abbe/identify/order_selection.h"
#include "abbe/identify/problem.h"
#include "abbe/study/campaign.h"
#include "abbe/study/report/coverage.h"

namespace abbe {

/// The identification problem of a study: the model's errors, the observations and what is estimated.
struct StudyModel {
  Problem problem;                       ///< its observations: one per set-up
  std::vector<OrderGroup> order_groups;  ///< for the automatic choice of orders, if the study asks for it
  std::vector<AxisCoverage> coverage;    ///< one for each axis whose error motions are known over a range
  std::string impossible;                ///< not empty: why nothing can be identified, in words
};

/// Error motions and location errors to be identified, at their start values. The range of every error motion is
/// narrowed to the positions that were measured and the margin beside them (stated_range()), because an error motion is
/// not known where nothing was measured.
ErrorSet model_errors(const Study& study, const Campaign& campaign, StudyModel& model);

/// Builds observations and problem; readings that are held out are marked in problem.observations[].use.
StudyModel build_model(const Study& study, const Campaign& campaign);

/// The same with orders chosen per group of `groups` (those of the model with the highest orders): splines and tables
/// get that many intervals, of polynomials and Fourier series only the lower coefficients are estimated.
StudyModel build_model_at(const Study& study, const Campaign& campaign, const std::vector<OrderGroup>& groups,
                          const std::vector<int>& orders);

/// Chooses the orders of model.order_groups by held-out poses; the model is then that with the chosen orders.
OrderSelection select_model(const Study& study, const Campaign& campaign, const OrderSelectionOptions& options,
                            StudyModel& model);

}  // namespace abbe
