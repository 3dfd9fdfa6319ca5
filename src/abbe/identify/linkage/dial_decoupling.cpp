#include "abbe/identify/linkage/dial_decoupling.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"
#include "abbe/geometry/singular_values.h"

namespace abbe {
namespace {

constexpr double kRankTolerance = 1e-9;  // relative to columns of length 1

/// "EZX" of the component of an axis called X (linear) or A (rotary).
std::string name_of(const AxisIndications& readings, std::size_t component) {
  const char axis = (readings.kind == AxisKind::linear ? "XYZ" : "ABC")[readings.direction];
  return fmt::format("E{}{}", component_letter(static_cast<Component>(component)), axis);
}

void check(const AxisIndications& r) {
  const Eigen::Index m = static_cast<Eigen::Index>(r.positions.size());
  const Eigen::Index k = static_cast<Eigen::Index>(r.probes.size());
  if (r.direction > 2) throw std::invalid_argument("direction of the axis is none of X, Y, Z");
  if (r.indications.rows() != m || r.indications.cols() != k) {
    throw std::invalid_argument("indications are not one row per position and one column per probe");
  }
  if (!r.indications.allFinite()) throw std::invalid_argument("indications that are not finite");
  for (std::size_t i = 1; i < r.positions.size(); ++i) {
    if (!(r.positions[i] > r.positions[i - 1])) throw std::invalid_argument("positions do not increase");
  }
  for (const DisplacementProbe& probe : r.probes) {
    if (!(std::abs(probe.direction.norm() - 1) < 1e-9)) throw std::invalid_argument("direction is not of unit length");
    // Its inverse square is a weight.
    if (!(probe.standard_uncertainty > 1e-100 && probe.standard_uncertainty < 1e100)) {
      throw std::invalid_argument("standard uncertainty is not positive");
    }
    if (!probe.place.allFinite()) throw std::invalid_argument("place that is not finite");
  }
}

/// n . (d + e x P) by d and e: [k, 6].
Eigen::MatrixXd design(const AxisIndications& readings) {
  Eigen::MatrixXd d(static_cast<Eigen::Index>(readings.probes.size()), kComponentCount);
  for (Eigen::Index i = 0; i < d.rows(); ++i) {
    const DisplacementProbe& probe = readings.probes[static_cast<std::size_t>(i)];
    d.row(i) << probe.direction.transpose(), probe.place.cross(probe.direction).transpose();
  }
  // A body of revolution looks the same however far it is turned.
  if (readings.kind == AxisKind::rotary) d.col(3 + static_cast<Eigen::Index>(readings.direction)).setZero();
  return d;
}

Eigen::MatrixXd columns_of(const Eigen::MatrixXd& matrix, const std::vector<std::size_t>& which) {
  Eigen::MatrixXd result(matrix.rows(), static_cast<Eigen::Index>(which.size()));
  for (std::size_t i = 0; i < which.size(); ++i) {
    result.col(static_cast<Eigen::Index>(i)) = matrix.col(static_cast<Eigen::Index>(which[i]));
  }
  return result;
}

/// Which components can be told from each other; fills seen, notes, status and message.
std::vector<std::size_t> find_components(const AxisIndications& readings, const Eigen::MatrixXd& d,
                                         Decoupling& result) {
  double lever = 0;
  for (const DisplacementProbe& probe : readings.probes) lever = std::max(lever, probe.place.norm());
  const auto is_zero = [&](std::size_t c) {
    const double size = c < 3 ? 1.0 : std::max(lever, 1e-300);
    return d.rows() == 0 || d.col(static_cast<Eigen::Index>(c)).cwiseAbs().maxCoeff() <= kRankTolerance * size;
  };
  std::vector<std::size_t> displacements, components;
  for (std::size_t c = 0; c < 3; ++c) {
    if (!is_zero(c)) displacements.push_back(c);
  }
  components = displacements;
  const Eigen::MatrixXd shifts = columns_of(d, displacements);
  for (std::size_t c = 3; c < kComponentCount; ++c) {
    if (is_zero(c) || displacements.empty()) continue;
    // A rotation with the same lever at every probe of a direction cannot be told from a displacement.
    const Eigen::VectorXd column = d.col(static_cast<Eigen::Index>(c));
    const Eigen::VectorXd levers = PivotedQr(shifts).solve(column);
    if ((column - shifts * levers).norm() > kRankTolerance * column.norm()) {
      components.push_back(c);
      continue;
    }
    for (std::size_t i = 0; i < displacements.size(); ++i) {
      const double value = levers[static_cast<Eigen::Index>(i)];
      if (std::abs(value) <= kRankTolerance * lever) continue;
      result.notes.push_back(fmt::format("{} is that at the probes: it contains {:.6g} mm x {}, which is not seen",
                                         name_of(readings, displacements[i]), value, name_of(readings, c)));
    }
  }
  if (components.empty()) {
    result.status = DecouplingStatus::nothing_seen;
    result.message = "no probe sees a displacement";
    return {};
  }
  Eigen::MatrixXd scaled = columns_of(d, components);
  scaled.colwise().normalize();
  const RightSingular svd = right_singular(scaled);
  const Eigen::Index n = scaled.cols();
  Eigen::Index rank = 0;
  while (rank < svd.values.size() && svd.values[rank] > kRankTolerance) ++rank;
  if (rank < n) {
    std::string names;
    for (std::size_t i = 0; i < components.size(); ++i) {
      if (svd.vectors.row(static_cast<Eigen::Index>(i)).tail(n - rank).norm() < 1e-6) continue;
      names += (names.empty() ? "" : ", ") + name_of(readings, components[i]);
    }
    result.status = DecouplingStatus::combination_only;
    result.message = fmt::format(
        "only a combination of {} is seen; more probes, or probes that do not stand on one line, tell them apart",
        names);
    return {};
  }
  for (std::size_t c : components) result.seen[c] = true;
  return components;
}

/// Something taken out of the stacked values of some components: values - functions (pick values).
struct DatumTerm {
  std::vector<std::size_t> components;
  Eigen::MatrixXd functions;  // [components * m, r]
  Eigen::MatrixXd pick;       // [r, components * m]
};

DatumTerm least_squares_term(std::vector<std::size_t> components, Eigen::MatrixXd functions) {
  DatumTerm term{std::move(components), std::move(functions), {}};
  term.pick = CompleteOrthogonal(term.functions).pseudo_inverse();
  return term;
}

std::vector<DatumTerm> linear_datum(const AxisIndications& readings, const Decoupling& result, AngleDatum datum) {
  const Eigen::Index m = static_cast<Eigen::Index>(readings.positions.size());
  std::vector<DatumTerm> terms;
  for (std::size_t c = 0; c < 3; ++c) {
    if (!result.seen[c] || c == readings.direction) continue;
    Eigen::MatrixXd line(m, 2);
    line.col(0).setOnes();
    line.col(1) = Eigen::Map<const Eigen::VectorXd>(readings.positions.data(), m);
    terms.push_back(least_squares_term({c}, line));
  }
  for (std::size_t c = 3; c < kComponentCount; ++c) {
    if (!result.seen[c] || datum == AngleDatum::as_indicated) continue;
    DatumTerm term{{c}, Eigen::MatrixXd::Ones(m, 1), Eigen::MatrixXd::Zero(1, m)};
    if (datum == AngleDatum::zero_at_first_position) {
      term.pick(0, 0) = 1;
    } else {
      term.pick.setConstant(1 / static_cast<double>(m));
    }
    terms.push_back(term);
  }
  return terms;
}

std::vector<DatumTerm> rotary_datum(const AxisIndications& readings, const Decoupling& result) {
  const Eigen::Index m = static_cast<Eigen::Index>(readings.positions.size());
  std::vector<DatumTerm> terms;
  if (result.seen[readings.direction]) {
    terms.push_back(least_squares_term({readings.direction}, Eigen::MatrixXd::Ones(m, 1)));
  }
  for (std::size_t kind = 0; kind < 2; ++kind) {
    // Turning by a carries the first of these directions to the second: (cos a, sin a).
    const std::size_t first = 3 * kind + (readings.direction + 1) % 3, second = 3 * kind + (readings.direction + 2) % 3;
    std::vector<std::size_t> seen;
    for (std::size_t c : {first, second}) {
      if (result.seen[c]) seen.push_back(c);
    }
    if (seen.empty()) continue;
    const Eigen::Index count = static_cast<Eigen::Index>(seen.size());
    Eigen::MatrixXd functions = Eigen::MatrixXd::Zero(count * m, count + 2);
    for (Eigen::Index s = 0; s < count; ++s) {
      for (Eigen::Index i = 0; i < m; ++i) {
        const double angle = readings.sense * readings.positions[static_cast<std::size_t>(i)];
        const bool is_first = seen[static_cast<std::size_t>(s)] == first;
        functions(s * m + i, s) = 1;
        functions(s * m + i, count) = is_first ? std::cos(angle) : std::sin(angle);
        functions(s * m + i, count + 1) = is_first ? -std::sin(angle) : std::cos(angle);
      }
    }
    terms.push_back(least_squares_term(seen, functions));
  }
  return terms;
}

/// Applies a term to the rows that belong to its components.
void take_out(const DatumTerm& term, Eigen::Index m, Eigen::MatrixXd& values) {
  Eigen::MatrixXd stacked(term.pick.cols(), values.cols());
  for (std::size_t s = 0; s < term.components.size(); ++s) {
    stacked.middleRows(static_cast<Eigen::Index>(s) * m, m) =
        values.middleRows(static_cast<Eigen::Index>(term.components[s]) * m, m);
  }
  const Eigen::MatrixXd kept = stacked - term.functions * (term.pick * stacked);
  for (std::size_t s = 0; s < term.components.size(); ++s) {
    values.middleRows(static_cast<Eigen::Index>(term.components[s]) * m, m) =
        kept.middleRows(static_cast<Eigen::Index>(s) * m, m);
  }
}

void note_removed(const DatumTerm& term, const Eigen::VectorXd& coefficients, Decoupling& result) {
  const std::size_t count = term.components.size();
  for (std::size_t s = 0; s < count; ++s) {
    std::vector<double>& removed = result.removed[term.components[s]];
    removed.push_back(coefficients[static_cast<Eigen::Index>(s)]);
    for (Eigen::Index r = static_cast<Eigen::Index>(count); r < coefficients.size(); ++r) {
      removed.push_back(coefficients[r]);
    }
  }
}

void note_unseen(const AxisIndications& readings, Decoupling& result) {
  for (std::size_t c = 0; c < kComponentCount; ++c) {
    if (result.seen[c]) continue;
    const bool own = c % 3 == readings.direction;
    std::string remedy;
    if (readings.kind == AxisKind::rotary && c >= 3 && own) {
      remedy = "a polygon with autocollimator or an angle encoder on the axis";
    } else if (c < 3) {
      remedy = own ? "a laser interferometer or a dial along the axis" : "a probe in that direction";
    } else if (readings.kind == AxisKind::rotary) {
      remedy = "probes at two places along the mandrel";
    } else {
      remedy = own ? "probes at two places across the motion" : "probes at two places along the motion at once";
    }
    result.notes.push_back(fmt::format("{} is not seen; it takes {}", name_of(readings, c), remedy));
  }
}

}  // namespace

double Decoupling::standard_uncertainty(Component component, std::size_t position) const {
  const Eigen::Index at = static_cast<Eigen::Index>(static_cast<std::size_t>(component) * positions.size() + position);
  return std::sqrt(std::max(0.0, covariance(at, at)));
}

Decoupling decouple_indications(const AxisIndications& readings, AngleDatum datum) {
  check(readings);
  Decoupling result;
  result.positions = readings.positions;
  const Eigen::MatrixXd d = design(readings);
  const std::vector<std::size_t> components = find_components(readings, d, result);
  if (components.empty()) return result;
  const bool linear = readings.kind == AxisKind::linear;
  // A line through two straightness readings, or a circle through two radial ones, leaves nothing.
  const Eigen::Index m = static_cast<Eigen::Index>(readings.positions.size());
  if (m < 3) {
    result.status = DecouplingStatus::too_few_positions;
    result.message = fmt::format("{} positions; at least 3 are needed to separate the errors from their datum", m);
    return result;
  }

  const Eigen::Index k = static_cast<Eigen::Index>(readings.probes.size());
  const Eigen::Index q = static_cast<Eigen::Index>(components.size());
  Eigen::VectorXd weight(k);
  for (Eigen::Index i = 0; i < k; ++i) {
    weight[i] = std::pow(readings.probes[static_cast<std::size_t>(i)].standard_uncertainty, -2);
  }
  const Eigen::MatrixXd seen = columns_of(d, components);
  // Columns of mm beside columns of mm/rad: scaled before the normal equations.
  const Eigen::VectorXd scale = (weight.cwiseSqrt().asDiagonal() * seen).colwise().norm().cwiseInverse();
  const Eigen::MatrixXd scaled = seen * scale.asDiagonal();
  const Eigen::MatrixXd inverse =
      Ldlt<>(scaled.transpose() * weight.asDiagonal() * scaled).solve_columns(Eigen::MatrixXd::Identity(q, q));
  const Eigen::MatrixXd one_position = scale.asDiagonal() * inverse * scale.asDiagonal();  // covariance, [q, q]
  const Eigen::MatrixXd solve = one_position * seen.transpose() * weight.asDiagonal();     // [q, k]

  const Eigen::MatrixXd estimate = readings.indications * solve.transpose();  // [m, q]
  const Eigen::MatrixXd misfit = readings.indications - estimate * seen.transpose();
  result.probe_offset = misfit.colwise().mean();
  result.chi_square =
      ((misfit.rowwise() - result.probe_offset.transpose()) * weight.cwiseSqrt().asDiagonal()).squaredNorm();
  result.degrees_of_freedom = static_cast<std::size_t>((m - 1) * (k - q));

  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(kComponentCount * m, 1);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(kComponentCount * m, kComponentCount * m);
  for (Eigen::Index a = 0; a < q; ++a) {
    const Eigen::Index row = static_cast<Eigen::Index>(components[static_cast<std::size_t>(a)]) * m;
    values.col(0).segment(row, m) = estimate.col(a);
    for (Eigen::Index b = 0; b < q; ++b) {
      const Eigen::Index column = static_cast<Eigen::Index>(components[static_cast<std::size_t>(b)]) * m;
      covariance.block(row, column, m, m).diagonal().setConstant(one_position(a, b));
    }
  }
  for (const DatumTerm& term : linear ? linear_datum(readings, result, datum) : rotary_datum(readings, result)) {
    if (term.functions.rows() <= term.functions.cols()) {
      result.status = DecouplingStatus::too_few_positions;
      result.message = fmt::format("{} positions; the datum removes everything that is seen of {}", m,
                                   name_of(readings, term.components.front()));
      result.seen.fill(false);
      return result;
    }
    Eigen::VectorXd stacked(term.pick.cols());
    for (std::size_t s = 0; s < term.components.size(); ++s) {
      stacked.segment(static_cast<Eigen::Index>(s) * m, m) =
          values.col(0).segment(static_cast<Eigen::Index>(term.components[s]) * m, m);
    }
    note_removed(term, term.pick * stacked, result);
    take_out(term, m, values);
    take_out(term, m, covariance);
    covariance.transposeInPlace();
    take_out(term, m, covariance);
  }
  result.errors = values.reshaped(m, kComponentCount);
  result.covariance = 0.5 * (covariance + covariance.transpose());
  note_unseen(readings, result);
  const double span = readings.positions.back() - readings.positions.front();
  if (!linear && span < std::numbers::pi) {
    result.notes.push_back(
        fmt::format("over {:.0f} deg of travel, removing the eccentricity of the mandrel also removes part of the slow "
                    "error motion",
                    span / kDegree));
  }
  result.status = DecouplingStatus::ok;
  return result;
}

Eigen::MatrixXd exact_indications(const AxisIndications& readings, const Eigen::MatrixXd& errors) {
  const Eigen::Index m = static_cast<Eigen::Index>(readings.positions.size());
  const Eigen::Index k = static_cast<Eigen::Index>(readings.probes.size());
  if (errors.rows() != m || errors.cols() != kComponentCount) {
    throw std::invalid_argument("errors are not one row per position and six columns");
  }
  Eigen::MatrixXd indications(m, k);
  for (Eigen::Index i = 0; i < m; ++i) {
    Eigen::Vector3d angles = errors.row(i).tail<3>();
    if (readings.kind == AxisKind::rotary) angles[static_cast<Eigen::Index>(readings.direction)] = 0;
    const Eigen::Matrix3d turn = rotation_from_error_angles(angles) - Eigen::Matrix3d::Identity();
    for (Eigen::Index j = 0; j < k; ++j) {
      const DisplacementProbe& probe = readings.probes[static_cast<std::size_t>(j)];
      indications(i, j) = probe.direction.dot(errors.row(i).head<3>().transpose() + turn * probe.place);
    }
  }
  return indications;
}

}  // namespace abbe
