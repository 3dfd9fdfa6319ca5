// Pins for LinuxCNC in the equations of its modules, written down again from their sources.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <map>
#include <sstream>

#include "abbe/controls/kinematic_values.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kTool = 150;

using Pins = std::map<std::string, double>;

Pins pins_of(const std::string& text) {
  Pins pins;
  std::istringstream lines(text);
  for (std::string word; lines >> word;) {
    if (word != "setp") continue;
    std::string name;
    lines >> name;
    lines >> pins[name.substr(name.find('.') + 1)];
  }
  return pins;
}

Machine machine_of(const std::string& chain, const std::string& axes) {
  return parse_machine("name = \"mill\"\nchain = \"" + chain +
                           "\"\n[axis.X]\ntravel_mm = [-300, 300]\n[axis.Y]\ntravel_mm = [-300, 300]\n"
                           "[axis.Z]\ntravel_mm = [-400, 0]\n" +
                           axes + "[tool]\nreference_mm = [0, 0, 560]\noffset_mm = [0, 0, -150]\n",
                       "mill.machine.toml");
}

Machine dual_table() {
  return machine_of("w A' B' Y' b X Z t",
                    "[axis.A]\npoint_mm = [3, 20, 70]\ntravel_deg = [-40, 200]\n"
                    "[axis.B]\npoint_mm = [-12, 5, 40]\ntravel_deg = [-90, 90]\n");
}
Machine meeting_head() {
  return machine_of("w Y' b X Z C B t",
                    "[axis.C]\npoint_mm = [0, 0, 0]\ntravel_deg = [-200, 200]\n"
                    "[axis.B]\npoint_mm = [0, 7, 810]\ndirection = [0, -1, 0]\ntravel_deg = [-100, 100]\n");
}
Machine nutating_head(bool a) {
  const std::string axes = a ? "[axis.A]\npoint_mm = [4, 30, 200]\ntravel_deg = [-90, 90]\n"
                               "[axis.C]\npoint_mm = [9, -55, 0]\ntravel_deg = [-180, 180]\n"
                               "[axis.B]\npoint_mm = [0, -60, 740]\ndirection = [0, 0.6, 0.8]\ntravel_deg = [0, 180]\n"
                             : "[axis.B]\npoint_mm = [30, 4, 200]\ntravel_deg = [-90, 90]\n"
                               "[axis.C]\npoint_mm = [-55, 9, 0]\ntravel_deg = [-180, 180]\n"
                               "[axis.A]\npoint_mm = [-60, 0, 740]\ndirection = [0.6, 0, 0.8]\ntravel_deg = [0, 180]\n";
  return machine_of(a ? "w A' Y' b X Z C B t" : "w B' Y' b X Z C A t", axes);
}

/// Joints X, Y, Z from pins, the point in LinuxCNC's world (tip + length of the tool along Z) and angles in rad.
using Inverse = std::function<Vector3d(const Pins&, const Vector3d&, const std::map<char, double>&)>;

/// kinematicsInverse() of xyzab_tdr_kins.comp, type 1.
Vector3d dual_table_joints(const Pins& pin, const Vector3d& at, const std::map<char, double>& angle) {
  const double xr = pin.at("x-rot-point"), yr = pin.at("y-rot-point"), zr = pin.at("z-rot-point");
  const double dx = 37;  // the pin x-offset drops out
  const double dz = pin.at("z-offset"), dt = kTool;
  const double sa = std::sin(angle.at('A')), ca = std::cos(angle.at('A'));
  const double sb = std::sin(angle.at('B')), cb = std::cos(angle.at('B'));
  const double qx = at.x() - xr - dx, qy = at.y() - yr, qz = at.z() - zr - dz - dt;
  return {cb * qx + sa * sb * qy - ca * sb * qz + cb * dx - sb * dz + xr, ca * qy + sa * qz + yr,
          sb * qx - sa * cb * qy + ca * cb * qz + sb * dx + cb * dz + zr + dt};
}

/// kinematicsInverse() of 5axiskins.c with W at zero.
Vector3d meeting_head_joints(const Pins& pin, const Vector3d& at, const std::map<char, double>& angle) {
  const double pivot = pin.at("in0") + kTool, theta = angle.at('C'), phi = 180 * kDegree - angle.at('B');
  const Vector3d r = pivot * Vector3d(std::sin(phi) * std::cos(theta), std::sin(phi) * std::sin(theta), std::cos(phi));
  return at - r - Vector3d(0, 0, pivot);
}

/// trsrnInverse() of xyzacb_trsrn.comp, TCP.
Vector3d xyzacb_joints(const Pins& pin, const Vector3d& at, const std::map<char, double>& angle) {
  const double Ly = pin.at("y-pivot"), Lz = pin.at("z-pivot"), Dx = pin.at("x-offset"), Dy = pin.at("y-offset");
  const double Dray = pin.at("y-rot-axis") - (Dy + Ly), Draz = pin.at("z-rot-axis") - Lz, Dt = kTool;
  const double nu = pin.at("nut-angle") * kDegree, Sv = std::sin(nu), Cv = std::cos(nu);
  const double Sw = std::sin(angle.at('A')), Cw = std::cos(angle.at('A'));
  const double Ss = std::sin(angle.at('B')), Cs = std::cos(angle.at('B'));
  const double Sp = std::sin(angle.at('C')), Cp = std::cos(angle.at('C'));
  const double CvSs = Cv * Ss, SvSs = Sv * Ss;
  const double r = Cs + Sv * Sv * (1 - Cs), s = Cs + Cv * Cv * (1 - Cs), t = Sv * Cv * (1 - Cs);
  return {(Cp * SvSs - Sp * t) * (Dt + Lz) + Cp * Dx - (Cp * CvSs + Sp * r) * Ly - Dy * Sp - Dx + at.x(),
          Cp * Dy + Dx * Sp - Cw * (Dray + Dy + Ly - at.y()) + (Sp * SvSs + Cp * t) * (Dt + Lz) -
              (CvSs * Sp - Cp * r) * Ly - (Draz + Dt + Lz - at.z()) * Sw + Dray,
          (Dt + Lz) * s + Ly * t - Cw * (Draz + Dt + Lz - at.z()) + (Dray + Dy + Ly - at.y()) * Sw + Draz};
}

/// trsrnInverse() of xyzbca_trsrn.comp, TCP.
Vector3d xyzbca_joints(const Pins& pin, const Vector3d& at, const std::map<char, double>& angle) {
  const double Lx = pin.at("x-pivot"), Lz = pin.at("z-pivot"), Dx = pin.at("x-offset"), Dy = pin.at("y-offset");
  const double Drax = pin.at("x-rot-axis") - Lx - Dx, Draz = pin.at("z-rot-axis") - Lz, Dt = kTool;
  const double nu = pin.at("nut-angle") * kDegree, Sv = std::sin(nu), Cv = std::cos(nu);
  const double Sw = std::sin(angle.at('B')), Cw = std::cos(angle.at('B'));
  const double Ss = std::sin(angle.at('A')), Cs = std::cos(angle.at('A'));
  const double Sp = std::sin(angle.at('C')), Cp = std::cos(angle.at('C'));
  const double CvSs = Cv * Ss, SvSs = Sv * Ss;
  const double r = Cs + Sv * Sv * (1 - Cs), s = Cs + Cv * Cv * (1 - Cs), t = Sv * Cv * (1 - Cs);
  return {Cp * Dx - Dy * Sp - Cw * (Drax + Dx + Lx - at.x()) + (Sp * SvSs + Cp * t) * (Dt + Lz) -
              (CvSs * Sp - Cp * r) * Lx + (Draz + Dt + Lz - at.z()) * Sw + Drax,
          -(Cp * SvSs - Sp * t) * (Dt + Lz) + Cp * Dy + (Cp * CvSs + Sp * r) * Lx + Dx * Sp - Dy + at.y(),
          (Dt + Lz) * s + Lx * t - Cw * (Draz + Dt + Lz - at.z()) - (Drax + Dx + Lx - at.x()) * Sw + Draz};
}

ErrorSet location(const Machine& machine, const std::string& axis, Component component, double value) {
  ErrorSet errors;
  errors.locations.push_back({.axis = machine.find_axis(axis), .component = component, .value = value});
  return errors;
}

KinematicValues made_for(const Machine& machine, const ErrorSet& errors) {
  KinematicValuesRequest request;
  request.format = "linuxcnc";
  request.machine = machine;
  request.errors = errors;
  request.positions = 3;
  request.least_reduction = 0;
  return make_kinematic_values(request);
}

/// The largest distance (mm) of the tool of the machine with errors from where the program has it, with joints by the
/// equations of the module. It has to be what the report says at every pose.
double largest_miss(const Machine& machine, const ErrorSet& errors, const Inverse& joints) {
  const KinematicValues made = made_for(machine, errors);
  EXPECT_FALSE(made.says_no());
  const Pins pins = pins_of(made.file.text);
  double largest = 0;
  for (std::size_t k = 0; k < made.poses.count(); ++k) {
    std::vector<double> pose = made.poses.pose(k);
    std::map<char, double> angle;
    for (std::size_t i = 0; i < pose.size(); ++i) angle[machine.axes[i].name.front()] = pose[i];
    const Vector3d wanted = nominal_workpiece_from_tool(machine, pose).translation;
    const Vector3d linear = joints(pins, wanted - machine.tool_reference + Vector3d(0, 0, kTool), angle);
    for (const char letter : {'X', 'Y', 'Z'}) pose[machine.find_axis(std::string(1, letter))] = linear[letter - 'X'];
    const double miss = (actual_workpiece_from_tool(machine, errors, pose).translation - wanted).norm();
    EXPECT_NEAR(made.after.position[k], miss, 1e-8) << k;
    largest = std::max(largest, miss);
  }
  return largest;
}

TEST(LinuxcncModules, WithoutErrorsTheirEquationsAreThoseOfTheMachine) {
  EXPECT_LT(largest_miss(dual_table(), {}, dual_table_joints), 1e-6);
  EXPECT_LT(largest_miss(meeting_head(), {}, meeting_head_joints), 1e-6);
  EXPECT_LT(largest_miss(nutating_head(true), {}, xyzacb_joints), 3e-6);
  EXPECT_LT(largest_miss(nutating_head(false), {}, xyzbca_joints), 3e-6);
}

struct CarriedCase {
  Machine machine;
  Inverse joints;
  std::string axis;
  Component component;
  bool carried;
};

TEST(LinuxcncModules, CarryWhatTheirPinsStateAndNothingElse) {
  using enum Component;
  const std::vector<CarriedCase> cases = {
      {dual_table(), dual_table_joints, "B", X, true},      {dual_table(), dual_table_joints, "B", Z, true},
      {dual_table(), dual_table_joints, "A", Y, true},      {dual_table(), dual_table_joints, "A", Z, true},
      {dual_table(), dual_table_joints, "A", C, false},     {dual_table(), dual_table_joints, "B", A, false},
      {meeting_head(), meeting_head_joints, "B", Z, true},  {meeting_head(), meeting_head_joints, "B", X, false},
      {meeting_head(), meeting_head_joints, "C", Y, false}, {nutating_head(true), xyzacb_joints, "A", Y, true},
      {nutating_head(true), xyzacb_joints, "A", Z, true},   {nutating_head(true), xyzacb_joints, "C", X, true},
      {nutating_head(true), xyzacb_joints, "C", Y, true},   {nutating_head(true), xyzacb_joints, "B", X, false},
      {nutating_head(true), xyzacb_joints, "C", A, false},  {nutating_head(false), xyzbca_joints, "B", X, true},
      {nutating_head(false), xyzbca_joints, "B", Z, true},  {nutating_head(false), xyzbca_joints, "C", X, true},
      {nutating_head(false), xyzbca_joints, "C", Y, true},  {nutating_head(false), xyzbca_joints, "A", Y, false},
      {nutating_head(false), xyzbca_joints, "B", C, false}};
  for (const CarriedCase& one : cases) {
    const double value = is_rotation(one.component) ? 6e-5 : 0.02;
    const double miss = largest_miss(one.machine, location(one.machine, one.axis, one.component, value), one.joints);
    const std::string name =
        one.machine.chain() + " " + one.axis + " " + std::to_string(static_cast<int>(one.component));
    if (one.carried) {
      EXPECT_LT(miss, 5e-6) << name;
    } else {
      EXPECT_GT(miss, 5e-4) << name;
    }
  }
}

TEST(LinuxcncModules, TheAngleOfANutatingAxisIsCarried) {
  for (const bool a : {true, false}) {
    const Machine machine = nutating_head(a);
    // About the axis across its plane, and shifted in it.
    ErrorSet errors = location(machine, a ? "B" : "A", a ? Component::A : Component::B, 8e-5);
    errors.locations.push_back({.axis = errors.locations[0].axis, .component = Component::Z, .value = -0.03});
    EXPECT_LT(largest_miss(machine, errors, a ? Inverse(xyzacb_joints) : Inverse(xyzbca_joints)), 1e-5) << a;
    const KinematicValues made = made_for(machine, errors);
    EXPECT_GT(made.before.position_statistics.maximum, 0.02);
    EXPECT_THAT(made.file.text, HasSubstr(a ? "xyzacb_trsrn_kins.nut-angle" : "xyzbca_trsrn_kins.nut-angle"));
  }
}

TEST(LinuxcncModules, AreChosenByTheChainAndOthersAreRefusedWithTheReason) {
  EXPECT_THAT(made_for(dual_table(), {}).file.text,
              HasSubstr("setp xyzab_tdr_kins.x-rot-point -12.000000\nsetp xyzab_tdr_kins.y-rot-point 20.000000\n"
                        "setp xyzab_tdr_kins.z-rot-point -520.000000\nsetp xyzab_tdr_kins.z-offset 30.000000\n"));
  EXPECT_THAT(made_for(meeting_head(), {}).file.text, HasSubstr("setp spindle-pivot.in0 250.000000\n"));
  EXPECT_THAT(made_for(nutating_head(true), {}).file.text,
              HasSubstr("setp xyzacb_trsrn_kins.y-pivot -60.000000\nsetp xyzacb_trsrn_kins.z-pivot 180.000000\n"
                        "setp xyzacb_trsrn_kins.x-offset 9.000000\nsetp xyzacb_trsrn_kins.y-offset 5.000000\n"
                        "setp xyzacb_trsrn_kins.y-rot-axis 30.000000\nsetp xyzacb_trsrn_kins.z-rot-axis -360.000000\n"
                        "setp xyzacb_trsrn_kins.nut-angle 36.869897646\n"));
  const auto refused = [](Machine machine, const std::function<void(Machine&)>& change) {
    change(machine);
    return message_of([&] { made_for(machine, {}); });
  };
  EXPECT_THAT(refused(dual_table(), [](Machine& m) { m.axes[0].primed = false; }), HasSubstr("is not primed"));
  EXPECT_THAT(refused(meeting_head(), [](Machine& m) { m.axes[m.find_axis("B")].direction.y() = 1; }),
              HasSubstr("5axiskins turns B about -Y, against ISO 841, and the head has B about (0, 1, 0)"));
  EXPECT_THAT(refused(meeting_head(), [](Machine& m) { m.axes[m.find_axis("C")].point.x() = 0.1; }),
              HasSubstr("meet in the line of the spindle"));
  EXPECT_THAT(refused(nutating_head(true), [](Machine& m) { m.axes[m.find_axis("B")].point.x() = 0.1; }),
              HasSubstr("B does not meet the line of the spindle"));
  EXPECT_THAT(refused(nutating_head(true), [](Machine& m) { m.axes[0].primed = false; }), HasSubstr("turns A'"));
  EXPECT_THAT(refused(nutating_head(false), [](Machine& m) { m.axes[m.find_axis("A")].name = "B2"; }),
              HasSubstr("B2 does not lie in the plane of X and Z"));
}

}  // namespace
}  // namespace abbe
