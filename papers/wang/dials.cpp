#include "wang/dials.h"

#include <algorithm>
#include <cmath>

#include "abbe/errors/poses.h"
#include "abbe/errors/random_stream.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/decompositions.h"
#include "wang/integrated.h"
#include "wang/study.h"
#include "wang/tables.h"

namespace abbe {
namespace {

constexpr double kMillidegree = 1e-3 * kDegree;
constexpr double kAngleStandardUncertainty = 0.5 * kArcsec;
constexpr std::size_t kMeasuredRows = 11;

/// [rows, 6] mm, rad of one table.
Eigen::MatrixXd table_errors(std::size_t table, std::size_t rows, double angle_unit) {
  Eigen::MatrixXd errors(static_cast<Eigen::Index>(rows), 6);
  for (std::size_t i = 0; i < rows; ++i) {
    const WangRow& row = wang_row(table, i);
    errors.row(static_cast<Eigen::Index>(i)) << 1e-3 * row.dx, 1e-3 * row.dy, 1e-3 * row.dz, angle_unit * row.ex,
        angle_unit * row.ey, angle_unit * row.ez;
  }
  return errors;
}

std::vector<double> table_positions(std::size_t table, std::size_t rows) {
  std::vector<double> positions;
  for (std::size_t i = 0; i < rows; ++i) positions.push_back(wang_row(table, i).position * (table < 3 ? 1 : kDegree));
  return positions;
}

void add_probe(AxisIndications& readings, std::size_t normal, const Eigen::Vector3d& place, double uncertainty) {
  readings.probes.push_back({Eigen::Vector3d::Unit(static_cast<Eigen::Index>(normal)), place, uncertainty});
}

AxisIndications set_up(std::size_t table) {
  AxisIndications readings;
  readings.kind = table < 3 ? AxisKind::linear : AxisKind::rotary;
  readings.direction = table % 3;
  readings.positions = table_positions(table, kMeasuredRows);
  const std::size_t next = (readings.direction + 1) % 3, after = (readings.direction + 2) % 3;
  const Eigen::Vector3d along = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(readings.direction));
  const auto across = [](std::size_t direction, double at) -> Eigen::Vector3d {
    return at * Eigen::Vector3d::Unit(static_cast<Eigen::Index>(direction));
  };
  if (readings.kind == AxisKind::linear) {
    for (const double u : {-60.0, 60.0}) {
      for (const double v : {-40.0, 40.0})
        add_probe(readings, after, u * along + across(next, v), kWangDialUncertainty);
    }
    add_probe(readings, next, -60 * along + across(after, -40), kWangDialUncertainty);
    add_probe(readings, next, 60 * along + across(after, -40), kWangDialUncertainty);
    add_probe(readings, next, across(after, 40), kWangDialUncertainty);
  } else {
    for (const std::size_t side : {next, after}) {
      for (const double height : {20.0, 170.0}) {
        add_probe(readings, side, height * along + across(side, 15), kWangDialUncertainty);
      }
    }
  }
  add_probe(readings, readings.direction, Eigen::Vector3d::Zero(), kWangLaserUncertainty);
  return readings;
}

/// What zeros of the dials, inclined faces and the mandrel add.
void add_setting(AxisIndications& readings) {
  const std::size_t after = (readings.direction + 2) % 3;
  const Eigen::Index along = static_cast<Eigen::Index>(readings.direction);
  for (std::size_t i = 0; i < readings.positions.size(); ++i) {
    for (std::size_t j = 0; j + 1 < readings.probes.size(); ++j) {
      const DisplacementProbe& probe = readings.probes[j];
      double& indication = readings.indications(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      const bool is_after = probe.direction[static_cast<Eigen::Index>(after)] != 0;
      indication += (is_after ? 0.05 : -0.02) + 0.003 * static_cast<double>(j);
      if (readings.kind == AxisKind::linear) {
        indication += (is_after ? 30e-6 : -20e-6) * (readings.positions[i] + probe.place[along]);
        continue;
      }
      const double c = std::cos(readings.positions[i]), s = std::sin(readings.positions[i]);
      const double e = 0.012 + 4e-5 * probe.place[along], f = -0.007 + 2e-5 * probe.place[along];
      indication += is_after ? e * s + f * c : e * c - f * s;
    }
  }
}

/// Takes the least-squares combination of functions out of a vector.
Eigen::VectorXd without(const Eigen::MatrixXd& functions, const Eigen::VectorXd& values) {
  return values - functions * PivotedQr(functions).solve(values);
}

/// The truth with the datum of the decoupling, by a way of its own.
Eigen::MatrixXd with_datum(const AxisIndications& readings, const Eigen::MatrixXd& errors) {
  const Eigen::Index d = static_cast<Eigen::Index>(readings.direction), m = errors.rows();
  Eigen::MatrixXd truth = errors;
  if (readings.kind == AxisKind::linear) {
    for (const Eigen::Index c : {(d + 1) % 3, (d + 2) % 3})
      truth.col(c) = without_line(readings.positions, errors.col(c));
    for (Eigen::Index c = 3; c < 6; ++c) truth.col(c).array() -= errors(0, c);
    return truth;
  }
  truth.col(d).array() -= errors.col(d).mean();
  truth.col(3 + d).setZero();
  for (const Eigen::Index kind : {0, 3}) {
    const Eigen::Index first = kind + (d + 1) % 3, second = kind + (d + 2) % 3;
    // Complex numbers: first + i second without a constant and without what turns with the axis.
    Eigen::MatrixXd functions = Eigen::MatrixXd::Zero(2 * m, 4);
    for (Eigen::Index i = 0; i < m; ++i) {
      const double a = readings.positions[static_cast<std::size_t>(i)];
      functions.row(2 * i) << 1, 0, std::cos(a), -std::sin(a);
      functions.row(2 * i + 1) << 0, 1, std::sin(a), std::cos(a);
    }
    Eigen::VectorXd both(2 * m);
    for (Eigen::Index i = 0; i < m; ++i) {
      both[2 * i] = errors(i, first);
      both[2 * i + 1] = errors(i, second);
    }
    const Eigen::VectorXd left = without(functions, both);
    for (Eigen::Index i = 0; i < m; ++i) {
      truth(i, first) = left[2 * i];
      truth(i, second) = left[2 * i + 1];
    }
  }
  return truth;
}

/// Readings of an angle standard on a rotary axis, zero at the first position.
Decoupling angle_standard(const AxisIndications& readings, const Eigen::MatrixXd& errors, RandomStream* random) {
  const std::size_t c = 3 + readings.direction;
  const Eigen::Index m = errors.rows(), column = static_cast<Eigen::Index>(c);
  Decoupling found;
  found.status = DecouplingStatus::ok;
  found.positions = readings.positions;
  found.seen[c] = true;
  found.errors = Eigen::MatrixXd::Zero(m, 6);
  found.errors.col(column) = errors.col(column);
  if (random != nullptr) {
    for (double& value : found.errors.col(column)) value += kAngleStandardUncertainty * random->normal();
  }
  found.errors.col(column).array() -= double{found.errors(0, column)};
  found.covariance = Eigen::MatrixXd::Zero(6 * m, 6 * m);
  const double variance = kAngleStandardUncertainty * kAngleStandardUncertainty;
  auto block = found.covariance.block(column * m, column * m, m, m);
  block.bottomRightCorner(m - 1, m - 1).setConstant(variance);
  block.bottomRightCorner(m - 1, m - 1).diagonal().array() += variance;
  return found;
}

double root_mean_square(const Eigen::VectorXd& v) { return std::sqrt(v.squaredNorm() / static_cast<double>(v.size())); }

}  // namespace

double WangDialAxis::largest_standard_uncertainty(std::size_t component) const {
  double largest = 0;
  for (std::size_t i = 0; i < with_noise.positions.size(); ++i) {
    largest = std::max(largest, with_noise.standard_uncertainty(static_cast<Component>(component), i));
  }
  return largest;
}

WangDialStudy wang_dial_study(std::uint64_t seed) {
  const Machine machine = wang_machine();
  WangDialStudy study;
  std::vector<DecoupledAxis> without_noise, with_noise;
  for (std::size_t table = 0; table < 6; ++table) {
    RandomStream random(seed, table);
    WangDialAxis axis;
    axis.table = table;
    axis.readings = set_up(table);
    const Eigen::MatrixXd errors = table_errors(table, kMeasuredRows, kMillidegree);
    axis.truth = with_datum(axis.readings, errors);
    axis.readings.indications = exact_indications(axis.readings, errors);
    add_setting(axis.readings);
    axis.without_noise = decouple_indications(axis.readings, AngleDatum::zero_at_first_position);
    const Eigen::MatrixXd bias = axis.without_noise.errors - axis.truth;
    axis.bias_mm = bias.leftCols(3).cwiseAbs().maxCoeff();
    axis.bias_rad = bias.rightCols(3).cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < axis.readings.indications.rows(); ++i) {
      for (Eigen::Index j = 0; j < axis.readings.indications.cols(); ++j) {
        axis.readings.indications(i, j) +=
            axis.readings.probes[static_cast<std::size_t>(j)].standard_uncertainty * random.normal();
      }
    }
    axis.with_noise = decouple_indications(axis.readings, AngleDatum::zero_at_first_position);
    for (std::size_t c = 0; c < 6; ++c) {
      if (!axis.with_noise.seen[c]) continue;
      ++study.seen_by_dials;
      for (std::size_t i = 0; i < kMeasuredRows; ++i) {
        const double u = axis.with_noise.standard_uncertainty(static_cast<Component>(c), i);
        if (!(u > 0)) continue;
        const Eigen::Index row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(c);
        ++study.values;
        study.inside += std::abs(axis.with_noise.errors(row, column) - axis.without_noise.errors(row, column)) <= 2 * u;
      }
    }
    const std::size_t index = machine.find_axis(kWangAxisNames[table]);
    without_noise.push_back({index, axis.without_noise});
    with_noise.push_back({index, axis.with_noise});
    if (table >= 3) {
      without_noise.push_back({index, angle_standard(axis.readings, errors, nullptr)});
      with_noise.push_back({index, angle_standard(axis.readings, errors, &random)});
    }
    study.axes.push_back(std::move(axis));
  }
  study.without_noise = decoupled_errors(without_noise);
  study.with_noise = decoupled_errors(with_noise);
  return study;
}

WangDialMap wang_dial_map(const WangDialStudy& study) {
  PoseGrid grid;
  for (const Axis& axis : wang_machine().axes) {
    const std::size_t table = static_cast<std::size_t>(
        std::find(std::begin(kWangAxisNames), std::end(kWangAxisNames), axis.name) - std::begin(kWangAxisNames));
    const std::vector<double> positions = table_positions(table, kMeasuredRows);
    grid.values.push_back({positions[1], positions[5], positions[9]});
  }
  const PoseList poses = wang_poses_of(grid);
  const Eigen::MatrixXd& covariance = study.with_noise.covariance;
  const WangMap map = wang_map(study.with_noise.errors, poses, &covariance);
  const WangMap without_noise = wang_map(study.without_noise.errors, poses);
  WangDialMap result;
  result.poses = map.norm.size();
  result.norm = map.statistics;
  result.uncertainty = sample_statistics(map.norm_uncertainty);
  std::size_t inside = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    for (std::size_t k = 0; k < map.norm.size(); ++k)
      inside += std::abs(map.error[d][k] - without_noise.error[d][k]) <= 2 * map.uncertainty[d][k];
  }
  result.inside = static_cast<double>(inside) / static_cast<double>(3 * map.norm.size());

  PoseList zero;
  zero.append(wang_zero_pose());
  const WangMap at_zero = wang_map(study.with_noise.errors, zero, &covariance);
  for (std::size_t d = 0; d < 3; ++d) {
    result.zero_pose[static_cast<Eigen::Index>(d)] = at_zero.error[d][0];
    result.zero_pose_uncertainty[static_cast<Eigen::Index>(d)] = at_zero.uncertainty[d][0];
  }
  return result;
}

std::vector<WangGridComparison> wang_grid_comparison() {
  std::vector<WangGridComparison> comparisons;
  for (std::size_t table = 0; table < 3; ++table) {
    // With the printed 12th row, as in tests/golden/wang; straightness without its line.
    const Eigen::Index m = 12, d = static_cast<Eigen::Index>(table), next = (d + 1) % 3, after = (d + 2) % 3;
    const Eigen::MatrixXd errors = table_errors(table, 12, kMillidegree);
    DialGrid second{table_positions(table, 12), {0, 30, 60, 90, 120}, Eigen::MatrixXd(m, 5)};
    DialGrid first{second.positions, {0, 25, 50, 75, 100}, Eigen::MatrixXd(m, 5)};
    const Eigen::VectorXd straight_second = without_line(second.positions, errors.col(after));
    const Eigen::VectorXd straight_first = without_line(second.positions, errors.col(next));
    const Eigen::VectorXd roll = errors.col(3 + d);
    for (Eigen::Index i = 0; i < m; ++i) {
      const double x = second.positions[static_cast<std::size_t>(i)];
      for (std::size_t j = 0; j < 5; ++j) {
        const Eigen::Index column = static_cast<Eigen::Index>(j);
        second.indications(i, column) = 0.05 + 30e-6 * x + straight_second[i] + roll[i] * second.across[j];
        first.indications(i, column) = -0.02 - 20e-6 * x + straight_first[i] - roll[i] * first.across[j];
      }
    }
    const DialGridAsPrinted printed = decouple_grids_as_printed(second, first);
    const Decoupling correct = decouple_indications(indications_of_grids(table, second, first, kWangDialUncertainty));
    WangGridComparison comparison;
    comparison.axis = kWangAxisNames[table];
    comparison.dial_range_mm = 1000 * roll.cwiseAbs().maxCoeff() * 120;
    comparison.printed_second = root_mean_square(printed.straightness_z - straight_second);
    comparison.printed_first = root_mean_square(printed.straightness_y - straight_first);
    comparison.printed_roll = root_mean_square(printed.roll - roll);
    comparison.printed_pitch = printed.pitch;
    comparison.printed_yaw = printed.yaw;
    comparison.true_pitch = errors(0, 3 + next);
    comparison.true_yaw = errors(0, 3 + after);
    comparison.correct_second = root_mean_square(correct.errors.col(after) - straight_second);
    comparison.correct_first = root_mean_square(correct.errors.col(next) - straight_first);
    comparison.correct_roll = root_mean_square(correct.errors.col(3 + d) - roll);
    comparisons.push_back(comparison);
  }
  return comparisons;
}

}  // namespace abbe
