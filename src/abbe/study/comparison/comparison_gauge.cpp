#include "abbe/study/comparison/comparison_gauge.h"

#include <algorithm>
#include <cmath>

#include "abbe/geometry/decompositions.h"
#include "abbe/identify/gauge.h"
#include "abbe/study/compensation/pose_conventions.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

// Standard uncertainty of a transformed parameter over its typical size, below which it is rounding of zero: 1e-5 um.
constexpr double kNoSize = 1e-6;
// Variance of a combination over the sum of the variances of its parts, below which it is rounding of zero.
constexpr double kNoVariance = 1e-10;
// Eigenvalues of correlations below this are rounding of zero.
constexpr double kNoEigenvalue = 1e-11;
// Part of a direction that counts as lying outside of a space.
constexpr double kOutside = 1e-5;

/// [m] typical sizes of the parameters.
Eigen::VectorXd typical_sizes(const Machine& machine, const ErrorSet& errors) {
  const std::vector<bool> angles = parameters_are_angles(machine, errors);
  Eigen::VectorXd sizes(static_cast<Index>(angles.size()));
  for (std::size_t i = 0; i < angles.size(); ++i) {
    sizes[static_cast<Index>(i)] = angles[i] ? kTypicalErrorAngle : kTypicalErrorLength;
  }
  return sizes;
}

/// Combinations c with c' C c = 0, orthonormal columns in parameters over their typical sizes.
Eigen::MatrixXd combinations_without_variance(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& sizes) {
  std::vector<Index> varying;
  std::vector<Eigen::VectorXd> found;
  const Index m = covariance.rows();
  for (Index i = 0; i < m; ++i) {
    if (covariance(i, i) > 0) {
      varying.push_back(i);
    } else {
      found.emplace_back(Eigen::VectorXd::Unit(m, i));
    }
  }
  const Index n = static_cast<Index>(varying.size());
  if (n > 0) {
    Eigen::MatrixXd correlation(n, n);
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) {
        const Index a = varying[static_cast<std::size_t>(i)], b = varying[static_cast<std::size_t>(j)];
        correlation(i, j) = covariance(a, b) / std::sqrt(covariance(a, a) * covariance(b, b));
      }
    }
    const SymmetricEigen<> eigen(correlation);
    for (Index k = 0; k < n && eigen.eigenvalues()[k] < kNoEigenvalue * static_cast<double>(n); ++k) {
      Eigen::VectorXd combination = Eigen::VectorXd::Zero(m);
      for (Index i = 0; i < n; ++i) {
        const Index at = varying[static_cast<std::size_t>(i)];
        combination[at] = eigen.eigenvectors()(i, k) / std::sqrt(covariance(at, at)) * sizes[at];
      }
      found.push_back(combination.normalized());
    }
  }
  Eigen::MatrixXd columns(m, static_cast<Index>(found.size()));
  for (std::size_t k = 0; k < found.size(); ++k) columns.col(static_cast<Index>(k)) = found[k];
  if (columns.cols() == 0) return columns;
  const Qr qr(columns);
  return qr.orthonormal(columns.cols());
}

/// Whether both have set the same combinations, to the same values.
bool have_one_gauge(const Eigen::MatrixXd& first, const Eigen::MatrixXd& second, const Eigen::VectorXd& scaled_change) {
  if (first.cols() != second.cols()) return false;
  if (first.cols() == 0) return true;
  if ((first - second * (second.transpose() * first)).norm() > kOutside) return false;
  return (first.transpose() * scaled_change).norm() <= kOutside * (scaled_change.norm() + 1e-9);
}

struct SetValue {
  bool has_variance = true;
  double value = 0;
};

SetValue value_of(const Eigen::VectorXd& functional, const Eigen::VectorXd& values, const Eigen::MatrixXd& covariance) {
  const double parts = functional.cwiseAbs2().dot(covariance.diagonal());
  const double variance = functional.dot(covariance * functional);
  return {parts > 0 && variance > kNoVariance * parts, functional.dot(values)};
}

/// The value that a campaign gives to the quantity of an equation, by its own convention where it has one: the ranges
/// of the campaigns may differ.
SetValue value_of_campaign(const GaugeConstraint& constraint, const std::vector<GaugeConstraint>& own,
                           const ErrorsFile& file, const CampaignInModel& in_model) {
  for (const GaugeConstraint& one : own) {
    if (constraint.quantity.empty() || one.quantity != constraint.quantity) continue;
    const std::vector<double> parameters = file.errors.parameters();
    const Eigen::Map<const Eigen::VectorXd> values(parameters.data(), static_cast<Index>(parameters.size()));
    const SetValue found = value_of(one.functional, values, covariance_of(file));
    if (!found.has_variance) return found;
  }
  return value_of(constraint.functional, in_model.values, in_model.covariance);
}

/// A direction that changes no pose and that a campaign did not determine.
struct OpenDirection {
  const GaugeConstraint* constraint = nullptr;
  Eigen::VectorXd direction;           ///< over typical sizes
  std::array<Eigen::VectorXd, 2> set;  ///< its part in what each campaign has set
  bool is_set_anew = false;
};

/// What both have set in one way stays as they have set it, unless it depends on what is set anew.
void choose_what_is_set_anew(std::vector<OpenDirection>& open) {
  for (OpenDirection& one : open) {
    one.is_set_anew = (one.set[0] - one.set[1]).norm() > kOutside * one.direction.norm();
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (OpenDirection& one : open) {
      if (one.is_set_anew) continue;
      one.is_set_anew = std::any_of(open.begin(), open.end(), [&](const OpenDirection& other) {
        return other.is_set_anew &&
               std::abs(one.set[0].dot(other.direction)) > kOutside * one.set[0].norm() * other.direction.norm();
      });
      changed = changed || one.is_set_anew;
    }
  }
}

/// Symmetric, with variances that are rounding set to zero together with their covariances.
/// @param none  [m] standard uncertainties up to which they are that
Eigen::MatrixXd cleaned_covariance(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& none) {
  Eigen::MatrixXd result = (covariance + covariance.transpose()) / 2;
  for (Index i = 0; i < result.rows(); ++i) {
    if (result(i, i) > none[i] * none[i]) continue;
    result.row(i).setZero();
    result.col(i).setZero();
  }
  return result;
}

}  // namespace

GaugeChange bring_into_one_gauge(const IdentifiedCampaign& first, const IdentifiedCampaign& second,
                                 ComparisonModel& model) {
  GaugeChange done;
  std::array<CampaignInModel, 2>& campaigns = model.campaigns;
  if (campaigns[0].covariance.size() == 0 || campaigns[1].covariance.size() == 0) return {};
  const Eigen::VectorXd sizes = typical_sizes(model.machine, model.errors);
  const Eigen::VectorXd change = (campaigns[1].values - campaigns[0].values).cwiseQuotient(sizes);
  const std::array<Eigen::MatrixXd, 2> set = {combinations_without_variance(campaigns[0].covariance, sizes),
                                              combinations_without_variance(campaigns[1].covariance, sizes)};
  if (have_one_gauge(set[0], set[1], change)) return {};

  const std::vector<GaugeConstraint> common = pose_conventions(model.machine, model.errors);
  const std::array<std::vector<GaugeConstraint>, 2> own = {pose_conventions(first.machine, first.errors.errors),
                                                           pose_conventions(second.machine, second.errors.errors)};
  const std::array<const ErrorsFile*, 2> files = {&first.errors, &second.errors};
  std::vector<OpenDirection> open;
  for (const GaugeConstraint& constraint : common) {
    OpenDirection one{.constraint = &constraint, .direction = constraint.direction.cwiseQuotient(sizes), .set = {}};
    std::array<SetValue, 2> values;
    bool outside = false;
    for (std::size_t c = 0; c < 2; ++c) {
      values[c] = value_of_campaign(constraint, own[c], *files[c], campaigns[c]);
      one.set[c] = set[c] * (set[c].transpose() * one.direction);
      outside = outside || one.set[c].norm() > kOutside * one.direction.norm();
    }
    if (values[0].has_variance && values[1].has_variance && !outside) continue;
    // Known otherwise, and not by a convention: that is a change.
    const double typical = constraint.functional.cwiseProduct(sizes).norm();
    if (!values[0].has_variance && !values[1].has_variance &&
        std::abs(values[1].value - values[0].value) > 1e-6 * typical) {
      continue;
    }
    open.push_back(std::move(one));
  }
  choose_what_is_set_anew(open);
  const Index m = sizes.size();
  Eigen::MatrixXd transform = Eigen::MatrixXd::Identity(m, m);
  for (const OpenDirection& one : open) {
    if (!one.is_set_anew) continue;
    transform -= one.constraint->direction * one.constraint->functional.transpose();
    // What neither of them says something else about is not worth a word.
    const auto says_otherwise = [&](const CampaignInModel& campaign) {
      const SetValue value = value_of(one.constraint->functional, campaign.values, campaign.covariance);
      return value.has_variance || std::abs(value.value) > 1e-9 * one.constraint->functional.cwiseProduct(sizes).norm();
    };
    if (std::any_of(campaigns.begin(), campaigns.end(), says_otherwise))
      done.conventions.push_back(one.constraint->words);
    done.is_moved = true;
  }
  if (!done.is_moved) return done;
  for (CampaignInModel& campaign : campaigns) {
    campaign.values = transform * campaign.values;
    campaign.covariance = cleaned_covariance(transform * campaign.covariance * transform.transpose(), kNoSize * sizes);
  }
  return done;
}

}  // namespace abbe
