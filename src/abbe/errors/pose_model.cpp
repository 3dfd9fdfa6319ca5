#include "abbe/errors/pose_model.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

constexpr std::size_t kPart = ChainPlan::kBlockSize;
constexpr std::size_t kRows = 6;

const ErrorSet& sound(const ErrorSet& errors) {
  if (errors.composition.first_order) throw std::invalid_argument("errors of first order have no pose of the tool");
  return errors;
}

ErrorSet without_errors(const ErrorSet& like) {
  ErrorSet none;
  none.composition = like.composition;
  return none;
}

/// Parts of at most kPart poses, one after the other: visit(first, part of the positions).
template <class Visit>
void for_each_part(PositionArrays positions, const Visit& visit) {
  std::array<const double*, kMaxAxes> axis{};
  std::array<const double*, kMaxStates> state{};
  for (std::size_t first = 0; first < positions.count; first += kPart) {
    for (std::size_t i = 0; i < positions.axis.size(); ++i) axis[i] = positions.axis[i] + first;
    for (std::size_t j = 0; j < positions.state.size(); ++j) {
      state[j] = positions.state[j] == nullptr ? nullptr : positions.state[j] + first;
    }
    visit(first, PositionArrays{{axis.data(), positions.axis.size()},
                                std::min(kPart, positions.count - first),
                                {state.data(), positions.state.size()}});
  }
}

PointArrays from(PointArrays arrays, std::size_t first) {
  return {arrays.x + first, arrays.y + first, arrays.z + first};
}

RotationArrays from(RotationArrays arrays, std::size_t first) {
  for (double*& element : arrays.r) {
    if (element) element += first;
  }
  return arrays;
}

/// The same point for every pose of a part.
struct Tips {
  Tips(const Eigen::Vector3d& tip, std::size_t count) {
    for (std::size_t c = 0; c < 3; ++c) {
      std::fill_n(values[c].begin(), std::min(count, kPart), tip[static_cast<Eigen::Index>(c)]);
    }
  }
  ConstPointArrays arrays() const { return {values[0].data(), values[1].data(), values[2].data()}; }
  std::array<std::array<double, kPart>, 3> values;
};

void transform(const ChainPlan& plan, const Eigen::Vector3d& tip, PositionArrays positions, PointArrays point,
               RotationArrays rotation, std::uint8_t* covered) {
  const Tips tips(tip, positions.count);
  for_each_part(positions, [&](std::size_t first, PositionArrays part) {
    plan.transform(part, tips.arrays(), from(point, first), from(rotation, first), covered ? covered + first : nullptr);
  });
}

/// Points and rotations of one part.
struct PartPoses {
  std::array<std::array<double, kPart>, 3> point;
  std::array<std::array<double, kPart>, 9> rotation;

  PointArrays points() { return {point[0].data(), point[1].data(), point[2].data()}; }
  RotationArrays rotations() {
    RotationArrays arrays;
    for (std::size_t e = 0; e < 9; ++e) arrays.r[e] = rotation[e].data();
    return arrays;
  }
  Eigen::Matrix3d rotation_at(std::size_t k) const {
    Eigen::Matrix3d matrix;
    for (std::size_t e = 0; e < 9; ++e) {
      matrix(static_cast<Eigen::Index>(e / 3), static_cast<Eigen::Index>(e % 3)) = rotation[e][k];
    }
    return matrix;
  }
};

}  // namespace

PoseModel::PoseModel(const Machine& machine, const ErrorSet& errors)
    : machine_(machine),
      errors_(sound(errors)),
      actual_(machine, errors, Body::tool, Body::workpiece),
      nominal_(machine, without_errors(errors), Body::tool, Body::workpiece),
      actual_tip_(machine.tool_offset + errors.tool_offset_error),
      nominal_tip_(machine.tool_offset) {}

void PoseModel::poses(PositionArrays positions, PointArrays point, RotationArrays rotation,
                      std::uint8_t* covered) const {
  transform(actual_, actual_tip_, positions, point, rotation, covered);
}

void PoseModel::nominal_poses(PositionArrays positions, PointArrays point, RotationArrays rotation) const {
  transform(nominal_, nominal_tip_, positions, point, rotation, nullptr);
}

void PoseModel::deviations(PositionArrays positions, double* const* deviation, std::uint8_t* covered) const {
  PartPoses actual, nominal;
  for_each_part(positions, [&](std::size_t first, PositionArrays part) {
    poses(part, actual.points(), actual.rotations(), covered ? covered + first : nullptr);
    nominal_poses(part, nominal.points(), nominal.rotations());
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t k = 0; k < part.count; ++k) {
        deviation[c][first + k] = actual.point[c][k] - nominal.point[c][k];
      }
    }
    for (std::size_t k = 0; k < part.count; ++k) {
      const Eigen::Matrix3d turned = actual.rotation_at(k) * nominal.rotation_at(k).transpose();
      const Eigen::Vector3d turn = rotation_vector(turned);
      for (std::size_t c = 0; c < 3; ++c) deviation[3 + c][first + k] = turn[static_cast<Eigen::Index>(c)];
    }
  });
}

void PoseModel::jacobian(PositionArrays positions, double* jacobian) const {
  differentiate(positions, jacobian, nullptr);
}

void PoseModel::jacobian_by_positions(PositionArrays positions, double* by_position) const {
  differentiate(positions, nullptr, by_position);
}

void PoseModel::differentiate(PositionArrays positions, double* by_parameter, double* by_position) const {
  const std::size_t axes = machine_.axes.size();
  std::vector<std::size_t> parameters(by_parameter ? errors_.parameter_count() : 0);
  std::iota(parameters.begin(), parameters.end(), std::size_t{0});
  std::array<double, kPart> zero, one;
  zero.fill(0);
  one.fill(1);
  // Rows: displacement along x, y, z, then rotation about them.
  std::array<RowArrays, kRows> rows;
  const auto unit = [&](std::size_t of, std::size_t c) { return of == c ? one.data() : zero.data(); };
  for (std::size_t r = 0; r < 3; ++r) {
    rows[r] = {{unit(r, 0), unit(r, 1), unit(r, 2)}, {}};
    rows[3 + r] = {{zero.data(), zero.data(), zero.data()}, {unit(r, 0), unit(r, 1), unit(r, 2)}};
  }
  const Tips tips(actual_tip_, positions.count);
  PartPoses seen;
  std::vector<double> columns(parameters.size() * kRows * kPart), commands(axes * kRows * kPart);
  for_each_part(positions, [&](std::size_t first, PositionArrays part) {
    const std::size_t n = part.count;
    poses(part, seen.points());
    actual_.differentiate(part, tips.arrays(), {seen.point[0].data(), seen.point[1].data(), seen.point[2].data()}, rows,
                          parameters, columns.data(), kRows * n, nullptr, by_position ? commands.data() : nullptr);
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t r = 0; r < kRows; ++r) {
        if (by_parameter) {
          double* out = by_parameter + ((first + k) * kRows + r) * parameters.size();
          for (std::size_t p = 0; p < parameters.size(); ++p) out[p] = columns[p * kRows * n + r * n + k];
        }
        if (by_position) {
          double* out = by_position + ((first + k) * kRows + r) * axes;
          for (std::size_t i = 0; i < axes; ++i) out[i] = commands[(i * kRows + r) * n + k];
        }
      }
    }
  });
}

}  // namespace abbe
