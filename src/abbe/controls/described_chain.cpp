#include "abbe/controls/described_chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "abbe/errors/calibrated_machine.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

constexpr double kAlongLetter = 1e-9;
constexpr double kLeastTurn = 0.01 - kTurn / 2;

[[noreturn]] void refuse_description(const std::string& format, const std::string& why, const std::string& expected) {
  throw InputError({.field = "--for " + format}, why, expected);
}

Eigen::Vector3d unit_of(std::size_t coordinate) {
  return Eigen::Vector3d::Unit(static_cast<Eigen::Index>(coordinate % 3));
}

void check_described(const Machine& machine, const std::string& format) {
  std::string letters;
  for (const Axis& axis : machine.axes) {
    const char letter = axis.name.front();
    const std::size_t coordinate = kinematics_coordinate(letter);
    const bool rotary = axis.kind == AxisKind::rotary;
    if (coordinate == 6 || (coordinate >= 3) != rotary) {
      refuse_description(format, fmt::format("MachAxis has no letter for {}", axis.name),
                         "linear axes X Y Z U V W and rotary axes A B C");
    }
    if (letters.find(letter) != std::string::npos) {
      refuse_description(format, fmt::format("two axes have the letter {}", letter), "every letter once");
    }
    letters += letter;
    if (rotary) continue;
    if ((described_sense(axis) * axis.direction - unit_of(coordinate)).norm() > kAlongLetter) {
      refuse_description(
          format, fmt::format("{} does not move the tool along +{:c} of the workpiece", axis.name, "XYZ"[coordinate]),
          "linear axes along X, Y and Z with the signs of ISO 841");
    }
  }
}

/// p by Trans(-v) or Rot(-v): the coordinates of a point when the frame moves by v.
void move_frame(std::size_t coordinate, double v, Eigen::Vector3d& point) {
  const auto a = static_cast<Eigen::Index>(coordinate % 3);
  if (coordinate < 3) {
    point[a] -= v;
    return;
  }
  const Eigen::Index b = (a + 1) % 3, c = (a + 2) % 3;
  const double cosine = std::cos(v), sine = std::sin(v), pb = point[b], pc = point[c];
  point[b] = cosine * pb + sine * pc;
  point[c] = cosine * pc - sine * pb;
}

void turn_frame(std::size_t coordinate, double v, Eigen::Matrix3Xd& directions, Eigen::Index count) {
  if (coordinate < 3) return;
  for (Eigen::Index k = 0; k < count; ++k) {
    Eigen::Vector3d direction = directions.col(k);
    move_frame(coordinate, v, direction);
    directions.col(k) = direction;
  }
}

}  // namespace

void tilt_to(const Eigen::Vector3d& to, DescribedAxis& described) {
  const double x = to.x(), y = to.y(), z = to.z();
  const auto turn = [](double sine) { return std::asin(std::clamp(sine, -1.0, 1.0)); };
  // Half a turn, of an axis that turns the other way, is the same number with errors on either side of it.
  const auto first_turn = [](double sine, double cosine) {
    const double angle = std::atan2(sine, cosine);
    return angle < kLeastTurn ? angle + kTurn : angle;
  };
  const auto set = [&](std::size_t first, double by_first, std::size_t second, double by_second) {
    described.tilt_coordinate[0] = first;
    described.tilt_coordinate[1] = second;
    described.tilt[0] = by_first;
    described.tilt[1] = by_second;
  };
  switch (described.coordinate % 3) {
    case 0:
      set(4, first_turn(-z, x), 5, turn(y));
      break;  // Ry Rz x = (cos b cos c, sin c, -sin b cos c)
    case 1:
      set(3, first_turn(z, y), 5, turn(-x));
      break;  // Rx Rz y = (-sin c, cos a cos c, sin a cos c)
    default:
      set(3, first_turn(-y, z), 4, turn(x));
      break;  // Rx Ry z = (sin b, -sin a cos b, cos a cos b)
  }
}

double described_sense(const Axis& axis) { return axis.side == ChainSide::tool ? axis.sense() : -axis.sense(); }

Eigen::Matrix3d DescribedAxis::tilted() const {
  return rotation_about(unit_of(tilt_coordinate[0]), tilt[0]) * rotation_about(unit_of(tilt_coordinate[1]), tilt[1]);
}

std::vector<DescribedAxis> described_axes(const Machine& machine, const ErrorSet& errors, const std::string& format) {
  check_described(machine, format);
  const CalibratedMachine displaced = calibrated_machine(machine, errors);
  std::vector<DescribedAxis> found;
  Eigen::Vector3d origin = machine.tool_reference;
  for (std::size_t k = machine.axes.size(); k-- > 0;) {
    const Axis& axis = displaced.machine.axes[k];
    DescribedAxis described;
    described.axis = k;
    described.letter = axis.name.front();
    described.coordinate = kinematics_coordinate(described.letter);
    described.letter_direction = unit_of(described.coordinate);
    tilt_to(described_sense(axis) * axis.direction, described);
    if (axis.kind == AxisKind::rotary) {
      described.shift = axis.point - origin;
      origin = axis.point;
    }
    described.origin = origin;
    found.push_back(described);
  }
  return found;
}

DescribedCorrection::DescribedCorrection(const Machine& machine, const std::vector<KinematicsRow>& rows,
                                         std::vector<ComponentTable> tables)
    : machine_(machine), tables_(std::move(tables)) {
  RigidTransform tool_from_end;
  for (const KinematicsRow& row : rows) {
    if (row.key == KinematicsRow::Key::mach_base) continue;
    Link link;
    link.coordinate = kinematics_coordinate(row.axis);
    if (row.key == KinematicsRow::Key::mach_axis) {
      const auto axis = std::find_if(machine_.axes.begin(), machine_.axes.end(),
                                     [&](const Axis& one) { return one.name.front() == row.axis; });
      if (axis == machine_.axes.end()) {
        throw InputError({.field = fmt::format("MachAxis {}", row.axis)}, "the machine has no such axis",
                         machine_.chain());
      }
      link.axis = static_cast<std::size_t>(axis - machine_.axes.begin());
      if (axis->kind == AxisKind::linear) linear_.push_back(link.axis);
    } else {
      const double coord = row.coord.value_or(0);
      link.value = coord + row.constant.value_or(0);
      if (row.column) {
        for (const ComponentTable& table : tables_) {
          const auto& column = table.columns.at(row.column->column);
          if (table.axis == row.column->axis && column) link.table = &*column;
        }
        if (link.table == nullptr) {
          throw InputError({.field = "COMPTAB"}, fmt::format("no table has the column C{}", row.column->column + 1),
                           "the compensation-value table of the axis");
        }
      }
      const Eigen::Vector3d unit = unit_of(link.coordinate);
      tool_from_end = tool_from_end * (link.coordinate < 3 ? RigidTransform::translate(coord * unit)
                                                           : RigidTransform::rotate(rotation_about(unit, coord)));
    }
    links_.push_back(link);
  }
  workpiece_from_end_ =
      machine_.bed_from_workpiece.inverse() * (RigidTransform::translate(machine_.tool_reference) * tool_from_end);
}

DescribedCorrection::Reached DescribedCorrection::reached(const std::vector<double>& pose) const {
  Eigen::Vector3d point = machine_.tool_offset;
  Eigen::Matrix3Xd moves(3, static_cast<Eigen::Index>(linear_.size()));
  Eigen::Index count = 0;
  for (const Link& link : links_) {
    double value = link.value;
    if (link.axis != Machine::npos) value = -pose[link.axis];
    if (link.table != nullptr) value += link.table->at(pose[link.table->input]);
    if (value != 0) {
      move_frame(link.coordinate, value, point);
      turn_frame(link.coordinate, value, moves, count);
    }
    if (link.axis == Machine::npos || link.coordinate >= 3) continue;
    // Rows come in the order of linear_.
    moves.col(count++) = unit_of(link.coordinate);
  }
  return {workpiece_from_end_ * point, workpiece_from_end_.rotation * moves};
}

void DescribedCorrection::evaluate(const PoseList& commands, PoseList& correction) const {
  correction.axis.assign(commands.axis.size(), std::vector<double>(commands.count(), 0.0));
  correction.approach.clear();
  for (std::size_t k = 0; k < commands.count(); ++k) {
    const std::vector<double> pose = commands.pose(k);
    for (const ComponentTable& table : tables_) {
      if (table.own) correction.axis[table.axis][k] += table.own->at(pose[table.axis]);
    }
    if (linear_.empty()) continue;
    const Reached there = reached(pose);
    const Eigen::Vector3d missing = nominal_workpiece_from_tool(machine_, pose).translation - there.point;
    const Eigen::VectorXd added = CompleteOrthogonal(there.by_linear).solve(missing);
    for (std::size_t j = 0; j < linear_.size(); ++j) {
      correction.axis[linear_[j]][k] += added[static_cast<Eigen::Index>(j)];
    }
  }
}

}  // namespace abbe
