#include "abbe/identify/weighed_observations.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace abbe {
namespace {

/// Readings of the poses of a block that stand outside the block, evaluated as the block is. Kept by each thread.
struct ReadingsOutside {
  std::vector<std::size_t> readings;  ///< ascending
  std::vector<double> residuals, jacobian;
  std::vector<double> run_residuals, run_jacobian;

  std::size_t place(std::size_t reading) const {
    return static_cast<std::size_t>(std::lower_bound(readings.begin(), readings.end(), reading) - readings.begin());
  }

  void evaluate(const Observations& observations, std::span<const std::size_t> machine_parameters,
                std::span<const std::size_t> setup_parameters, bool derivatives) {
    const std::size_t rows = static_cast<std::size_t>(observations.rows()), length = rows * readings.size();
    const std::size_t columns = derivatives ? machine_parameters.size() + setup_parameters.size() : 0;
    residuals.resize(length);
    jacobian.resize(columns * length);
    for (std::size_t begin = 0; begin < readings.size();) {
      std::size_t end = begin + 1;
      while (end < readings.size() && end - begin < Observations::kBlockSize && readings[end] == readings[end - 1] + 1)
        ++end;
      const std::size_t n = end - begin;
      run_residuals.resize(rows * n);
      run_jacobian.resize(std::max<std::size_t>(1, columns * rows * n));
      observations.evaluate(readings[begin], n, machine_parameters, setup_parameters, run_residuals.data(),
                            derivatives ? run_jacobian.data() : nullptr, rows * n);
      for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t k = 0; k < n; ++k) {
          const std::size_t to = row * readings.size() + begin + k;
          residuals[to] = run_residuals[row * n + k];
          for (std::size_t c = 0; c < columns; ++c) jacobian[c * length + to] = run_jacobian[(c * rows + row) * n + k];
        }
      begin = end;
    }
  }
};

ReadingsOutside& readings_outside() {
  thread_local ReadingsOutside memory;
  return memory;
}

}  // namespace

WeighedObservations::WeighedObservations(std::shared_ptr<Observations> observations,
                                         const std::vector<std::uint8_t>& use, const std::vector<std::size_t>& common)
    : observations_(std::move(observations)), poses_(*observations_, use, common) {
  weigh({});
}

void WeighedObservations::set_parameters(std::span<const double> machine, std::span<const double> setup) {
  observations_->set_parameters(machine, setup);
  point_is_known_ = true;
  machine_.assign(machine.begin(), machine.end());
  setup_.assign(setup.begin(), setup.end());
}

void WeighedObservations::weigh_at(const WeighingPoint& at) {
  if (at.is_known) set_parameters(at.machine, at.setup);
  weigh(at.variance);
  weights_ = at;
}

void WeighedObservations::weigh(const ReadingVariance& variance) {
  weights_ = {variance, point_is_known_, machine_, setup_};
  poses_.update();
  taken_.assign(poses_.groups().size(), Eigen::Matrix3d::Zero());
  for (std::size_t g = 0; g < taken_.size(); ++g) {
    const PoseGroups::Group& group = poses_.groups()[g];
    Eigen::Vector3d part = Eigen::Vector3d::Zero();
    for (int j = 0; j < 3; ++j) {
      const double d = group.squares[j], ratio = variance.pose / variance.factor * d;
      // 1 - 1/sqrt(1 + t) without cancellation where t is small.
      const double root = std::sqrt(1 + ratio);
      if (d > 0) part[j] = ratio / (root * (root + 1)) / d;
    }
    taken_[g] = group.axes * part.asDiagonal() * group.axes.transpose();
  }
}

void WeighedObservations::evaluate(std::size_t first, std::size_t count,
                                   std::span<const std::size_t> machine_parameters,
                                   std::span<const std::size_t> setup_parameters, double* residuals, double* jacobian,
                                   std::size_t stride) const {
  observations_->evaluate(first, count, machine_parameters, setup_parameters, residuals, jacobian, stride);
  const std::size_t rows = poses_.rows();
  const std::size_t columns = jacobian != nullptr ? machine_parameters.size() + setup_parameters.size() : 0;
  if (weights_.variance.pose > 0) {
    ReadingsOutside& outside = readings_outside();
    outside.readings.clear();
    const auto inside = [&](std::size_t reading) { return reading >= first && reading < first + count; };
    const auto first_inside = [&](const PoseGroups::Group& group) {
      return *std::lower_bound(group.readings.begin(), group.readings.end(), first);
    };
    for (std::size_t k = 0; k < count; ++k) {
      const PoseGroups::Group& group = poses_.groups()[poses_.group_of(first + k)];
      if (group.readings.size() == 1 || first_inside(group) != first + k) continue;
      for (const std::size_t reading : group.readings)
        if (!inside(reading)) outside.readings.push_back(reading);
    }
    std::sort(outside.readings.begin(), outside.readings.end());
    outside.evaluate(*observations_, machine_parameters, setup_parameters, columns > 0);

    const std::size_t out_count = outside.readings.size();
    const auto weigh_column = [&](double* column, const double* column_outside, const PoseGroups::Group& group,
                                  const Eigen::Matrix3d& taken) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const std::size_t reading : group.readings) {
        const bool in = inside(reading);
        const double* values = in ? column + (reading - first) : column_outside + outside.place(reading);
        const double* z = poses_.displacement(reading);
        for (std::size_t row = 0; row < rows; ++row)
          sum += Eigen::Map<const Eigen::Vector3d>(z + 3 * row) * values[row * (in ? count : out_count)];
      }
      const Eigen::Vector3d common = taken * sum;
      for (const std::size_t reading : group.readings) {
        if (!inside(reading)) continue;
        const double* z = poses_.displacement(reading);
        for (std::size_t row = 0; row < rows; ++row)
          column[row * count + (reading - first)] -= Eigen::Map<const Eigen::Vector3d>(z + 3 * row).dot(common);
      }
    };
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t g = poses_.group_of(first + k);
      const PoseGroups::Group& group = poses_.groups()[g];
      if (first_inside(group) != first + k) continue;
      weigh_column(residuals, outside.residuals.data(), group, taken_[g]);
      for (std::size_t c = 0; c < columns; ++c)
        weigh_column(jacobian + c * stride, outside.jacobian.data() + c * rows * out_count, group, taken_[g]);
    }
  }
  if (weights_.variance.factor == 1) return;
  const double scale = 1 / std::sqrt(weights_.variance.factor);
  for (std::size_t i = 0; i < rows * count; ++i) residuals[i] *= scale;
  for (std::size_t c = 0; c < columns; ++c)
    for (std::size_t i = 0; i < rows * count; ++i) jacobian[c * stride + i] *= scale;
}

}  // namespace abbe
