#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/geometry/rigid_transform.h"

namespace abbe {

enum class RobotLanguage { rapid, krl, fanuc_ls, urscript };

/// "RAPID", "KRL", "Fanuc LS", "URScript".
const char* robot_language_name(RobotLanguage language);

/// By the ending of a name: .mod .modx .sys .sysx, .src .dat, .ls, .script .urscript; nothing for other names.
std::optional<RobotLanguage> robot_language_of(std::string_view file_name);

/// Joints that a position can have: six of the arm, six additional axes.
inline constexpr std::size_t kRobotJoints = 12;

/// A number of a program and its place in the text.
struct RobotNumber {
  std::size_t begin = 0, size = 0;  ///< bytes
  double value = 0;                 ///< as written: mm (m in URScript), degrees (rad in URScript), or without unit
  std::size_t decimals = 0;         ///< digits behind the decimal point
  bool is_length = false;           ///< of a joint in Fanuc LS: its unit is mm
};

/// Where the configuration of a position says a joint stands, rad.
struct JointRange {
  double from = 0, to = 0;
};

enum class RobotPositionKind { joints, pose };

struct RobotPosition {
  RobotPositionKind kind = RobotPositionKind::joints;
  std::string name;      ///< as in the program: "p10", "p{2}", "XP1", "P[1]", "movej"
  std::size_t line = 0;  ///< from 1
  /// joints: A1 to A6, then the additional axes; absent where the program gives no number.
  std::array<std::optional<RobotNumber>, kRobotJoints> joints{};
  /// pose: x y z, then the orientation: ABB q1 to q4, KUKA A B C, Fanuc W P R, UR rx ry rz.
  std::vector<RobotNumber> pose{};
  std::array<std::optional<JointRange>, 6> configuration{};  ///< pose: of the arm, as far as it is documented
  std::vector<RobotNumber> configuration_numbers{};          ///< where that is written: cf1, cf4, cf6 or T
  std::string frame{};                                       ///< pose: user frame and tool, where the position has them
};

/// A position that is not corrected, and why.
struct UncorrectedPosition {
  std::size_t line = 0;
  std::string reason;
};

/// A program with the positions in it. The text is kept byte for byte.
struct RobotProgram {
  RobotLanguage language = RobotLanguage::rapid;
  std::string file;  ///< for messages
  std::string text;
  std::vector<RobotPosition> positions;   ///< in the order of the text
  std::vector<UncorrectedPosition> left;  ///< other positions, in the order of the text
};

/// Positions of a program; what is read and from which documentation: docs/robot-programs.md.
/// @throws InputError with file, line and field for a position that is damaged, and if there is none at all
RobotProgram parse_robot_program(std::string text, RobotLanguage language, const std::string& file);

/// workpiece_from_tool of a position with a pose, mm. @throws InputError  the quaternion has no length
RigidTransform robot_pose(const RobotProgram& program, const RobotPosition& position);

/// Numbers of a pose in the units and the order of RobotPosition::pose. Of the ways to write an orientation it takes
/// the one nearest to that of `position`.
std::vector<double> robot_pose_numbers(RobotLanguage language, const RobotPosition& position,
                                       const RigidTransform& workpiece_from_tool);

/// Unit of joint numbers of the program, in mm or rad.
double robot_joint_unit(RobotLanguage language, bool is_length);

/// New values of one position: [kRobotJoints] for joints, of which only those count that the program gives, or
/// RobotPosition::pose.size().
using RobotValues = std::vector<double>;

/// How a number is written instead of another one: with its decimals, and at least with those that its language needs
/// for 0.1 um, if they are allowed there. @param number  index in RobotPosition::joints or ::pose
std::string robot_number_text(RobotLanguage language, const RobotPosition& position, std::size_t number, double value);

/// The program with other values; every other byte stays. A configuration changes where a joint is beyond its range.
/// @param values  [positions]; an empty entry: that position stays as it is
/// @param arms    [positions][6] joints of the arm that the values stand for, rad; an empty entry, or none at all:
/// their
///                configurations stay as they are
std::string replaced_robot_text(const RobotProgram& program, const std::vector<RobotValues>& values,
                                const std::vector<std::vector<double>>& arms = {});

}  // namespace abbe
