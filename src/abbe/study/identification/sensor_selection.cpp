#include "abbe/study/identification/sensor_selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

using Eigen::Index;

/// Parameters that can be used with these sensors, and those that cannot.
struct Split {
  std::vector<Index> kept, dropped;
};

Split split_of(const SensorTerms& terms, const std::vector<std::uint8_t>& has) {
  if (has.size() != terms.names.size() || static_cast<Index>(terms.needs.size()) != terms.size.size() ||
      !(terms.size.size() == 0 || terms.size.minCoeff() > 0)) {
    throw std::invalid_argument("selection of sensors: sizes do not agree");
  }
  Split split;
  for (std::size_t p = 0; p < terms.needs.size(); ++p) {
    const bool usable = std::all_of(terms.needs[p].begin(), terms.needs[p].end(),
                                    [&](std::size_t sensor) { return has.at(sensor) != 0; });
    (usable ? split.kept : split.dropped).push_back(static_cast<Index>(p));
  }
  return split;
}

/// Factor of an information matrix plus the unit matrix, with a unit diagonal.
struct Scaled {
  Eigen::VectorXd scale;
  Cholesky factor;

  explicit Scaled(const Eigen::MatrixXd& with_unit)
      : scale(with_unit.diagonal().cwiseSqrt().cwiseInverse()),
        factor(Eigen::MatrixXd(scale.asDiagonal() * with_unit * scale.asDiagonal())) {}
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const {
    return scale.asDiagonal() * factor.solve_columns(Eigen::MatrixXd(scale.asDiagonal() * right));
  }
};

Eigen::MatrixXd with_unit(Eigen::MatrixXd information) {
  information.diagonal().array() += 1;
  return information;
}

double root_mean_square_of(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(std::max<Index>(1, values.size())));
}

/// Rest of a column after a constant and the others, root mean square.
double rest_of(const Eigen::VectorXd& column, const Eigen::MatrixXd& others) {
  if (others.cols() == 0) return root_mean_square_of(column);
  PivotedQr qr(others);
  qr.set_threshold(1e-9);
  const Eigen::MatrixXd basis = qr.orthonormal(qr.rank());
  return root_mean_square_of(column - basis * (basis.transpose() * column));
}

}  // namespace

// In parameters over their size, with M = A'A and N = P'P: a fit of the kept terms k with the unit matrix as prior
// finds (M_kk + I)^-1 A_k' y, y = A x + noise. With x of unit covariance, the mean square of P x less what is predicted
// is tr(N_kk (M_kk + I)^-1), the uncertainty of the kept terms, and for each dropped term d c'N c with c = e_d - (M_kk
// + I)^-1 M_kd: what the kept terms do not take over from it.
double predicted_error(const SensorTerms& terms, const SensorPrediction& planned,
                       const std::vector<std::uint8_t>& has) {
  const Index p = terms.size.size();
  const Split split = split_of(terms, has);
  if (planned.information.rows() != p || planned.information.cols() != p || planned.prediction.rows() != p ||
      planned.prediction.cols() != p) {
    throw std::invalid_argument("selection of sensors: sizes do not agree");
  }
  const Eigen::MatrixXd m = terms.size.asDiagonal() * planned.information * terms.size.asDiagonal();
  const Eigen::MatrixXd n = terms.size.asDiagonal() * planned.prediction * terms.size.asDiagonal();
  const auto kept = static_cast<Index>(split.kept.size()), dropped = static_cast<Index>(split.dropped.size());
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(p, dropped);
  double square = 0;
  if (kept > 0) {
    const Scaled factor(with_unit(m(split.kept, split.kept)));
    square += factor.solve(n(split.kept, split.kept)).trace();
    if (dropped > 0) {
      const Eigen::MatrixXd taken_over = factor.solve(m(split.kept, split.dropped));
      for (Index k = 0; k < kept; ++k) c.row(split.kept[static_cast<std::size_t>(k)]) = -taken_over.row(k);
    }
  }
  for (Index d = 0; d < dropped; ++d) c(split.dropped[static_cast<std::size_t>(d)], d) = 1;
  if (dropped > 0) square += c.cwiseProduct(n * c).sum();
  return std::sqrt(std::max(square, 0.0));
}

double held_out_error(const SensorTerms& terms, const SensorReadings& readings, const std::vector<std::uint8_t>& has) {
  const Index p = terms.size.size(), count = readings.rows.rows();
  const Split split = split_of(terms, has);
  if (readings.rows.cols() != p || readings.values.size() != count ||
      static_cast<Index>(readings.held_out.size()) != count) {
    throw std::invalid_argument("selection of sensors: sizes do not agree");
  }
  std::vector<Index> used, held;
  for (Index i = 0; i < count; ++i) (readings.held_out[static_cast<std::size_t>(i)] != 0 ? held : used).push_back(i);
  if (held.empty()) throw std::invalid_argument("selection of sensors: nothing is held out");
  const Eigen::MatrixXd all = readings.rows * terms.size.asDiagonal();
  if (split.kept.empty()) return root_mean_square_of(readings.values(held));
  const Eigen::MatrixXd a = all(used, split.kept);
  const Scaled factor(with_unit(a.transpose() * a));
  const Eigen::VectorXd found = factor.solve(Eigen::MatrixXd(a.transpose() * readings.values(used)));
  return root_mean_square_of(readings.values(held) - all(held, split.kept) * found);
}

SensorSelection select_sensors(const std::vector<std::string>& names,
                               const std::function<double(const std::vector<std::uint8_t>& has)>& error) {
  const std::size_t count = names.size();
  SensorSelection result;
  result.names = names;
  std::vector<std::uint8_t> has(count, 1);
  result.all = error(has);
  for (std::size_t s = 0; s < count; ++s) {
    has[s] = 0;
    result.without.push_back({s, error(has)});
    has[s] = 1;
  }
  std::stable_sort(result.without.begin(), result.without.end(),
                   [](const SensorStep& a, const SensorStep& b) { return a.error > b.error; });
  has.assign(count, 0);
  result.none = error(has);
  while (result.forward.size() < count) {
    SensorStep best{count, 0};
    for (std::size_t s = 0; s < count; ++s) {
      if (has[s] != 0) continue;
      has[s] = 1;
      const double with = error(has);
      has[s] = 0;
      if (best.sensor == count || with < best.error) best = {s, with};
    }
    has[best.sensor] = 1;
    result.forward.push_back(best);
  }
  const auto is_enough = [&result](double value) { return value <= (1 + kEnoughError) * result.all; };
  if (!is_enough(result.none)) {
    while (result.enough < count && !is_enough(result.forward[result.enough].error)) ++result.enough;
    result.enough = std::min(count, result.enough + 1);
  }
  return result;
}

std::vector<SensorLikeness> like_sensors(const Eigen::MatrixXd& course) {
  std::vector<SensorLikeness> result;
  const Index count = course.cols();
  if (course.rows() == 0) return result;
  const Eigen::MatrixXd varying = course.rowwise() - course.colwise().mean();
  for (Index s = 0; s < count; ++s) {
    const double whole = root_mean_square_of(varying.col(s));
    const double largest = course.col(s).cwiseAbs().maxCoeff();
    const auto sensor = static_cast<std::size_t>(s);
    if (whole <= 1e-12 * largest) {
      result.push_back({sensor, SensorLikeness::kAllOthers, 0, 0});
      continue;
    }
    SensorLikeness nearest{sensor, SensorLikeness::kAllOthers, whole, whole};
    std::vector<Index> others;
    for (Index other = 0; other < count; ++other) {
      if (other == s) continue;
      others.push_back(other);
      const double left = rest_of(varying.col(s), varying.col(other));
      if (left < nearest.left) nearest = {sensor, static_cast<std::size_t>(other), left, whole};
    }
    // With as many columns as times every course follows from the others.
    if (nearest.left >= kSameCourse * whole && course.rows() > 2 * count) {
      nearest = {sensor, SensorLikeness::kAllOthers, rest_of(varying.col(s), varying(Eigen::all, others)), whole};
    }
    if (nearest.left < kSameCourse * whole) result.push_back(nearest);
  }
  return result;
}

std::string likeness_words(const std::vector<std::string>& courses, const SensorLikeness& one) {
  const std::string& name = courses[one.sensor];
  if (one.still())
    return fmt::format("{} does not change: terms that depend on it cannot be separated from the others", name);
  const std::string other = one.other == SensorLikeness::kAllOthers ? "the others together" : courses[one.other];
  return fmt::format("{} follows from {}: {:.3g} of its deviation of {:.3g} (root mean square) remain", name, other,
                     one.left, one.whole);
}

nlohmann::ordered_json likeness_json(const std::vector<std::string>& courses, const SensorLikeness& one) {
  nlohmann::ordered_json entry = {{"state", courses[one.sensor]}};
  if (one.still()) {
    entry["does_not_change"] = true;
    return entry;
  }
  entry["follows_from"] = one.other == SensorLikeness::kAllOthers ? "others" : courses[one.other];
  entry["deviation"] = one.whole;
  entry["remains"] = one.left;
  return entry;
}

}  // namespace abbe
