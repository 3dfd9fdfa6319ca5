#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "abbe/errors/chain_plan.h"
#include "abbe/study/identification/identified_expansions.h"

namespace abbe {

struct Study;
struct StudyResult;

/// One identified number: a location error, a reversal value, a quantity of a set-up. Lengths in mm, angles in rad.
struct FoundNumber {
  std::string name;  ///< "EC0Y", "bar1.length"
  std::string words;
  bool is_angle = false;
  double value = 0;
  double expanded_uncertainty = 0;  ///< k = 2; 0: see is_fixed
  bool is_fixed = false;            ///< by a convention of the gauge, not found from the readings
  bool is_pure_number = false;      ///< of a set-up: a scale
};

/// A pose, a direction or a place of a set-up as it was found, whole and not as an increment to a nominal one.
struct FoundPlace {
  std::string name;
  Body body = Body::workpiece;                 ///< in whose frame it is
  Eigen::Vector3d position{0, 0, 0};           ///< mm
  Eigen::Vector3d position_expanded{0, 0, 0};  ///< k = 2 of the coordinates, mm
  std::optional<Eigen::Matrix3d> rotation{};   ///< columns: its axes in the frame of the body
  std::optional<Eigen::Vector3d> direction{};  ///< unit, of what has no more than a direction
  Eigen::Vector3d turn_expanded{0, 0, 0};      ///< k = 2 of a turn about x, y, z of the body, rad

  /// a, b, c of R = Rz(c) Ry(b) Rx(a), rad: as a study states poses. Of a rotation.
  Eigen::Vector3d angles() const;
};

struct FoundSetup {
  std::string name, instrument;
  std::vector<FoundPlace> places;
  std::vector<FoundNumber> numbers;  ///< every other unknown; those of a pose are in `places`
};

/// What an identification has found besides the error motions.
struct FoundValues {
  std::vector<FoundExpansion> expansions;
  std::vector<FoundNumber> locations, reversals;
  std::vector<FoundNumber> tool;               ///< three components of its error, or empty
  std::optional<Eigen::Vector3d> tool_offset;  ///< mm, with that error
  std::vector<FoundSetup> setups;
};

/// @param result  usable
FoundValues found_values(const Study& study, const StudyResult& result);

}  // namespace abbe
