#include "abbe/instruments/polygon/polygon_separation.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/singular_values.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Relative singular values below are zero: rounding is at 1e-15, what the geometry sees weakly above 1e-6.
constexpr double kZero = 1e-10;
/// A gauge equation is taken if at least this part of it lies in what is still open.
constexpr double kOpenPart = 1e-3;
constexpr int kMaximumSeparationIterations = 30;

VectorXd column_scale(const MatrixXd& jacobian) {
  return jacobian.colwise().norm().transpose().unaryExpr([](double norm) { return norm > 0 ? norm : 1.0; });
}

MatrixXd weighted_jacobian(const PolygonCampaign& campaign, const PolygonNoise& noise, VectorXd* readings = nullptr) {
  MatrixXd jacobian;
  const VectorXd modelled = campaign_readings(campaign, &jacobian);
  if (readings) *readings = modelled;
  return reading_uncertainties(campaign, noise).cwiseInverse().asDiagonal() * jacobian;
}

struct Candidates {
  const PolygonCampaign& campaign;
  PolygonColumns columns = polygon_columns(campaign);
  std::vector<PolygonGaugeEquation> list{};

  VectorXd& add(std::string words) {
    list.push_back({std::move(words), VectorXd::Zero(columns.count)});
    return list.back().functional;
  }
  void motions() {
    const char* names[] = {"EAC", "EBC", "ECC", "EXC", "EYC", "EZC"};
    const Index steps = static_cast<Index>(campaign.steps());
    for (Index i = 0; i < 6; ++i) {
      VectorXd& f = add(fmt::format("mean of {} over the turn is zero", names[i]));
      for (Index k = 0; k < steps; ++k) f[6 * k + i] = 1;
    }
    for (const Index first : {Index{0}, Index{3}}) {
      for (const bool quarter : {false, true}) {
        VectorXd& f = add(fmt::format("once-per-turn part of ({}, {}) that turns with the table is zero, {} component",
                                      names[first], names[first + 1], quarter ? "sine" : "cosine"));
        for (Index k = 0; k < steps; ++k) {
          const double angle = campaign.position(static_cast<std::size_t>(k), 0).angle;
          const double c = std::cos(angle), s = std::sin(angle);
          f[6 * k + first] = quarter ? -s : c;
          f[6 * k + first + 1] = quarter ? c : s;
        }
      }
    }
  }
  void faces() {
    const char* names[] = {"azimuth error", "tilt", "distance error"};
    const Index count = static_cast<Index>(campaign.polygon.faces.size());
    for (Index i = 0; i < 3; ++i) {
      VectorXd& f = add(fmt::format("mean {} of the faces is zero", names[i]));
      for (Index j = 0; j < count; ++j) f[columns.faces + 3 * j + i] = 1;
    }
    for (const Index i : {Index{1}, Index{2}}) {
      for (const bool sine : {false, true}) {
        VectorXd& f =
            add(fmt::format("once-per-turn part of the faces' {} is zero, {}", names[i], sine ? "sine" : "cosine"));
        for (Index j = 0; j < count; ++j) {
          const double azimuth = campaign.polygon.faces[static_cast<std::size_t>(j)].azimuth;
          f[columns.faces + 3 * j + i] = sine ? std::sin(azimuth) : std::cos(azimuth);
        }
      }
    }
  }
  void single(Index first, Index last) {
    const std::vector<PolygonUnknown> unknowns = polygon_unknowns(campaign);
    for (Index i = first; i < last; ++i) add(unknowns[static_cast<std::size_t>(i)].name + " is zero")[i] = 1;
  }
};

}  // namespace

PolygonObservability polygon_observability(const PolygonCampaign& campaign, const PolygonNoise& noise) {
  const MatrixXd jacobian = weighted_jacobian(campaign, noise);
  const VectorXd scale = column_scale(jacobian);
  const RightSingular svd = right_singular(jacobian * scale.cwiseInverse().asDiagonal());
  PolygonObservability result;
  result.unknowns = static_cast<std::size_t>(jacobian.cols());
  result.readings = static_cast<std::size_t>(jacobian.rows());
  result.singular_values = svd.values / svd.values[0];
  while (result.rank < static_cast<std::size_t>(result.singular_values.size()) &&
         result.singular_values[static_cast<Index>(result.rank)] > kZero) {
    ++result.rank;
  }
  result.unseen =
      scale.cwiseInverse().asDiagonal() * svd.vectors.rightCols(jacobian.cols() - static_cast<Index>(result.rank));
  return result;
}

std::vector<PolygonGaugeEquation> polygon_gauge(const PolygonCampaign& nominal,
                                                const PolygonObservability& observability) {
  Candidates candidates{nominal};
  const PolygonColumns& c = candidates.columns;
  candidates.motions();
  candidates.faces();
  candidates.single(c.top, c.zeros);
  candidates.single(c.mounts, c.faces);
  candidates.single(c.faces, c.top);
  candidates.single(c.zeros, c.count);
  candidates.single(c.motions, c.mounts);

  // Angles and lengths are compared as the column scale compares them: by what a reading sees of them.
  const VectorXd scale = column_scale(weighted_jacobian(nominal, {}));
  const Index q = observability.unseen.cols();
  const MatrixXd open = scale.asDiagonal() * observability.unseen;  // orthonormal
  MatrixXd taken(q, 0);
  std::vector<PolygonGaugeEquation> gauge;
  for (PolygonGaugeEquation& candidate : candidates.list) {
    if (taken.cols() == q) break;
    const VectorXd scaled = candidate.functional.cwiseQuotient(scale);
    VectorXd part = open.transpose() * scaled / scaled.norm();
    for (int pass = 0; pass < 2; ++pass) part -= taken * (taken.transpose() * part);
    if (part.norm() < kOpenPart) continue;
    taken.conservativeResize(q, taken.cols() + 1);
    taken.rightCols(1) = part.normalized();
    gauge.push_back(std::move(candidate));
  }
  return gauge;
}

namespace {

MatrixXd functionals(const std::vector<PolygonGaugeEquation>& gauge, Index unknowns) {
  MatrixXd rows(static_cast<Index>(gauge.size()), unknowns);
  for (std::size_t i = 0; i < gauge.size(); ++i) rows.row(static_cast<Index>(i)) = gauge[i].functional;
  return rows;
}

}  // namespace

VectorXd in_gauge(const VectorXd& values, const PolygonObservability& observability,
                  const std::vector<PolygonGaugeEquation>& gauge) {
  if (gauge.empty()) return values;
  const MatrixXd rows = functionals(gauge, values.size());
  const MatrixXd crossing = rows * observability.unseen;
  return values - observability.unseen * FullLu<>(crossing).solve(rows * values);
}

PolygonSeparation separate_polygon(const PolygonCampaign& nominal, const VectorXd& readings, const PolygonNoise& noise,
                                   const std::vector<PolygonGaugeEquation>& gauge) {
  assert(readings.size() == static_cast<Index>(nominal.reading_count()));
  PolygonSeparation result;
  const VectorXd weights = reading_uncertainties(nominal, noise).cwiseInverse();
  const Index unknowns = polygon_columns(nominal).count, free = unknowns - static_cast<Index>(gauge.size());
  result.values = VectorXd::Zero(unknowns);
  VectorXd scale;
  MatrixXd directions;  // of the solutions of the gauge equations
  double last_step = std::numeric_limits<double>::infinity();
  for (result.iterations = 1; result.iterations <= kMaximumSeparationIterations; ++result.iterations) {
    VectorXd modelled;
    const MatrixXd jacobian = weighted_jacobian(with_values(nominal, result.values), noise, &modelled);
    if (result.iterations == 1) {
      scale = column_scale(jacobian);
      const MatrixXd rows = functionals(gauge, unknowns) * scale.cwiseInverse().asDiagonal();
      const MatrixXd basis = Qr(rows.transpose()).orthonormal(unknowns);
      directions = scale.cwiseInverse().asDiagonal() * basis.rightCols(free);
    }
    const VectorXd residual = weights.cwiseProduct(readings - modelled);
    result.chi_square = residual.squaredNorm();
    if (!std::isfinite(result.chi_square)) {
      result.status = PolygonSeparationStatus::not_converged;
      return result;
    }
    PivotedQr solver(jacobian * directions);
    solver.set_threshold(kZero);
    if (solver.rank() < free) {
      result.status = PolygonSeparationStatus::rank_deficient;
      return result;
    }
    const VectorXd step = solver.solve(residual);
    result.values += directions * step;
    const MatrixXd factor = solver.upper(free);
    // In standard uncertainties: rounding is far below a thousandth of one.
    const double size = (factor * (solver.columns().transpose() * step)).norm();
    if (size < 1e-6 || (size < 1e-3 && size > 0.5 * last_step)) {
      const MatrixXd inverse = factor.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(free, free)).eval();
      const MatrixXd spread = directions * (solver.columns() * inverse);
      result.standard_uncertainties = spread.rowwise().norm();
      result.degrees_of_freedom = static_cast<std::size_t>(readings.size() - free);
      result.chi_square =
          weights.cwiseProduct(readings - campaign_readings(with_values(nominal, result.values))).squaredNorm();
      result.status = PolygonSeparationStatus::converged;
      return result;
    }
    last_step = size;
  }
  result.status = PolygonSeparationStatus::not_converged;
  return result;
}

}  // namespace abbe
