#include "abbe/identify/linkage/dial_grid.h"

#include <Eigen/QR>
#include <stdexcept>

namespace abbe {

RowFit fit_rows(const DialGrid& grid, double reference) {
  const Eigen::Index m = static_cast<Eigen::Index>(grid.positions.size());
  const Eigen::Index n = static_cast<Eigen::Index>(grid.across.size());
  if (grid.indications.rows() != m || grid.indications.cols() != n || m == 0 || n < 2) {
    throw std::invalid_argument("grid without one row per position and one column per place, two at least");
  }
  const Eigen::VectorXd across = Eigen::Map<const Eigen::VectorXd>(grid.across.data(), n);
  const Eigen::VectorXd from_mean = across.array() - across.mean();
  RowFit fit;
  fit.spread = from_mean.squaredNorm();
  if (!(fit.spread > 0)) throw std::invalid_argument("all places across the motion are the same");
  fit.slope = grid.indications * from_mean / fit.spread;
  fit.at_reference = grid.indications.rowwise().mean() + fit.slope * (reference - across.mean());
  return fit;
}

Eigen::VectorXd without_line(const std::vector<double>& positions, const Eigen::VectorXd& values) {
  const Eigen::Index m = static_cast<Eigen::Index>(positions.size());
  if (m < 3 || values.size() != m) throw std::invalid_argument("a line takes at least three positions");
  const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(positions.data(), m);
  const Eigen::VectorXd from_mean = x.array() - x.mean();
  const double spread = from_mean.squaredNorm();
  if (!(spread > 0)) throw std::invalid_argument("all positions are the same");
  const double slope = from_mean.dot(values) / spread;
  return (values.array() - values.mean()).matrix() - slope * from_mean;
}

Eigen::VectorXd roll_of_rows(const RowFit& second, const RowFit& first) {
  if (second.slope.size() != first.slope.size()) throw std::invalid_argument("grids with different positions");
  return (second.spread * second.slope - first.spread * first.slope) / (second.spread + first.spread);
}

AxisIndications indications_of_grids(std::size_t direction, const DialGrid& second, const DialGrid& first,
                                     double standard_uncertainty) {
  if (second.positions != first.positions) throw std::invalid_argument("grids with different positions");
  AxisIndications readings;
  readings.direction = direction;
  readings.positions = second.positions;
  const std::size_t next = (direction + 1) % 3, after = (direction + 2) % 3;
  const auto add = [&](const DialGrid& grid, std::size_t normal, std::size_t across) {
    for (const double place : grid.across) {
      DisplacementProbe probe;
      probe.direction = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(normal));
      probe.place[static_cast<Eigen::Index>(across)] = place;
      probe.standard_uncertainty = standard_uncertainty;
      readings.probes.push_back(probe);
    }
  };
  add(second, after, next);
  add(first, next, after);
  readings.indications.resize(second.indications.rows(), second.indications.cols() + first.indications.cols());
  readings.indications << second.indications, first.indications;
  return readings;
}

}  // namespace abbe
