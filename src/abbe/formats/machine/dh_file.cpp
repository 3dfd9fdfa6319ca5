#include "abbe/formats/machine/dh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/machine_couplings.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/toml_table.h"
#include "abbe/formats/text/toml_vector.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/machine_check.h"

namespace abbe {
namespace {

constexpr std::size_t kMostJoints = 9;  // the number of a joint is the number in the name of its axis

/// "A2" of a rotary joint, "Z2" of a linear one.
std::string joint_name(AxisKind kind, std::size_t index) {
  return fmt::format("{}{}", kind == AxisKind::rotary ? 'A' : 'Z', index + 1);
}

void set_endless(DhJoint& joint) {
  joint.endless = true;
  joint.travel_min = 0;
  joint.travel_max = 2 * std::numbers::pi;
}

DhJoint read_joint(TomlTable& table, std::size_t index) {
  DhJoint joint;
  joint.kind = table.word_or("kind", 1, {"linear", "rotary"}) == 0 ? AxisKind::linear : AxisKind::rotary;
  joint.name = table.text_or("name", joint_name(joint.kind, index));
  joint.a = table.number_or("a", Quantity::length, 0);
  joint.alpha = table.number_or("alpha", Quantity::angle, 0);
  joint.d = table.number_or("d", Quantity::length, 0);
  joint.theta = table.number_or("theta", Quantity::angle, 0);
  joint.reversed = table.boolean_or("reversed", false);
  const Quantity quantity = joint.kind == AxisKind::linear ? Quantity::length : Quantity::angle;
  if (table.boolean_or("endless", false)) {
    if (joint.kind == AxisKind::linear) table.fail("endless", "a linear joint cannot be endless");
    if (table.has("travel", quantity)) table.fail_quantity("travel", quantity, "is given together with endless = true");
    set_endless(joint);
  } else {
    const std::vector<double> travel = table.numbers("travel", quantity, 2);
    joint.travel_min = travel[0];
    joint.travel_max = travel[1];
    if (!(travel[0] < travel[1])) {
      table.fail_quantity("travel", quantity, "the first limit is not below the second", "[smallest, largest] command");
    }
  }
  return joint;
}

/// Couplings to joints by their names.
void read_joint_couplings(std::vector<TomlTable>& tables, DhArm& arm) {
  std::vector<Axis> axes;
  for (const DhJoint& joint : arm.joints) {
    axes.emplace_back();
    axes.back().name = joint.name;
    axes.back().kind = joint.kind;
  }
  for (std::size_t i = 0; i < tables.size(); ++i) {
    read_couplings(tables[i], axes, i, arm.couplings);
    tables[i].finish();
  }
}

/// What makes the machine of an arm unusable, or a machine file that could not be read; empty if nothing does.
std::string arm_problem(const DhArm& arm) {
  const Machine machine = machine_from_dh(arm);
  const std::vector<MachineProblem> problems = find_problems(machine);
  if (!problems.empty()) return problems.front().text();
  double largest = std::max(machine.tool_reference.cwiseAbs().maxCoeff(), machine.tool_offset.cwiseAbs().maxCoeff());
  for (const Axis& axis : machine.axes) largest = std::max(largest, axis.point.cwiseAbs().maxCoeff());
  return largest > kLargestInput ? fmt::format("the lengths add up to {:.3g} mm", largest) : "";
}

RigidTransform read_frame(TomlTable& root, std::string_view key) {
  auto table = root.optional_table(key);
  if (!table) return {};
  Eigen::Vector3d origin = Eigen::Vector3d::Zero(), angles = Eigen::Vector3d::Zero();
  if (const auto values = table->optional_numbers("origin", Quantity::length, 3)) origin = vector_of(*values);
  if (const auto values = table->optional_numbers("angles", Quantity::angle, 3)) angles = vector_of(*values);
  table->finish();
  return {rotation_from_error_angles(angles), origin};
}

DhArm toml_arm(const std::string& text, const std::string& file) {
  TomlTable root = TomlTable::parse(text, file);
  DhArm arm;
  arm.name = root.text("name");
  arm.description = root.text_or("description", "");
  arm.convention =
      root.word("convention", {"standard", "modified"}) == 0 ? DhConvention::standard : DhConvention::modified;
  arm.workpiece_from_base = read_frame(root, "base");
  arm.last_from_tool = read_frame(root, "tool");
  std::vector<TomlTable> tables = root.tables("joint");
  for (TomlTable& table : tables) {
    if (arm.joints.size() == kMostJoints) table.fail("", "one joint too many", fmt::format("at most {}", kMostJoints));
    arm.joints.push_back(read_joint(table, arm.joints.size()));
  }
  if (arm.joints.empty()) root.fail("joint", "there is none", "a table [[joint]] for each row");
  read_joint_couplings(tables, arm);
  root.finish();
  const std::string problem = arm_problem(arm);
  if (!problem.empty()) root.fail("joint", problem);
  return arm;
}

DhArm csv_arm(const std::string& text, const std::string& file) {
  const auto travel = [](const char* base, Quantity quantity) {
    return CsvColumn{.base = base, .quantity = quantity, .required = false, .may_be_empty = true};
  };
  const CsvTable table = read_csv(text, file,
                                  {{.base = "convention", .is_text = true},
                                   {.base = "a", .quantity = Quantity::length},
                                   {.base = "alpha", .quantity = Quantity::angle},
                                   {.base = "d", .quantity = Quantity::length},
                                   {.base = "theta", .quantity = Quantity::angle},
                                   {.base = "kind", .is_text = true, .required = false},
                                   travel("smallest", Quantity::angle),
                                   travel("largest", Quantity::angle),
                                   travel("smallest_position", Quantity::length),
                                   travel("largest_position", Quantity::length)},
                                  {}, 1);
  const auto& columns = table.columns;
  const auto fail = [&](std::size_t row, const std::string& field, const std::string& problem,
                        const std::string& expected) {
    throw InputError({file, csv_line(text, row), 0, field}, problem, expected);
  };
  if (table.rows > kMostJoints) fail(kMostJoints, "", "one joint too many", fmt::format("at most {}", kMostJoints));
  DhArm arm;
  arm.name = std::filesystem::path(file).stem().string();
  for (std::size_t row = 0; row < table.rows; ++row) {
    const std::string& convention = columns[0].names[columns[0].words[row]];
    if (convention != "standard" && convention != "modified")
      fail(row, "convention", convention, "standard or modified");
    if (row > 0 && columns[0].words[row] != columns[0].words[0])
      fail(row, "convention", convention, "the same in all rows");
    arm.convention = convention == "standard" ? DhConvention::standard : DhConvention::modified;
    DhJoint joint;
    const std::string kind = columns[5].present ? columns[5].names[columns[5].words[row]] : "rotary";
    if (kind != "rotary" && kind != "linear") fail(row, "kind", kind, "rotary or linear");
    joint.kind = kind == "rotary" ? AxisKind::rotary : AxisKind::linear;
    joint.name = joint_name(joint.kind, row);
    joint.a = columns[1].numbers[row];
    joint.alpha = columns[2].numbers[row];
    joint.d = columns[3].numbers[row];
    joint.theta = columns[4].numbers[row];
    const bool rotary = joint.kind == AxisKind::rotary;
    const auto limit = [&](std::size_t column) {
      return columns[column].present ? columns[column].numbers[row] : std::nan("");
    };
    const double from = limit(rotary ? 6 : 8), to = limit(rotary ? 7 : 9);
    const std::string field = rotary ? "smallest_deg, largest_deg" : "smallest_position_mm, largest_position_mm";
    if (std::isfinite(limit(rotary ? 8 : 6)) || std::isfinite(limit(rotary ? 9 : 7))) {
      fail(row, field, fmt::format("a {} joint has limits of the other kind", kind), field);
    }
    if (rotary && std::isnan(from) && std::isnan(to)) {
      set_endless(joint);
    } else if (!(from < to)) {
      fail(row, field, "the limits are missing or not in order", "the smallest and the largest command");
    } else {
      joint.travel_min = from;
      joint.travel_max = to;
    }
    arm.joints.push_back(joint);
  }
  if (arm.joints.empty()) throw InputError({file, 0, 0, ""}, "no rows below the header", "a row for each joint");
  const std::string problem = arm_problem(arm);
  if (!problem.empty()) throw InputError({file}, problem);
  return arm;
}

}  // namespace

DhArm parse_dh_arm(const std::string& text, const std::string& file) {
  return file.ends_with(".csv") ? csv_arm(text, file) : toml_arm(text, file);
}

DhArm read_dh_arm(const std::filesystem::path& path) { return parse_dh_arm(read_text_file(path), path.string()); }

std::string dh_machine_text(const DhArm& arm, const std::string& file) {
  return fmt::format(
             "# From the {} Denavit-Hartenberg parameters in {}.\n# The machine frame is parallel to the frame of "
             "the tool with all axes at zero.\n\n",
             arm.convention == DhConvention::standard ? "standard" : "modified",
             std::filesystem::path(file).filename().string()) +
         machine_text(machine_from_dh(arm));
}

}  // namespace abbe
