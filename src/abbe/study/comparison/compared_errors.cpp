#include "abbe/study/comparison/compared_errors.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/errors/poses.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/identify/distributions.h"
#include "abbe/machine/state.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

// Variances of a combination below this part of the largest are rounding of zero.
constexpr double kNegligibleVariance = 1e-9;
// A change in a direction without variance, beyond this part of the whole, is one.
constexpr double kUnexplained = 1e-6;
constexpr double kRoundingOfValues = 1e-7;
constexpr std::size_t kCurvePoints = 121;

/// Eigenvalues above rounding, with their eigenvectors.
struct Spectrum {
  Eigen::VectorXd values;   ///< [rank]
  Eigen::MatrixXd vectors;  ///< [n, rank]

  std::size_t rank() const { return static_cast<std::size_t>(values.size()); }
};

Spectrum spectrum_of(const Eigen::MatrixXd& covariance) {
  Spectrum spectrum;
  const SymmetricEigen<> eigen(covariance);
  const Index n = covariance.rows();
  const double largest = n > 0 ? eigen.eigenvalues()[n - 1] : 0;
  Index rank = 0;
  while (rank < n && largest > 0 && eigen.eigenvalues()[n - 1 - rank] > kNegligibleVariance * largest) ++rank;
  spectrum.values = eigen.eigenvalues().tail(rank);
  spectrum.vectors = eigen.eigenvectors().rightCols(rank);
  return spectrum;
}

double chi_square_of(const Spectrum& spectrum, const Eigen::VectorXd& change) {
  return (spectrum.vectors.transpose() * change).cwiseAbs2().cwiseQuotient(spectrum.values).sum();
}

/// The part of a change that no variance explains.
double left_unexplained(const Spectrum& spectrum, const Eigen::VectorXd& change) {
  return (change - spectrum.vectors * (spectrum.vectors.transpose() * change)).norm();
}

/// One error as combinations of its parameters that are alike in unit and size.
struct Combined {
  std::array<bool, 2> is_in{};  // the files
  Eigen::VectorXd change;
  double rounding = 0;                        // of the values
  std::array<Eigen::MatrixXd, 2> covariance;  // or 0 x 0
};

bool states_both(const Combined& error) { return error.covariance[0].size() > 0 && error.covariance[1].size() > 0; }

/// What can be said of a change. @param whole  becomes the spectrum of both covariances together
ChangeVerdict verdict_before_test(const Combined& error, Spectrum& whole) {
  if (!states_both(error)) {
    if (!error.is_in[0]) return ChangeVerdict::only_second;
    return error.is_in[1] ? ChangeVerdict::not_known : ChangeVerdict::only_first;
  }
  const double unexplained = kUnexplained * error.change.norm() + error.rounding;
  const auto &first = error.covariance[0], &second = error.covariance[1];
  const std::size_t rank_first = spectrum_of(first).rank(), rank_second = spectrum_of(second).rank();
  if (rank_first == 0 && rank_second == 0) {
    return error.change.norm() > unexplained ? ChangeVerdict::not_known : ChangeVerdict::by_convention;
  }
  if (rank_first == 0) return ChangeVerdict::only_second;
  if (rank_second == 0) return ChangeVerdict::only_first;
  // Each counts as much as the other: a campaign with a tenth of the uncertainty is not nothing beside the other.
  const std::size_t together = spectrum_of(first / first.trace() + second / second.trace()).rank();
  if (rank_first != together || rank_second != together) return ChangeVerdict::partly;
  whole = spectrum_of(first + second);
  return left_unexplained(whole, error.change) > unexplained ? ChangeVerdict::not_known
                                                             : ChangeVerdict::not_significant;
}

/// Compares one error after the other.
class ErrorComparison {
 public:
  ErrorComparison(const ComparisonModel& model, bool curves) : model_(model), curves_(curves) {
    change_ = model.campaigns[1].values - model.campaigns[0].values;
  }

  ComparedError compared(const ModelledError& of, Eigen::MatrixXd& combinations) const {
    ComparedError error;
    error.name = of.name(model_.machine);
    error.words = of.words(model_.machine);
    if (of.state != kNoState) error.per = factor_unit(model_.machine, of.state);
    error.axis = of.axis;
    error.is_angle = of.is_angle(model_.machine);
    error.is_motion = of.kind == ModelledError::Kind::motion;
    error.beyond = of.beyond;
    Eigen::MatrixXd functions;
    std::vector<double> positions;
    if (error.is_motion) {
      error.from = of.from;
      error.to = of.to;
      positions = evenly_spaced(of.from, of.to, kCurvePoints);
      functions = sampled_functions(model_.terms(of), positions);
      PivotedQr qr(functions);
      qr.set_threshold(1e-10);
      // Values of the function at the positions, in coordinates: of each its root mean square over the range.
      combinations = qr.orthonormal(qr.rank()).transpose() * functions / std::sqrt(static_cast<double>(kCurvePoints));
    } else {
      combinations = functions = Eigen::MatrixXd::Identity(of.size, of.size);
    }
    const double typical = error.is_angle ? kTypicalErrorAngle : kTypicalErrorLength;
    Combined combined{.is_in = of.is_in,
                      .change = combinations * change_.segment(of.first, of.size),
                      .rounding = kRoundingOfValues * (typical + (combinations * values(0, of)).norm() +
                                                       (combinations * values(1, of)).norm()),
                      .covariance = {}};
    for (std::size_t c = 0; c < 2; ++c) {
      if (states(c)) combined.covariance[c] = combinations * covariance(c, of) * combinations.transpose();
    }
    Spectrum whole;
    error.verdict = verdict_before_test(combined, whole);
    if (error.verdict == ChangeVerdict::not_significant) {
      error.chi_square = chi_square_of(whole, combined.change);
      error.rank = whole.rank();
      error.probability = chi_square_exceedance(*error.chi_square, static_cast<double>(error.rank));
    }
    // With what a convention set for one of them there is no change to be stated.
    if (!is_comparable(error.verdict)) return error;
    if (of.kind == ModelledError::Kind::tool_offset) {
      state_length(of, error);
    } else {
      state_largest(of, positions, functions, error);
    }
    return error;
  }

 private:
  bool states(std::size_t c) const { return model_.campaigns[c].covariance.size() > 0; }
  Eigen::MatrixXd covariance(std::size_t c, const ModelledError& of) const {
    return model_.campaigns[c].covariance.block(of.first, of.first, of.size, of.size);
  }
  Eigen::VectorXd values(std::size_t c, const ModelledError& of) const {
    return model_.campaigns[c].values.segment(of.first, of.size);
  }

  std::vector<double> uncertainties(std::size_t c, const ModelledError& of, const Eigen::MatrixXd& functions) const {
    const Eigen::MatrixXd spread = functions * covariance(c, of);
    return as_list(spread.cwiseProduct(functions).rowwise().sum().cwiseMax(0).cwiseSqrt());
  }

  /// The change of a function, or of a single value, where its amount is largest.
  void state_largest(const ModelledError& of, const std::vector<double>& positions, const Eigen::MatrixXd& functions,
                     ComparedError& error) const {
    ComparedCurve curve;
    curve.position = positions;
    curve.first = as_list(functions * values(0, of));
    curve.second = as_list(functions * values(1, of));
    curve.change = as_list(functions * change_.segment(of.first, of.size));
    if (states(0)) curve.u_first = uncertainties(0, of, functions);
    if (states(1)) curve.u_second = uncertainties(1, of, functions);
    std::size_t at = 0;
    for (std::size_t i = 1; i < curve.change.size(); ++i) {
      if (std::abs(curve.change[i]) > std::abs(curve.change[at]) * (1 + 1e-9)) at = i;
    }
    if (states(0) && states(1)) {
      for (std::size_t i = 0; i < curve.change.size(); ++i) {
        curve.u_change.push_back(std::hypot(curve.u_first[i], curve.u_second[i]));
      }
      error.expanded_uncertainty = 2 * curve.u_change[at];
      error.u_value = {curve.u_first[at], curve.u_second[at]};
    }
    error.change = curve.change[at];
    error.value = {curve.first[at], curve.second[at]};
    if (!positions.empty()) error.at = positions[at];
    // Without a variance there is no uncertainty that could be stated.
    if (error.verdict == ChangeVerdict::not_known) error.expanded_uncertainty.reset();
    if (curves_ && error.is_motion) error.curve = std::move(curve);
  }

  /// The change of a vector: its length, with the uncertainty along it.
  void state_length(const ModelledError& of, ComparedError& error) const {
    const Eigen::VectorXd change = change_.segment(of.first, of.size);
    error.change = change.norm();
    error.value = {values(0, of).norm(), values(1, of).norm()};
    if (error.verdict == ChangeVerdict::not_known) return;
    const Eigen::MatrixXd both = covariance(0, of) + covariance(1, of);
    const double variance = error.change > 0 ? change.dot(both * change) / change.squaredNorm()
                                             : SymmetricEigen<>(both, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
    error.expanded_uncertainty = 2 * std::sqrt(std::max(0.0, variance));
  }

  const ComparisonModel& model_;
  bool curves_;
  Eigen::VectorXd change_;
};

/// All judged errors in one test, their correlations with each other included.
void test_together(const ComparisonModel& model, const Eigen::MatrixXd& combinations, ComparedPair& pair) {
  if (combinations.rows() == 0) return;
  const Eigen::VectorXd change = combinations * (model.campaigns[1].values - model.campaigns[0].values);
  const Eigen::MatrixXd covariance =
      combinations * (model.campaigns[0].covariance + model.campaigns[1].covariance) * combinations.transpose();
  // In correlations, because mm and rad stand side by side.
  const Eigen::VectorXd scale =
      covariance.diagonal().unaryExpr([](double variance) { return variance > 0 ? 1 / std::sqrt(variance) : 0.0; });
  const Spectrum spectrum = spectrum_of(scale.asDiagonal() * covariance * scale.asDiagonal());
  pair.chi_square = chi_square_of(spectrum, scale.cwiseProduct(change));
  pair.rank = spectrum.rank();
  pair.probability = chi_square_exceedance(*pair.chi_square, static_cast<double>(pair.rank));
}

/// Nobody stated it, nobody found it: nothing to be listed.
bool is_nothing(const ComparisonModel& model, const ModelledError& error) {
  return error.kind == ModelledError::Kind::tool_offset &&
         std::all_of(model.campaigns.begin(), model.campaigns.end(), [&](const CampaignInModel& campaign) {
           if (!campaign.values.segment(error.first, error.size).isZero(0)) return false;
           return campaign.covariance.size() == 0 ||
                  campaign.covariance.block(error.first, error.first, error.size, error.size).isZero(0);
         });
}

}  // namespace

void compare_errors(const ComparisonModel& model, const ErrorTests& tests, ComparedPair& pair) {
  const ErrorComparison comparison(model, tests.curves);
  const Index m = model.campaigns[0].values.size();
  Eigen::MatrixXd all(0, m);
  std::vector<double> probabilities;
  for (const ModelledError& of : model.list) {
    if (is_nothing(model, of)) continue;
    Eigen::MatrixXd combinations;
    pair.errors.push_back(comparison.compared(of, combinations));
    const ComparedError& error = pair.errors.back();
    if (!error.chi_square) continue;
    probabilities.push_back(error.probability);
    const Index rows = all.rows();
    all.conservativeResize(rows + combinations.rows(), Eigen::NoChange);
    all.bottomRows(combinations.rows()).setZero();
    all.block(rows, of.first, combinations.rows(), of.size) = combinations;
  }
  const std::vector<double> adjusted = holm_adjusted(probabilities);
  std::size_t next = 0;
  for (ComparedError& error : pair.errors) {
    if (!error.chi_square) continue;
    error.adjusted = adjusted[next++];
    if (error.adjusted <= tests.level) error.verdict = ChangeVerdict::changed;
  }
  if (tests.one_gauge) test_together(model, all, pair);
}

}  // namespace abbe
