// The machine behind the test of LinuxCNC, and its judge.
//
//   linuxcnc_case prepare FOLDER   frozen compensation, damaged copies of it, poses and a program
//   linuxcnc_case judge FOLDER     what LinuxCNC commanded, against the library and against the true machine
//
// The true errors are hidden: what is frozen are identified errors that differ from them by a few per cent.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "abbe/compensate/compensated_inverse.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_errors.h"
#include "abbe/formats/machine_file.h"
#include "abbe/machine/inverse_kinematics.h"
#include "abbe/runtime/freeze.h"
#include "judging.h"

namespace abbe {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kToolLength = 50;  // of the tool table of the test
const std::string kJoints = "XYZAC";

struct Case {
  Machine machine = read_machine(ABBE_SOURCE_DIR "/examples/machines/trunnion-mill.machine.toml");
  ErrorSet truth, identified;
  Eigen::Vector3d world_zero = Eigen::Vector3d::Zero();

  Case() {
    RandomErrorOptions options;
    options.seed = 77;
    truth = random_errors(machine, options);
    scale_errors(machine, truth, {.measure = VolumetricMeasure::mean, .value_um = 100, .remove_rigid_motion = false});
    std::mt19937_64 generator(5);
    identified = nearly(truth, generator);
    machine.tool_offset.setZero();
    world_zero = nominal_workpiece_from_tool(machine, std::vector<double>(5, 0.0)).translation;
  }
  std::size_t axis(char letter) const { return machine.find_axis(std::string(1, letter)); }
  Machine with_tool(double length) const {
    Machine other = machine;
    other.tool_offset = {0, 0, -length};
    return other;
  }
};

/// World coordinates as LinuxCNC has them (mm, degrees), of nominal commands.
std::vector<double> world_of(const Case& c, const std::vector<double>& commands, double tool_length) {
  Eigen::Vector3d p = nominal_workpiece_from_tool(c.with_tool(tool_length), commands).translation - c.world_zero;
  p[2] += tool_length;
  return {p[0], p[1], p[2], commands[c.axis('A')] / kDegree, commands[c.axis('C')] / kDegree};
}

void write(const std::string& path, const std::vector<unsigned char>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file) fail("cannot write " + path);
}

std::vector<double> commands_of(const Case& c, double x, double y, double z, double a, double b) {
  std::vector<double> commands(5);
  const double values[] = {x, y, z, a, b};
  for (std::size_t k = 0; k < 5; ++k) commands[c.axis(kJoints[k])] = values[k];
  return commands;
}

void prepare(const std::string& folder) {
  const Case c;
  FreezeOptions options;
  options.poses = 200;
  options.version = "test";
  const FrozenCompensation frozen = freeze(c.machine, c.identified, options);
  if (!frozen.problem.empty()) fail(frozen.problem);
  write(folder + "/mill.abbec", frozen.bytes);
  std::vector<unsigned char> damaged = frozen.bytes;
  damaged[damaged.size() / 2] ^= 4U;
  write(folder + "/damaged.abbec", damaged);

  std::mt19937_64 generator(9);
  const auto between = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(generator);
  };
  std::ofstream poses(folder + "/poses.txt"), program(folder + "/five_axis.ngc"), start(folder + "/start.ngc");
  poses.precision(12);
  program.precision(12);
  for (int k = 0; k < 300; ++k) {
    const double length = k < 150 ? 0 : kToolLength;
    const std::vector<double> commands = commands_of(c, between(-250, 250), between(-200, 200), between(-400, -50),
                                                     kDegree * between(-100, -5), kDegree * between(-170, 170));
    for (const double value : world_of(c, commands, length)) poses << value << " ";
    poses << length << "\n";
  }
  // A closed curve in space, the tool turned along it; G43 makes the program that of the tool's point.
  program << "G21 G90 G94 G64 P0.001 T1 M6 G43\nF12000\n";
  for (int k = 0; k <= 360; k += 2) {
    const double turn = kDegree * k;
    const std::vector<double> commands =
        commands_of(c, 30 * std::cos(turn), 40 * std::sin(2 * turn), -150 + 20 * std::sin(turn),
                    -kDegree * (25 + 10 * std::cos(turn)), 0.8 * turn);
    const std::vector<double> world = world_of(c, commands, kToolLength);
    std::ostringstream place;
    place.precision(12);
    place << "X" << world[0] << " Y" << world[1] << " Z" << world[2] - kToolLength << " A" << world[3] << " C"
          << world[4];
    program << "G1 " << place.str() << "\n";
    if (k == 0) start << "G0 " << place.str() << "\n";
  }
  program << "M2\n";
}

/// Joints (mm, degrees, in LinuxCNC's order) that the library gives for a world position.
struct Library {
  Library(const Case& c, double length) : machine(c.with_tool(length)), inverse(machine, c.identified, tight()) {}
  static CorrectionOptions tight() {
    CorrectionOptions options;
    options.position_tolerance = 5e-11;
    options.orientation_tolerance = 3e-13;
    return options;
  }
  std::vector<double> nominal(const Case& c, const double* world, double length) const {
    InverseOptions options;
    options.held = {{c.axis('A'), world[3] * kDegree}, {c.axis('C'), world[4] * kDegree}};
    const Eigen::Vector3d point = c.world_zero + Eigen::Vector3d(world[0], world[1], world[2] - length);
    const InverseResult found = InverseKinematics(machine, options).solve(PoseTarget::at(point));
    if (found.solutions.empty()) fail("a pose of the test cannot be reached");
    return {found.solutions[0].position.begin(), found.solutions[0].position.begin() + 5};
  }
  std::vector<double> compensated(const std::vector<double>& nominal) const {
    std::vector<double> joints(nominal);
    std::vector<const double*> in;
    std::vector<double*> out;
    for (std::size_t i = 0; i < 5; ++i) {
      in.push_back(&nominal[i]);
      out.push_back(&joints[i]);
    }
    CorrectionStatus status = CorrectionStatus::not_run;
    inverse.correct({in, 1}, {out, &status, nullptr, nullptr});
    if (status != CorrectionStatus::reached) fail(std::string("the library: ") + correction_status_text(status));
    return joints;
  }
  Machine machine;
  CompensatedInverse inverse;
};

/// Rows: 5 world coordinates, tool length, 5 joints.
void judge_poses(const Case& c, const std::string& folder) {
  const std::vector<std::vector<double>> reached = rows(folder + "/reached.txt", 11);
  if (reached.size() != 300) fail("LinuxCNC reached " + std::to_string(reached.size()) + " poses, not 300");
  Mean difference, before, after;
  for (const std::vector<double>& row : reached) {
    const double length = row[5];
    const Library library(c, length);
    const std::vector<double> nominal = library.nominal(c, row.data(), length);
    const std::vector<double> expected = library.compensated(nominal);
    std::vector<double> joints(5);
    for (std::size_t k = 0; k < 5; ++k) {
      const std::size_t i = c.axis(kJoints[k]);
      const double unit = k < 3 ? 1 : kDegree;
      joints[i] = row[6 + k] * unit;
      difference.add(std::abs(row[6 + k] - expected[i] / unit));
    }
    const Eigen::Vector3d wanted = nominal_workpiece_from_tool(library.machine, nominal).translation;
    before.add((actual_workpiece_from_tool(library.machine, c.truth, nominal).translation - wanted).norm());
    after.add((actual_workpiece_from_tool(library.machine, c.truth, joints).translation - wanted).norm());
  }
  std::printf("300 poses: joints differ from the library's by %.1e mm or deg at most\n", difference.largest);
  std::printf(
      "tool error on the true machine: mean %.1f um, largest %.1f um; compensated: mean %.2f um, largest %.2f um\n",
      1e3 * before.mean(), 1e3 * before.largest, 1e3 * after.mean(), 1e3 * after.largest);
  if (!(difference.largest < 1e-9)) fail("joints differ");
  if (!(before.mean() > 0.05)) fail("the machine has no errors worth the test");
  if (!(after.mean() < before.mean() / 20)) fail("the tool error does not fall as far as the errors are known");
}

/// Samples of every servo cycle: 5 joints, part enabled, at standstill.
void judge_ramp(const std::string& folder) {
  const std::vector<std::vector<double>> samples = rows(folder + "/ramp.txt", 6);
  if (samples.size() < 100) fail("too few samples of the ramp");
  double largest_step = 0, moved = 0;
  std::size_t between = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    if (samples[k][5] > 0 && samples[k][5] < 1) ++between;
    for (std::size_t j = 0; j < 3; ++j) {
      largest_step = std::max(largest_step, std::abs(samples[k][j] - samples[k - 1][j]));
      moved = std::max(moved, std::abs(samples[k][j] - samples[0][j]));
    }
  }
  std::printf("enabling: %zu samples, joints move %.1f um, at most %.2f um from one cycle to the next\n", between,
              1e3 * moved, 1e3 * largest_step);
  if (samples.front()[5] != 0 || samples.back()[5] != 1) fail("the ramp does not go from 0 to 1");
  if (between < 30) fail("the ramp jumps");
  if (!(moved > 0.01) || !(largest_step < 0.1 * moved)) fail("the joints jump");
}

/// Samples of every servo cycle of the program: 5 joints, 5 world coordinates. Joints follow the world some cycles
/// later, so what counts is how far the tool is from the path.
void judge_program(const Case& c, const std::string& folder) {
  const std::vector<std::vector<double>> samples = rows(folder + "/program.txt", 10);
  if (samples.size() < 500) fail("too few samples of the program");
  const Library library(c, kToolLength);
  std::vector<Eigen::Vector3d> path;
  Mean before, after;
  constexpr std::size_t kLag = 6;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const std::vector<double> nominal = library.nominal(c, samples[k].data() + 5, kToolLength);
    path.push_back(nominal_workpiece_from_tool(library.machine, nominal).translation);
    if (k < kLag) continue;
    std::vector<double> joints(5);
    for (std::size_t j = 0; j < 5; ++j) joints[c.axis(kJoints[j])] = samples[k][j] * (j < 3 ? 1 : kDegree);
    const Eigen::Vector3d tool = actual_workpiece_from_tool(library.machine, c.truth, joints).translation;
    double nearest = 1e9;
    for (std::size_t i = k - kLag; i < k; ++i)
      nearest = std::min(nearest, distance_to_segment(tool, path[i], path[i + 1]));
    after.add(nearest);
    before.add((actual_workpiece_from_tool(library.machine, c.truth, nominal).translation - path[k]).norm());
  }
  std::printf(
      "five-axis program, %zu cycles: tool error mean %.1f um; compensated, from the path: mean %.2f, largest %.2f "
      "um\n",
      samples.size(), 1e3 * before.mean(), 1e3 * after.mean(), 1e3 * after.largest);
  if (!(after.mean() < before.mean() / 20)) fail("the program is not compensated");
}

}  // namespace
}  // namespace abbe

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::string what = argv[1], folder = argv[2];
  if (what == "prepare") abbe::prepare(folder);
  if (what == "judge") {
    const abbe::Case c;
    abbe::judge_poses(c, folder);
    abbe::judge_ramp(folder);
    abbe::judge_program(c, folder);
  }
  return 0;
}
