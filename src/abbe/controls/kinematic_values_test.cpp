#include "abbe/controls/kinematic_values.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "abbe/controls/kinematic_values_text.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/decimal_comma_for_test.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// All location errors of the rotary axes that shift or tilt their lines, of different sizes.
ErrorSet errors_of_lines(const Machine& machine, bool tilts) {
  ErrorSet errors;
  double size = 1;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (machine.axes[i].kind != AxisKind::rotary) continue;
    for (int c = 0; c < kComponentCount; ++c) {
      const auto component = static_cast<Component>(c);
      const Axis& axis = machine.axes[i];
      if (!location_error_is_valid(axis, component) || is_zero_position_error(axis, component)) continue;
      if (is_rotation(component) && !tilts) continue;
      size = -1.3 * size;
      errors.locations.push_back(
          {.axis = i, .component = component, .value = size * (is_rotation(component) ? 2e-5 : 3e-3)});
    }
  }
  return errors;
}

/// Numbers of the lines of a file, by what stands before them.
std::map<std::string, double> numbers_in(const std::string& text, char between) {
  std::map<std::string, double> numbers;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t at = line.rfind(between);
    if (line.empty() || std::string("#;%").find(line[0]) != std::string::npos || at == std::string::npos) continue;
    numbers[line.substr(0, at)] = std::stod(line.substr(at + 1));
  }
  return numbers;
}

class KinematicValuesTest : public testing::Test {
 protected:
  static Machine machine_named(const std::string& name) {
    return read_machine(std::string(ABBE_SOURCE_DIR) + "/examples/machines/" + name + ".machine.toml");
  }
  static KinematicValuesRequest request_for(const std::string& format, const std::string& machine) {
    KinematicValuesRequest request;
    request.format = format;
    request.machine = machine_named(machine);
    request.positions = 3;
    return request;
  }
  static std::string refused(const KinematicValuesRequest& request) {
    try {
      make_kinematic_values(request);
    } catch (const InputError& error) {
      return error.what();
    }
    return "not refused";
  }
  static double actual(const KinematicValues& made, const std::string& name) {
    for (const KinematicValue& value : made.values) {
      if (value.name == name) return value.actual;
    }
    ADD_FAILURE() << name;
    return 0;
  }
};

Eigen::Vector3d three(const std::map<std::string, double>& numbers, const std::string& name, const std::string& end) {
  return {numbers.at(name + "0" + end), numbers.at(name + "1" + end), numbers.at(name + "2" + end)};
}

/// Linear positions by the chain of vectors that the manual of the control draws; angles in rad as commanded.
Eigen::Vector3d by_siemens_vectors(const std::string& text, double first, double second, const Eigen::Vector3d& point,
                                   const Eigen::Vector3d& tool) {
  const std::map<std::string, double> md = numbers_in(text, '=');
  const auto vector = [&](const std::string& name) { return three(md, "$MC_TRAFO5_" + name + "_1[", "]"); };
  const Eigen::AngleAxisd turn_1(first, vector("AXIS1").normalized()), turn_2(second, vector("AXIS2").normalized());
  if (text.find("TYPE_1 = 40") != std::string::npos) {
    return vector("BASE_TOOL") + turn_1 * (vector("JOINT_OFFSET") + turn_2 * (vector("PART_OFFSET") + point)).eval() -
           tool;
  }
  if (text.find("TYPE_1 = 24") != std::string::npos) {
    return point + vector("PART_OFFSET") +
           turn_1 * (vector("JOINT_OFFSET") + turn_2 * (vector("BASE_TOOL") - tool).eval()).eval();
  }
  return vector("JOINT_OFFSET_PART") + turn_2 * (vector("PART_OFFSET") + point).eval() + vector("JOINT_OFFSET") +
         turn_1 * (vector("BASE_TOOL") - tool).eval();
}

/// The equations of xyzac-trt-kins as LinuxCNC's documentation of five axes derives them, angles in rad.
Eigen::Vector3d by_trt_pins(const std::string& text, double a, double c, const Eigen::Vector3d& point, double length) {
  const std::map<std::string, double> pins = numbers_in(text, ' ');
  const auto pin = [&](const char* name) { return pins.at(std::string("setp xyzac-trt-kins.") + name); };
  const double xr = pin("x-rot-point"), yr = pin("y-rot-point"), zr = pin("z-rot-point");
  const double dy = pin("y-offset"), dz = pin("z-offset") + length;
  const double px = point.x() - xr, py = point.y() - yr, pz = point.z() + length - zr;
  const double sa = std::sin(a), ca = std::cos(a), sc = std::sin(c), cc = std::cos(c);
  return {cc * px - sc * py + xr, sc * ca * px + cc * ca * py - sa * pz - ca * dy + sa * dz + dy + yr,
          sc * sa * px + cc * sa * py + ca * pz - sa * dy - ca * dz + dz + zr};
}

/// A turn about a line of the bed.
Eigen::Affine3d turn_about(const Eigen::Vector3d& point, const Eigen::Vector3d& direction, double angle) {
  return Eigen::Translation3d(point) * Eigen::AngleAxisd(angle, direction) * Eigen::Translation3d(-point);
}

/// The displaced line of a rotary axis by the words of docs/conventions.md.
void displaced_line(const Machine& machine, const ErrorSet& errors, std::size_t axis, Eigen::Vector3d& point,
                    Eigen::Vector3d& direction) {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero(), tilt = Eigen::Vector3d::Zero();
  for (const LocationError& location : errors.locations) {
    if (location.axis != axis) continue;
    const int c = static_cast<int>(location.component);
    (c < 3 ? shift : tilt)[c % 3] += location.value;
  }
  point = machine.axes[axis].point + shift;
  direction = Eigen::AngleAxisd(tilt.z(), Eigen::Vector3d::UnitZ()) *
              (Eigen::AngleAxisd(tilt.y(), Eigen::Vector3d::UnitY()) *
               (Eigen::AngleAxisd(tilt.x(), Eigen::Vector3d::UnitX()) * machine.axes[axis].direction));
}

/// How far the tool of the trunnion mill (w C' A' Y' b X Z t) is from the point of the workpiece at linear positions.
double miss_of_trunnion(const Machine& machine, const ErrorSet& errors, double a, double c,
                        const Eigen::Vector3d& linear, const Eigen::Vector3d& wanted) {
  Eigen::Vector3d point_a, point_c, along_a, along_c;
  displaced_line(machine, errors, machine.find_axis("A"), point_a, along_a);
  displaced_line(machine, errors, machine.find_axis("C"), point_c, along_c);
  const Eigen::Affine3d table =
      Eigen::Translation3d(0, -linear.y(), 0) * turn_about(point_a, along_a, -a) * turn_about(point_c, along_c, -c);
  const Eigen::Vector3d tool =
      machine.tool_reference + machine.tool_offset + Eigen::Vector3d(linear.x(), 0, linear.z());
  return (table.inverse() * tool - wanted).norm();
}

TEST_F(KinematicValuesTest, OfATrunnionWithItsTableAxisOffByTenMicrometresAreThoseOfAHandCalculation) {
  KinematicValuesRequest request = request_for("linuxcnc", "trunnion-mill");
  request.errors.locations.push_back({.axis = request.machine.find_axis("C"),
                                      .component = Component::X,
                                      .value = 0.010,
                                      .standard_uncertainty = 8e-4});
  KinematicValues made = make_kinematic_values(request);
  EXPECT_FALSE(made.says_no());
  EXPECT_THAT(made.file.text, HasSubstr("setp xyzac-trt-kins.conventional-directions 1\n"
                                        "setp xyzac-trt-kins.x-rot-point 0.010000\n"
                                        "setp xyzac-trt-kins.y-rot-point 0.000000\n"
                                        "setp xyzac-trt-kins.z-rot-point -560.000000\n"
                                        "setp xyzac-trt-kins.y-offset 0.020000\n"
                                        "setp xyzac-trt-kins.z-offset 50.000000\n"));
  EXPECT_NEAR(made.values[0].standard_uncertainty.value_or(0), 8e-4, 1e-9);
  request.format = "siemens";
  made = make_kinematic_values(request);
  // From the spindle to the cradle, from there to the table, and back.
  EXPECT_THAT(made.file.text, HasSubstr("$MC_TRAFO5_BASE_TOOL_1[0]=0.000000\n$MC_TRAFO5_BASE_TOOL_1[1]=0.020000\n"
                                        "$MC_TRAFO5_BASE_TOOL_1[2]=-510.000000\n$MC_TRAFO5_JOINT_OFFSET_1[0]=0.010000\n"
                                        "$MC_TRAFO5_JOINT_OFFSET_1[1]=-0.020000\n"
                                        "$MC_TRAFO5_JOINT_OFFSET_1[2]=-50.000000\n"));
  EXPECT_THAT(made.file.text, HasSubstr("$MC_TRAFO5_AXIS1_1[0]=-1.000000000\n"));
  request.tool_carrier = 7;
  EXPECT_THAT(make_kinematic_values(request).file.text, HasSubstr("$TC_CARR15[7]=0.010000\n"));
  request.tool_carrier.reset();
  request.format = "fanuc";
  EXPECT_THAT(make_kinematic_values(request).file.text,
              HasSubstr("N19700P0.000\nN19701P0.020\nN19702P-510.000\nN19703P0.010\nN19704P-0.020\nN19705P-50.000\n"));
  request.format = "values";
  made = make_kinematic_values(request);
  EXPECT_THAT(made.file.text, HasSubstr("C,machine,x_mm,0.000000,0.010000,0.000800\n"));
  EXPECT_THAT(made.file.text,
              HasSubstr("C,A,x_mm,0.000000,0.010000,0.000800\nC,A,y_mm,-0.020000,-0.020000,0.000000\n"));
}

TEST_F(KinematicValuesTest, OfATableInACradleAboutYHaveTheOffsetAlongX) {
  KinematicValuesRequest request = request_for("linuxcnc", "trunnion-mill");
  Axis& cradle = request.machine.axes[request.machine.find_axis("A")];
  cradle.name = "B";
  cradle.direction = Eigen::Vector3d::UnitY();
  cradle.point = {0.03, 0, 50};
  for (Axis& axis : request.machine.axes) axis.primed = axis.name == "Y";
  request.errors.locations.push_back({.axis = 1, .component = Component::X, .value = 0.01});
  request.errors.locations.push_back({.axis = 1, .component = Component::Z, .value = -0.02});
  const KinematicValues made = make_kinematic_values(request);
  EXPECT_NEAR(actual(made, "xyzbc-trt-kins.x-offset"), 0.04, 1e-9);
  EXPECT_NEAR(actual(made, "xyzbc-trt-kins.z-offset"), 49.98, 1e-9);
  EXPECT_LT(made.after.position_statistics.maximum, 1e-6);
  // By the right-hand rule, as the modules turn by themselves.
  EXPECT_EQ(made.file.text.find("conventional-directions"), std::string::npos);
}

TEST_F(KinematicValuesTest, TheSimulatedControlIsTheOneThatItsManualDescribes) {
  for (const std::string format : {"siemens", "linuxcnc"}) {
    KinematicValuesRequest request = request_for(format, "trunnion-mill");
    request.errors = errors_of_lines(request.machine, true);
    const KinematicValues made = make_kinematic_values(request);
    const Machine& machine = request.machine;
    double largest = 0;
    for (std::size_t k = 0; k < made.poses.count(); ++k) {
      const std::vector<double> pose = made.poses.pose(k);
      const double a = pose[machine.find_axis("A")], c = pose[machine.find_axis("C")];
      const Eigen::Vector3d wanted = nominal_workpiece_from_tool(machine, pose).translation;
      const Eigen::Vector3d point = wanted - machine.tool_reference;
      // Primed axes turn the table backwards: by the vectors of SINUMERIK, and by the pin conventional-directions.
      const Eigen::Vector3d linear = format == "siemens"
                                         ? by_siemens_vectors(made.file.text, a, c, point, machine.tool_offset)
                                         : by_trt_pins(made.file.text, -a, -c, point, -machine.tool_offset.z());
      const double miss = miss_of_trunnion(machine, request.errors, a, c, linear, wanted);
      EXPECT_NEAR(made.after.position[k], miss, 1e-9) << format << " " << k;
      largest = std::max(largest, miss);
    }
    EXPECT_GT(made.before.position_statistics.maximum, 0.03);
    if (format == "siemens") {
      EXPECT_LT(largest, 3e-6);  // rounding
    } else {
      EXPECT_GT(largest, 1e-3);  // directions are not in the module
    }
  }
}

TEST_F(KinematicValuesTest, ShiftsOfAxesAreCarriedByTheModuleAndTiltsAreNot) {
  KinematicValuesRequest request = request_for("linuxcnc", "trunnion-mill");
  request.errors = errors_of_lines(request.machine, false);
  const KinematicValues made = make_kinematic_values(request);
  EXPECT_LT(made.after.position_statistics.maximum, 3e-6);
  for (const CarriedError& error : made.errors) EXPECT_GT(error.carried(), 0.999) << error.name;
  request.errors = {};
  request.errors.locations.push_back(
      {.axis = request.machine.find_axis("C"), .component = Component::A, .value = 5e-5});
  request.least_reduction = 0;
  EXPECT_NEAR(make_kinematic_values(request).errors.front().carried(), 0, 1e-6);
}

TEST_F(KinematicValuesTest, HeadsAndMixedMachinesGetTheirOwnVectors) {
  for (const char* name : {"swivel-head-mill", "gantry-fork-head", "head-table-mill", "nutating-head-mill"}) {
    KinematicValuesRequest request = request_for("siemens", name);
    request.errors = errors_of_lines(request.machine, true);
    // Of an axis at an angle a part of some components turns about it: that is its zero position.
    if (std::string(name) == "nutating-head-mill") request.errors = errors_of_lines(request.machine, false);
    const KinematicValues made = make_kinematic_values(request);
    EXPECT_GT(made.before.position_statistics.maximum, 5e-3) << name;
    EXPECT_LT(made.after.position_statistics.maximum, 1e-5) << name;
    const Machine& machine = request.machine;
    const bool mixed = made.file.text.find("TYPE_1 = 56") != std::string::npos;
    std::vector<std::size_t> rotary;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      if (machine.axes[i].kind == AxisKind::rotary) rotary.push_back(i);
    }
    if (mixed) std::swap(rotary[0], rotary[1]);
    for (std::size_t k = 0; k < made.poses.count(); ++k) {
      std::vector<double> pose = made.poses.pose(k);
      const Eigen::Vector3d wanted = nominal_workpiece_from_tool(machine, pose).translation;
      const Eigen::Vector3d point = machine.bed_from_workpiece * wanted - machine.tool_reference;
      const Eigen::Vector3d linear =
          by_siemens_vectors(made.file.text, pose[rotary[0]], pose[rotary[1]], point, machine.tool_offset);
      for (const char* letter : {"X", "Y", "Z"}) pose[machine.find_axis(letter)] = linear[*letter - 'X'];
      const Eigen::Vector3d there = actual_workpiece_from_tool(machine, request.errors, pose).translation;
      ASSERT_LT((there - wanted).norm(), 1e-5) << name << " " << k;
    }
    request.format = "fanuc";
    request.errors = errors_of_lines(machine, false);
    EXPECT_LT(make_kinematic_values(request).after.position_statistics.maximum, 3e-3) << name;
  }
}

TEST_F(KinematicValuesTest, ZeroPositionsAreInTheGeneralValuesOnly) {
  KinematicValuesRequest request = request_for("values", "trunnion-mill");
  request.errors.locations.push_back(
      {.axis = request.machine.find_axis("A"), .component = Component::A, .value = 1e-4});
  const KinematicValues made = make_kinematic_values(request);
  EXPECT_NEAR(actual(made, "A,machine,zero_deg"), 1e-4, 1e-10);
  EXPECT_LT(made.after.position_statistics.maximum, 1e-6);
  request.format = "siemens";
  const KinematicValues without = make_kinematic_values(request);
  ASSERT_EQ(without.refused.size(), 1U);
  EXPECT_THAT(without.refused.front(), HasSubstr("the values would remove"));
  EXPECT_TRUE(without.file.text.empty());
}

TEST_F(KinematicValuesTest, UncertaintiesOfADifferenceAreThoseOfBothAxes) {
  KinematicValuesRequest request = request_for("siemens", "trunnion-mill");
  request.errors =
      read_errors(std::string(ABBE_SOURCE_DIR) + "/examples/compensate/trunnion.errors.toml", request.machine).errors;
  const KinematicValues made = make_kinematic_values(request);
  for (const KinematicValue& value : made.values) {
    if (value.name == "$MC_TRAFO5_JOINT_OFFSET_1[1]") {
      EXPECT_NEAR(value.standard_uncertainty.value_or(0), std::hypot(8e-4, 8e-4), 1e-6);
      EXPECT_NEAR(value.actual - value.nominal, -0.009 - 0.011, 1e-6);
    }
    if (value.name == "$MC_TRAFO5_AXIS2_1[1]") {
      EXPECT_NEAR(value.standard_uncertainty.value_or(0), 1.2e-6, 1e-9);
    }
  }
  EXPECT_LT(made.after.position_statistics.rms, made.before.position_statistics.rms);
}

TEST_F(KinematicValuesTest, MachinesAndRequestsThatAControlDoesNotHaveAreRefusedWithTheReason) {
  EXPECT_THAT(
      refused(request_for("linuxcnc", "swivel-head-mill")),
      HasSubstr("--for linuxcnc: B carries the head, not C along Z; expected the chain of a kinematics module"));
  EXPECT_THAT(refused(request_for("linuxcnc", "head-table-mill")), HasSubstr("one rotary axis is in the head"));
  EXPECT_THAT(refused(request_for("values", "three-axis-mill")), HasSubstr("the machine has no rotary axis"));
  EXPECT_THAT(refused(request_for("siemens", "three-axis-mill")),
              HasSubstr("--for siemens: the machine has 0 rotary axes; expected two rotary axes"));
  EXPECT_THAT(refused(request_for("siemens", "rotary-table")), HasSubstr("the machine has 1 rotary axis;"));
  KinematicValuesRequest request = request_for("siemens", "trunnion-mill");
  request.machine.axes[2].primed = false;
  EXPECT_THAT(refused(request), HasSubstr("Y does not move the tool along +X, +Y or +Z of the workpiece"));
  request = request_for("siemens", "trunnion-mill");
  std::swap(request.machine.axes[1], request.machine.axes[2]);
  EXPECT_THAT(refused(request), HasSubstr("a rotary axis carries Y"));
  request = request_for("siemens", "trunnion-mill");
  request.machine.axes[request.machine.find_axis("X")].direction = Eigen::Vector3d::UnitZ();
  EXPECT_THAT(refused(request), HasSubstr("two linear axes are parallel"));
  request = request_for("linuxcnc", "trunnion-mill");
  request.machine.axes[0].primed = false;
  EXPECT_THAT(refused(request), HasSubstr("only one of the rotary axes is primed"));
  request = request_for("linuxcnc", "trunnion-mill");
  request.tool_carrier = 1;
  EXPECT_EQ(refused(request),
            "--tool-carrier: would change nothing in values for linuxcnc; expected --for siemens; or to leave it out");
  request = request_for("siemens", "trunnion-mill");
  request.tool_carrier = 0;
  EXPECT_THAT(refused(request), HasSubstr("--tool-carrier: out of range"));
  request = request_for("tnc", "trunnion-mill");
  EXPECT_EQ(refused(request), "--for: unknown format 'tnc'; expected values, linuxcnc, siemens, fanuc, heidenhain");
  request = request_for("siemens", "trunnion-mill");
  request.limit_mm = 0;
  EXPECT_THAT(refused(request), HasSubstr("--limit-um: 0 is not a limit"));
}

TEST_F(KinematicValuesTest, AreTheSameInALocaleWithADecimalComma) {
  for (const std::string format : {"values", "linuxcnc", "siemens", "fanuc", "heidenhain"}) {
    KinematicValuesRequest request = request_for(format, "trunnion-mill");
    request.errors = errors_of_lines(request.machine, false);
    const KinematicValues expected = make_kinematic_values(request);
    if (!test::set_decimal_comma()) GTEST_SKIP() << "no locale with a decimal comma and no localedef to make one";
    const KinematicValues made = make_kinematic_values(request);
    test::unset_decimal_comma();
    EXPECT_EQ(made.file.text, expected.file.text);
    ASSERT_EQ(made.values.size(), expected.values.size());
    for (std::size_t k = 0; k < made.values.size(); ++k) EXPECT_EQ(made.values[k].actual, expected.values[k].actual);
    EXPECT_EQ(made.after.position, expected.after.position);
  }
}

TEST_F(KinematicValuesTest, AChangeAboveALimitIsInTheResult) {
  KinematicValuesRequest request = request_for("siemens", "trunnion-mill");
  request.errors.locations.push_back(
      {.axis = request.machine.find_axis("C"), .component = Component::Y, .value = 0.05});
  request.limit_mm = 0.04;
  const KinematicValues made = make_kinematic_values(request);
  EXPECT_TRUE(made.says_no());
  EXPECT_TRUE(made.file.text.empty());
  EXPECT_THAT(made.refused.front(), HasSubstr("50.000 um is above --limit-um 40: $MC_TRAFO5_JOINT_OFFSET_1[1]"));
}

/// The line of C that leans as A turns: a sag of the cradle.
KinematicValuesRequest with_sag_of(KinematicValuesRequest request, double mm_per_rad = 5e-3) {
  request.machine.states = {{.name = "tilt", .kind = StateKind::axis, .axis = request.machine.find_axis("A")},
                            {.name = "side", .kind = StateKind::approach, .axis = request.machine.find_axis("X")}};
  request.errors.locations = {
      {.axis = request.machine.find_axis("C"), .component = Component::X, .value = 20e-3},
      {.axis = request.machine.find_axis("C"), .component = Component::X, .value = mm_per_rad, .state = 0}};
  return request;
}

TEST_F(KinematicValuesTest, StatesThatFollowFromTheCommandsAreTakenAtOnePose) {
  KinematicValuesRequest request = with_sag_of(request_for("siemens", "trunnion-mill"));
  const std::size_t a = request.machine.find_axis("A");
  request.at = {{a, 0.4}};
  const KinematicValues made = make_kinematic_values(request);
  EXPECT_EQ(made.refused, std::vector<std::string>{});
  EXPECT_EQ(made.state_pose[a], 0.4);
  KinematicValuesRequest constant = request;
  constant.errors.locations = {
      {.axis = request.machine.find_axis("C"), .component = Component::X, .value = 20e-3 + 0.4 * 5e-3}};
  const KinematicValues there = make_kinematic_values(constant);
  ASSERT_EQ(made.values.size(), there.values.size());
  for (std::size_t k = 0; k < made.values.size(); ++k) EXPECT_EQ(made.values[k].actual, there.values[k].actual);
  EXPECT_EQ(made.file.text, there.file.text);
  EXPECT_TRUE(there.state_pose.empty());
  // What the sag does elsewhere is left: 5 um per rad, and twice that where C has turned it round.
  EXPECT_NEAR(made.after_at_state_pose.position_statistics.rms, there.after.position_statistics.rms, 1e-9);
  EXPECT_GT(made.after.position_statistics.rms, 10 * there.after.position_statistics.rms);
  const Axis& cradle = request.machine.axes[a];
  const double furthest = std::max(std::abs(cradle.travel_max - 0.4), std::abs(cradle.travel_min - 0.4));
  EXPECT_GT(made.after.position_statistics.maximum, 5e-3 * furthest);
  EXPECT_LT(made.after.position_statistics.maximum, 2.001 * 5e-3 * furthest);
  const KinematicValuesReport report{request.machine, made, {}, {}};
  EXPECT_THAT(kinematic_values_text(report), HasSubstr("states that follow from the commands are taken at "));
  EXPECT_NEAR(kinematic_values_json(report)["state_pose"]["A_deg"].get<double>(), 0.4 / kDegree, 1e-9);
}

TEST_F(KinematicValuesTest, ValuesOfOnePoseThatHarmElsewhereAreRefused) {
  KinematicValuesRequest request = with_sag_of(request_for("siemens", "trunnion-mill"), 50e-3);
  request.at = {{request.machine.find_axis("A"), 0.4}};
  const KinematicValues made = make_kinematic_values(request);
  ASSERT_EQ(made.refused.size(), 1U);
  EXPECT_THAT(made.refused[0], HasSubstr("would be larger with the values than without"));
  EXPECT_EQ(made.file.text, "");
}

TEST_F(KinematicValuesTest, ASideOfApproachIsNoGeometry) {
  KinematicValuesRequest request = with_sag_of(request_for("siemens", "trunnion-mill"));
  request.errors.locations[1].state = 1;
  EXPECT_THAT(refused(request), HasSubstr("depends on side (approach), which a kinematic value of a control"));
}

}  // namespace
}  // namespace abbe
