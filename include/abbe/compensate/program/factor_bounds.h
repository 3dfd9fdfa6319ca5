#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"
#include "abbe/machine/state.h"

namespace abbe {

/// Bounds of the size of something along a piece of a path and of its derivatives by s from 0 to 1.
struct BoundAlong {
  double value = 0, rate = 0, second = 0;
  double lag = 0;  ///< by how much it may be off while axes lag

  void add(const BoundAlong& other);
};

/// Bounds of a product, by the product rule.
BoundAlong product_along(const BoundAlong& a, const BoundAlong& b);

/// Bounds of the commands of all axes along a piece; mm and rad, derivatives by s.
struct CommandsAlong {
  std::array<double, kMaxAxes> lowest{}, highest{};
  std::array<double, kMaxAxes> speed{}, bend{};  ///< |first derivative|, |second derivative|
  std::array<double, kMaxAxes> lag{};            ///< of the actual position
};

/// Proven bounds of the factors of states along a piece of a path, for states that follow from the commands and from
/// the sides of approach; a side of approach does not change within a piece. Derivation: docs/programs.md, "States".
class FactorBounds {
 public:
  FactorBounds(const Machine& machine, const ErrorSet& errors);

  /// Whether the errors use a state at all.
  bool any() const { return any_; }
  /// @param factors  [states] written; 0 for those that the errors do not use
  void along(const CommandsAlong& commands, std::array<BoundAlong, kMaxStates>& factors) const;

 private:
  /// A point mass, from the axis that carries it to that of the state.
  struct Arm {
    double weight = 0;  ///< N m per mm
    double length = 0;  ///< mm, of the mass from the point of the axis that carries it
    std::vector<std::pair<std::size_t, double>> inwards;  ///< axes, and mm from the point of each to that of the next
  };
  struct Torque {
    std::vector<std::size_t> turning;  ///< rotary axes between the bed and the line
    double level = 1;                  ///< sine of the angle between the line and gravity with these at zero
    std::vector<Arm> arms;
  };
  Torque torque_of(const Machine& machine, const MachineState& state) const;
  BoundAlong torque_along(const Torque& torque, const CommandsAlong& commands) const;
  BoundAlong one_along(std::size_t state, const CommandsAlong& commands) const;

  std::vector<MachineState> states_;
  std::vector<std::uint8_t> used_;
  std::vector<bool> rotary_;     ///< [axes]
  std::vector<Torque> torques_;  ///< [states]
  bool any_ = false;
};

}  // namespace abbe
