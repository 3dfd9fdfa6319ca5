#include "abbe/identify/trust/unseen.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/geometry/decompositions.h"
#include "abbe/identify/measurements_together.h"
#include "abbe/identify/normal_equations.h"
#include "abbe/identify/parameter_words.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
constexpr double kSameDirection = 0.4;
constexpr double kNoMachinePart = 1e-6;
constexpr double kPriorShare = 0.9;
constexpr double kHardlyLess = 0.5;
constexpr double kQuarter = 0.25;
constexpr double kNamedEntry = 0.2;
constexpr std::size_t kMostNamed = 4;

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& columns) {
  if (columns.cols() == 0) return Eigen::MatrixXd(columns.rows(), 0);
  return Qr(columns).orthonormal(columns.cols());
}

/// Information of the priors in scaled parameters.
Eigen::MatrixXd prior_information(const Problem& problem, const Eigen::VectorXd& typical) {
  const Eigen::MatrixXd rows = prior_rows(problem) * typical.asDiagonal();
  return rows.transpose() * rows;
}

std::string names(const std::vector<EstimatedParameter>& parameters, const std::vector<std::size_t>& which) {
  std::string text;
  for (std::size_t k = 0; k < std::min(which.size(), kMostNamed); ++k)
    text += (k == 0 ? "" : k + 1 == which.size() ? " and " : ", ") + parameters[which[k]].name;
  if (which.size() > kMostNamed) text += fmt::format(" and {} more", which.size() - kMostNamed);
  return text;
}

/// Finds what every direction is, and the first measurement that shows it.
class Adviser {
 public:
  Adviser(const Problem& problem, const Identification& identification,
          const std::vector<PossibleMeasurement>& possible, const AdviceOptions& options)
      : problem_(problem),
        identification_(identification),
        possible_(possible),
        options_(options),
        parameters_(estimated_parameters(problem)),
        typical_(typical_sizes(parameters_, options)) {
    for (const PossibleMeasurement& measurement : possible)
      rows_.push_back(rows_without_own(measurement, typical_.size()) * typical_.asDiagonal());
  }

  std::vector<Advice> run() {
    unseen();
    weak();
    return std::move(result_);
  }

 private:
  bool set_up_alone(const Eigen::VectorXd& scaled) const {
    double machine = 0;
    for (Index i = 0; i < scaled.size(); ++i)
      if (parameters_[static_cast<std::size_t>(i)].id.is_machine()) machine = std::max(machine, std::abs(scaled[i]));
    return machine < kNoMachinePart * scaled.cwiseAbs().maxCoeff();
  }

  /// Unseen directions in units of typical sizes, orthonormal, where the trials are: they turn a little with the
  /// errors.
  Eigen::MatrixXd open_directions() const {
    const Index p = typical_.size();
    Eigen::VectorXd nominal = present_values(problem_);
    for (Index i = 0; i < p; ++i)
      if (parameters_[static_cast<std::size_t>(i)].id.is_machine()) nominal[i] = 0;
    const NullSpace null_space = find_null_space(problem_, nominal);
    set_observations(problem_, identification_.estimates);
    Eigen::MatrixXd open = orthonormal(typical_.cwiseInverse().asDiagonal() * null_space.basis);
    // What was fixed at the start may be seen by a trace at the solution: a sphere a micrometre off the axis.
    for (const GaugeConstraint& constraint : identification_.gauge.constraints) {
      const Eigen::VectorXd direction = constraint.direction.cwiseQuotient(typical_);
      const Eigen::VectorXd rest = direction - open * (open.transpose() * direction);
      if (rest.norm() < kSameDirection * direction.norm()) continue;
      open.conservativeResize(p, open.cols() + 1);
      open.rightCols(1) = rest.normalized();
    }
    return open;
  }

  void unseen() {
    const std::vector<GaugeConstraint>& constraints = identification_.gauge.constraints;
    if (constraints.empty()) return;
    const Eigen::MatrixXd open = open_directions();
    std::vector<Eigen::MatrixXd> left;
    Eigen::MatrixXd never = open;
    for (const Eigen::MatrixXd& rows : rows_) {
      left.push_back(left_open(rows, open));
      never = left_open(rows, never);
    }
    for (const GaugeConstraint& constraint : constraints) {
      Advice advice;
      advice.parameters = constraint.inseparable;
      advice.text = constraint.inseparable_words;
      if (!constraint.by_convention)
        advice.text =
            fmt::format("{}{} is not seen by the readings", advice.parameters.size() > 1 ? "a combination of " : "",
                        names(parameters_, advice.parameters));
      advice.words = parameter_words(problem_, parameters_, advice.parameters);
      const Eigen::VectorXd given = constraint.direction.cwiseQuotient(typical_);
      const Eigen::VectorXd unseen = open * (open.transpose() * given);
      const Eigen::VectorXd direction = unseen - never * (never.transpose() * unseen);
      const bool tried = !possible_.empty();
      const bool measurable = direction.norm() > kLeftUnseen * given.norm();
      for (std::size_t k = 0; k < possible_.size() && tried && measurable && !advice.shown; ++k) {
        if ((left[k].transpose() * direction).norm() > kLeftUnseen * direction.norm()) continue;
        advice.shown = true;
        advice.remedy = possible_[k].words + " would show it";
      }
      if (set_up_alone(given)) {
        advice.kind = AdviceKind::set_up;
        if (!advice.shown) advice.remedy = "none is needed: the machine's errors do not depend on it";
      } else if (tried && !measurable) {
        advice.kind = constraint.by_convention ? AdviceKind::convention : AdviceKind::not_measured;
        advice.remedy = constraint.by_convention ? "none is needed: it is a convention (" + constraint.words + ")"
                                                 : "none of the measurements tried would show it";
      } else if (!advice.shown) {
        advice.remedy = tried ? together(open, direction) : "no additional measurement was tried";
        advice.shown = tried;
      }
      result_.push_back(std::move(advice));
    }
  }

  /// No single measurement shows all of a direction: the ones that do it one after the other.
  std::string together(const Eigen::MatrixXd& open, const Eigen::VectorXd& direction) const {
    const MeasurementsTogether together = measurements_together(possible_, rows_, open, direction);
    return (together.enough ? together.words : "only several of the measurements tried, together,") + " would show it";
  }

  /// A direction that is seen, but hardly, and what the measurements tried do to its variance.
  struct Weak {
    Eigen::VectorXd direction;
    double variance = 0;
    double least = 0;  // of the measurements tried
    bool by_prior = false;
    Advice advice;
  };

  void weak() {
    const Eigen::MatrixXd covariance =
        typical_.cwiseInverse().asDiagonal() * identification_.covariance * typical_.cwiseInverse().asDiagonal();
    const Eigen::MatrixXd prior = prior_information(problem_, typical_);
    const SymmetricEigen<> eigen(covariance);
    std::vector<Weak> found;
    for (Index k = typical_.size(); k-- > 0;) {
      const double variance = eigen.eigenvalues()[k];
      if (!(variance > options_.weak * options_.weak)) break;
      describe_weak(prior, eigen.eigenvectors().col(k), variance, found);
    }
    try_measurements(covariance, found);
    for (Weak& one : found) {
      say_remedy(one);
      result_.push_back(std::move(one.advice));
    }
  }

  void describe_weak(const Eigen::MatrixXd& prior, const Eigen::VectorXd& direction, double variance,
                     std::vector<Weak>& found) const {
    Weak weak{direction, variance, variance, false, {}};
    Advice& advice = weak.advice;
    advice.unseen = false;
    advice.kind = AdviceKind::weak;
    advice.parameters = largest_entries(direction, kNamedEntry);
    const EstimatedParameter& first = parameters_[advice.parameters.front()];
    if (!first.id.is_machine()) return;
    advice.words = parameter_words(problem_, parameters_, advice.parameters);
    const Index at = static_cast<Index>(advice.parameters.front());
    const double size = std::sqrt(variance) * std::abs(direction[at]) * typical_[at];
    // Share of the information along the direction that the priors give.
    weak.by_prior = direction.dot(prior * direction) * variance > kPriorShare;
    if (weak.by_prior) advice.kind = AdviceKind::not_measured;
    advice.text = fmt::format(
        "{}{} {}: standard uncertainty of {} {:.3g} {}", advice.parameters.size() > 1 ? "a combination of " : "",
        names(parameters_, advice.parameters),
        weak.by_prior ? "is not seen by the readings and rests on prior knowledge alone" : "is seen only weakly",
        first.name, micro_per_unit(first.is_angle) * size, micro_unit(first.is_angle));
    found.push_back(std::move(weak));
  }

  /// Each measurement is decomposed once for all directions that none before it has shown.
  void try_measurements(const Eigen::MatrixXd& covariance, std::vector<Weak>& found) const {
    for (std::size_t m = 0; m < possible_.size(); ++m) {
      if (std::all_of(found.begin(), found.end(), [](const Weak& one) { return one.advice.shown; })) return;
      // Variance after adding rows A: d'(C - C A'(I + A C A')^-1 A C) d.
      const Eigen::MatrixXd spread = rows_[m] * covariance;
      Eigen::MatrixXd inner = spread * rows_[m].transpose();
      inner.diagonal().array() += 1;
      const Cholesky factor(inner);
      for (Weak& one : found) {
        if (one.advice.shown) continue;
        const Eigen::VectorXd seen = spread * one.direction;
        const double after = one.variance - seen.dot(factor.solve(seen));
        one.least = std::min(one.least, after);
        if (!(after < kQuarter * one.variance)) continue;
        one.advice.shown = true;
        one.advice.factor = std::sqrt(one.variance / std::max(after, 1e-12 * one.variance));
        one.advice.remedy = possible_[m].words + " would lower its uncertainty";
      }
    }
  }

  void say_remedy(Weak& weak) const {
    Advice& advice = weak.advice;
    if (advice.shown) return;
    if (!weak.by_prior || possible_.empty()) {
      advice.remedy = "more readings of the same kind, or a more accurate instrument";
    } else if (weak.least > kHardlyLess * weak.variance) {
      advice.kind = AdviceKind::convention;
      advice.remedy = "none is needed: no measurement tried tells it apart, the prior takes the place of a convention";
    } else {
      advice.remedy = "none of the measurements tried lowers its uncertainty to a half";
    }
  }

  const Problem& problem_;
  const Identification& identification_;
  const std::vector<PossibleMeasurement>& possible_;
  const AdviceOptions& options_;
  std::vector<EstimatedParameter> parameters_;
  Eigen::VectorXd typical_;            // [p] size of each that matters, mm or rad
  std::vector<Eigen::MatrixXd> rows_;  // [possible] [rows, p] in scaled parameters
  std::vector<Advice> result_;
};

}  // namespace

const char* kind_text(AdviceKind kind) {
  switch (kind) {
    case AdviceKind::not_measured:
      return "not measured";
    case AdviceKind::weak:
      return "weak";
    case AdviceKind::convention:
      return "convention";
    case AdviceKind::datum:
      return "datum";
    case AdviceKind::set_up:
      break;
  }
  return "set-up";
}

std::vector<Advice> unseen_advice(const Problem& problem, const Identification& identification,
                                  const std::vector<PossibleMeasurement>& possible, const AdviceOptions& options) {
  const Index p = static_cast<Index>(estimated_count(problem));
  if (identification.covariance.rows() != p || p == 0) return {};
  return Adviser(problem, identification, possible, options).run();
}

}  // namespace abbe
