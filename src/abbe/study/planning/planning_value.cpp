// What planned readings are worth with the knowledge that one always has, and what they leave open.
#include <algorithm>
#include <cmath>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/singular_values.h"
#include "abbe/study/planning/planning.h"

namespace abbe {
namespace {

using Eigen::Index;
constexpr std::size_t kMostNamed = 8;
constexpr double kEqualShare = 1e-6;

}  // namespace

double uncertainty_with_prior(const PlanningModel& model, const PlanningCandidates::Rows& rows,
                              const Eigen::MatrixXd& predictions) {
  Eigen::MatrixXd information = model.weak_prior() + model.known().transpose() * model.known();
  information.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  // Scaled, for lengths and angles differ by orders of magnitude.
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();  // the lower half counts
  const Cholesky factor(scaled);
  const Eigen::MatrixXd half = factor.half_solve(scale.asDiagonal() * predictions.transpose());
  return std::sqrt(half.squaredNorm() / (static_cast<double>(predictions.rows()) / 3));
}

std::string open_errors(const PlanningModel& model, const PlanningSpace& space, const PlanningCandidates::Rows& rows,
                        std::size_t rank) {
  const Index v = static_cast<Index>(space.dimension()), open = v - static_cast<Index>(rank);
  const RightSingular svd = right_singular(Eigen::MatrixXd(rows * space.estimates_from_seen()));
  const Eigen::MatrixXd prior = model.weak_prior() + model.known().transpose() * model.known();
  const Eigen::VectorXd weights = prior.diagonal().cwiseSqrt();
  const Eigen::MatrixXd directions = weights.asDiagonal() * space.estimates_from_seen() * svd.vectors.rightCols(open);
  // The squared cosines between the parameters and all that is open: which directions describe it does not matter.
  const PivotedQr qr(directions);
  const Eigen::VectorXd share = qr.orthonormal(qr.rank()).rowwise().squaredNorm();
  std::vector<std::size_t> order(static_cast<std::size_t>(share.size()));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  // Shares that differ by rounding are equal: the first parameter is named first.
  const auto rounded = [&](std::size_t i) { return std::round(share[static_cast<Index>(i)] / kEqualShare); };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rounded(a) > rounded(b); });
  std::string text;
  for (std::size_t k = 0; k < std::min(kMostNamed, order.size()); ++k)
    text += (k > 0 ? ", " : "") + model.parameters()[order[k]].name;
  return text;
}

}  // namespace abbe
