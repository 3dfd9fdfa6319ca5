#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "abbe/machine/machine.h"
#include "abbe/plan/ways/obstacle.h"

namespace abbe {

/// An option such as "table=vice.stl".
struct ObstacleOption {
  Obstacle obstacle;     ///< what carries it; without name and mesh
  std::string contents;  ///< behind the equals sign, not empty
};

/// An obstacle on "base", "table" or an axis of the machine, still without name and mesh; nothing for another carrier.
std::optional<Obstacle> obstacle_on(const Machine& machine, const std::string& carrier);

/// Gives an obstacle the mesh of a box between two opposite corners, mm, in the frame of its carrier.
/// @param number  of the box, for its name: "box 1"
/// @param field   how the user calls it, for the error  @param form  what he should have written
/// @throws InputError for a box without volume and a coordinate that is not finite or above kLargestInput
Obstacle box_obstacle(Obstacle on, const std::array<double, 6>& corners, std::size_t number, const std::string& field,
                      const std::string& form);

/// "ON=CONTENTS", where ON is base, table or the name of an axis.
/// @param option  how the user calls it, for the error: "--obstacle-mesh"
/// @param form    what he should have written: "ON=FILE"
/// @throws InputError
ObstacleOption obstacle_option(const Machine& machine, const std::string& option, const std::string& text,
                               const std::string& form);

/// "ON=X0,Y0,Z0,X1,Y1,Z1": two opposite corners of a box, mm, in the frame of what carries it.
/// @throws InputError also as box_obstacle()
Obstacle box_obstacle_option(const Machine& machine, const std::string& option, const std::string& text,
                             std::size_t number);

}  // namespace abbe
