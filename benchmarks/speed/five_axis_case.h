#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "abbe/errors/chain_plan.h"
#include "abbe/errors/random_stream.h"

namespace abbe::benchmarks {

/// Trunnion mill w C' A' b X Y Z t with 30 error motions (Legendre degree 4; Fourier 4 harmonics) and 11 location
/// errors.
struct FiveAxisCase {
  Machine machine;
  ErrorSet errors;

  FiveAxisCase() {
    const Eigen::Vector3d table(0, 0, -200);
    machine.name = "trunnion mill";
    for (const char letter : std::string("CAXYZ")) {
      Axis axis;
      axis.name = std::string(1, letter);
      axis_kind_from_letter(letter, axis.kind);
      axis.direction = direction_from_letter(letter);
      const bool rotary = axis.kind == AxisKind::rotary;
      axis.side = rotary ? ChainSide::workpiece : ChainSide::tool;
      axis.primed = rotary;
      if (rotary) axis.point = table;
      axis.travel_min = letter == 'C' ? -std::numbers::pi : rotary ? -1.5 : -300;
      axis.travel_max = -axis.travel_min;
      machine.axes.push_back(axis);
    }
    machine.tool_reference = {0, 0, 100};
    machine.tool_offset = {0, 0, -80};
    machine.bed_from_workpiece = RigidTransform::translate(table);

    RandomStream random(2026);
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      const Axis& axis = machine.axes[i];
      for (int k = 0; k < kComponentCount; ++k) {
        Basis basis{.kind = BasisKind::legendre, .order = 4, .from = axis.travel_min, .to = axis.travel_max};
        if (axis.kind == AxisKind::rotary) {
          basis.kind = BasisKind::fourier;
          basis.from = -std::numbers::pi;
          basis.to = std::numbers::pi;
          basis.period = 2 * std::numbers::pi;
        }
        ErrorMotion motion{i, static_cast<Component>(k), basis, std::vector<double>(basis.size()), {}};
        for (double& value : motion.coefficients) value = random.uniform(-1, 1) * (k < 3 ? 0.005 : 2e-5);
        errors.motions.push_back(motion);
      }
    }
    const auto add = [&](const char* name) {
      LocationError location;
      bool is_location = false;
      parse_error_name(machine, name, location.axis, location.component, is_location);
      location.value = random.uniform(-1, 1) * (is_rotation(location.component) ? 5e-5 : 0.02);
      errors.locations.push_back(location);
    };
    for (const char* name : {"EC0Y", "EA0Z", "EB0Z", "EY0A", "EZ0A", "EB0A", "EC0A", "EX0C", "EY0C", "EA0C", "EB0C"}) {
      add(name);
    }
  }
};

/// Several arrays of the same length that start on cache lines, not a power of two apart: then neither split stores nor
/// conflicts in the cache hide what the computation costs.
class Arrays {
 public:
  Arrays(std::size_t arrays, std::size_t count) : stride_((count + 7) / 8 * 8 + 8 * 5), values_(arrays * stride_ + 8) {
    first_ = values_.data();
    while (reinterpret_cast<std::uintptr_t>(first_) % 64 != 0) ++first_;
  }
  Arrays(const Arrays&) = delete;
  Arrays& operator=(const Arrays&) = delete;
  double* operator[](std::size_t i) { return first_ + i * stride_; }

 private:
  std::size_t stride_;
  std::vector<double> values_;
  double* first_;
};

/// Random commands within the travel, structure of arrays.
struct Commands {
  Arrays values;
  std::vector<const double*> pointers;

  Commands(const Machine& machine, std::size_t count) : values(machine.axes.size(), count) {
    RandomStream random(7);
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      const Axis& axis = machine.axes[i];
      for (std::size_t k = 0; k < count; ++k) values[i][k] = random.uniform(axis.travel_min, axis.travel_max);
      pointers.push_back(values[i]);
    }
  }
};

/// Rows of the Jacobian of a point: its coordinates, at a block of poses.
class CoordinateRows {
 public:
  CoordinateRows() = default;
  CoordinateRows(const CoordinateRows&) = delete;
  CoordinateRows& operator=(const CoordinateRows&) = delete;
  const RowArrays (&rows() const)[3] { return rows_; }

 private:
  std::vector<double> one_ = std::vector<double>(ChainPlan::kBlockSize, 1.0);
  std::vector<double> none_ = std::vector<double>(ChainPlan::kBlockSize, 0.0);
  RowArrays rows_[3] = {{{one_.data(), none_.data(), none_.data()}, {}},
                        {{none_.data(), one_.data(), none_.data()}, {}},
                        {{none_.data(), none_.data(), one_.data()}, {}}};
};

/// Random commands within the travel, away from the tilt at which the axes of the head are parallel: [axes][count].
inline std::array<std::vector<double>, 5> commands_to_correct(const FiveAxisCase& five_axis, std::size_t count) {
  RandomStream random(7);
  std::array<std::vector<double>, 5> commands;
  for (std::size_t i = 0; i < 5; ++i) {
    const Axis& axis = five_axis.machine.axes[i];
    for (std::size_t k = 0; k < count; ++k) {
      commands[i].push_back(axis.name == "A" ? random.uniform(0.2, 1.2)
                                             : 0.98 * random.uniform(axis.travel_min, axis.travel_max));
    }
  }
  return commands;
}

}  // namespace abbe::benchmarks
