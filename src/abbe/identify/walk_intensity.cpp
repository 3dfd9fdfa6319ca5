#include "abbe/identify/walk_intensity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
constexpr int kMostRounds = 60;
constexpr double kWalksSettled = 1e-12;  // square of the step in standard uncertainties
constexpr double kLeastPart = 0.1;       // a variance falls to no less than this part of itself at once
constexpr double kNoWalk = 0.01;         // standard uncertainties of a variance that is falling to zero
constexpr double kNotTold = 1e-6;        // share of the information of one variance that the others leave

/// The unknowns of a walk among the estimates, and K over them.
struct WalkUnknowns {
  std::vector<Index> at;
  Eigen::MatrixXd structure;
};

WalkUnknowns unknowns_of(const Problem& problem, const EstimatedWalk& walk) {
  WalkUnknowns result;
  for (const std::size_t p : walk.priors) {
    for (const ParameterId& id : problem.joint_priors[p].parameters) {
      result.at.push_back(static_cast<Index>(find_estimated(problem, id)));
    }
  }
  const auto n = static_cast<Index>(result.at.size());
  result.structure = Eigen::MatrixXd::Zero(n, n);
  Index first = 0;
  for (const std::size_t p : walk.priors) {
    const Eigen::MatrixXd& information = problem.joint_priors[p].information;
    result.structure.block(first, first, information.rows(), information.cols()) = walk.variance * information;
    first += information.rows();
  }
  return result;
}

struct WalkScore {
  Eigen::VectorXd score;
  Eigen::MatrixXd information;
};

WalkScore score_of(const std::vector<WalkUnknowns>& unknowns, const std::vector<EstimatedWalk>& walks,
                   const Identification& identified) {
  const auto count = static_cast<Index>(walks.size());
  WalkScore result{Eigen::VectorXd::Zero(count), Eigen::MatrixXd::Zero(count, count)};
  const auto share = [&](std::size_t i, std::size_t j) -> Eigen::MatrixXd {
    return unknowns[i].structure * identified.covariance(unknowns[i].at, unknowns[j].at) / walks[j].variance;
  };
  for (std::size_t i = 0; i < walks.size(); ++i) {
    const auto ii = static_cast<Index>(i);
    const double t = walks[i].variance, n = static_cast<double>(unknowns[i].at.size());
    const Eigen::VectorXd u = identified.estimates(unknowns[i].at);
    const Eigen::MatrixXd own = share(i, i);
    result.score[ii] = -(n - own.trace()) / (2 * t) + u.dot(unknowns[i].structure * u) / (2 * t * t);
    for (std::size_t j = 0; j < walks.size(); ++j) {
      Eigen::MatrixXd first = -share(i, j), second = -share(j, i);
      if (i == j) first.diagonal().array() += 1, second.diagonal().array() += 1;
      result.information(ii, static_cast<Index>(j)) =
          first.cwiseProduct(second.transpose()).sum() / (2 * t * walks[j].variance);
    }
  }
  return result;
}

void set_variance(Problem& problem, EstimatedWalk& walk, double variance) {
  for (const std::size_t p : walk.priors) problem.joint_priors[p].information *= walk.variance / variance;
  walk.variance = variance;
}

void fail_walks(Identification& identified, IdentifyStatus status, const std::string& message) {
  identified.status = status;
  identified.converged = false;
  identified.message = message;
}

}  // namespace

Identification identify_with_walks(Problem& problem, std::vector<EstimatedWalk>& walks,
                                   const IdentifyOptions& options) {
  const ErrorSet errors = problem.errors;
  const Eigen::VectorXd start = present_values(problem);
  std::vector<WalkUnknowns> unknowns;
  for (const EstimatedWalk& walk : walks) unknowns.push_back(unknowns_of(problem, walk));
  for (int round = 0;; ++round) {
    problem.errors = errors;
    set_observations(problem, start);
    Identification identified = identify(problem, options);
    if (identified.status != IdentifyStatus::converged) return identified;
    const WalkScore at = score_of(unknowns, walks, identified);
    std::vector<Index> open;
    for (std::size_t i = 0; i < walks.size(); ++i) {
      const auto ii = static_cast<Index>(i);
      const double information = at.information(ii, ii);
      if (!(information > 0)) {
        fail_walks(identified, IdentifyStatus::rank_deficient,
                   "the readings do not show how far " + walks[i].name + " wander");
        return identified;
      }
      walks[i].variance_uncertainty = 1 / std::sqrt(information);
      walks[i].at_zero = walks[i].at_zero && at.score[ii] <= 0;
      if (!walks[i].at_zero) open.push_back(ii);
    }
    if (open.empty()) return identified;
    const Eigen::VectorXd score = at.score(open);
    // Variances of lengths and of angles differ by many orders of magnitude.
    const Eigen::VectorXd scale = at.information.diagonal()(open).cwiseSqrt().cwiseInverse();
    const SymmetricEigen<> information(scale.asDiagonal() * at.information(open, open) * scale.asDiagonal());
    if (!(information.eigenvalues()[0] > kNotTold)) {
      fail_walks(identified, IdentifyStatus::rank_deficient,
                 "the readings do not tell the intensities of the walks apart");
      return identified;
    }
    const Eigen::MatrixXd axes = scale.asDiagonal() * information.eigenvectors();
    const Eigen::MatrixXd covariance = axes * information.eigenvalues().cwiseInverse().asDiagonal() * axes.transpose();
    const Eigen::VectorXd step = covariance * score;
    for (std::size_t k = 0; k < open.size(); ++k) {
      const auto kk = static_cast<Index>(k);
      walks[static_cast<std::size_t>(open[k])].variance_uncertainty = std::sqrt(covariance(kk, kk));
    }
    if (score.dot(step) <= kWalksSettled) return identified;
    if (round >= kMostRounds) {
      fail_walks(identified, IdentifyStatus::no_convergence,
                 fmt::format("the intensities of the walks have not settled after {} identifications", round));
      return identified;
    }
    for (std::size_t k = 0; k < open.size(); ++k) {
      EstimatedWalk& walk = walks[static_cast<std::size_t>(open[k])];
      const double next = walk.variance + step[static_cast<Index>(k)];
      const bool falls = next <= kLeastPart * walk.variance;
      walk.at_zero = falls && walk.variance < kNoWalk * walk.variance_uncertainty;
      set_variance(problem, walk, falls ? kLeastPart * walk.variance : next);
    }
  }
}

}  // namespace abbe
