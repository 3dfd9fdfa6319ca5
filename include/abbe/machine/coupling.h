#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "abbe/machine/machine.h"

// Commands and positions of axes. With C the matrix of the couplings, ones on its diagonal, the positions are q = C m.
// In some order of the axes C is a triangle, so that its inverse is found by substitution. docs/kinematics.md.

namespace abbe {

/// Whether the position of an axis contains commands of others.
bool is_coupled(const Machine& machine, std::size_t axis);

/// q = C m. Copies where there is no coupling.
/// @param commands   [axes] chain order, mm or rad
/// @param positions  out, [axes]; must not be `commands`
void positions_of_commands(const Machine& machine, const double* commands, double* positions);
std::vector<double> positions_of_commands(const Machine& machine, std::span<const double> commands);

/// m = C^-1 q.
/// @param commands  out, [axes]; must not be `positions`
void commands_of_positions(const Machine& machine, const double* positions, double* commands);

/// What others add to the position of an axis at these commands.
double coupled_part(const Machine& machine, std::size_t axis, const double* commands);

/// Axes in an order in which those that others are coupled to come first, else that of the chain. Of couplings that go
/// round, only a part of the axes: `axes.size()` is then less than that of the machine.
struct CouplingOrder {
  std::array<std::size_t, kMaxAxes> axis{};
  std::size_t count = 0;
};
CouplingOrder coupling_order(const Machine& machine);

/// Couplings in the order in which derivatives are handed from positions to commands in place: for each in turn,
/// slope[of] += ratio * slope[axis].
std::vector<AxisCoupling> couplings_in_order(const Machine& machine);

/// C^T g: derivatives by positions become those by commands, in place.
/// @param slopes  [axes]
void slopes_by_commands(const Machine& machine, double* slopes);

/// Positions that an axis can have while all commands are within travel; mm or rad. Of an endless axis as its travel.
struct PositionLimits {
  double from = 0, to = 0;
};
PositionLimits position_limits(const Machine& machine, std::size_t axis);

/// Commands of an axis with which its position is within limits whatever the commands of the others are, within their
/// travels. Empty (from > to) where the others alone can move it over more than the limits.
PositionLimits commands_within(const Machine& machine, std::size_t axis, const PositionLimits& limits);

/// "A3 is coupled to A2": the first coupling in words; empty without any.
std::string first_coupling(const Machine& machine);

/// "A3 = command - 1 A2", with the units of ratios between a linear and a rotary axis; empty for an axis that is not
/// coupled.
std::string position_formula(const Machine& machine, std::size_t axis);

}  // namespace abbe
