// The machine behind the test of COMP_FILE in LinuxCNC, and its judge.
//
//   comp_file_case prepare FOLDER               identified.errors.toml, poses.ngc, circle.ngc
//   comp_file_case judge POSES.csv CIRCLE.csv   the traces of both programs, against the equation of a correction and
//                                               against the true machine
//
// The machine has errors that a table per joint can carry: of every axis the positioning error, the zero position error
// and play (a reversal value). They are hidden: tables are made from identified errors that differ by a few per cent.
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_errors.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "judging.h"

namespace abbe {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr std::size_t kAxes = 5;
const std::string kLetters = "XYZAC";  // order of the trace
constexpr std::size_t kPoses = 40;
constexpr std::size_t kStanding = 20;  // cycles at one place: a pose, less than the dwell
const std::string kDwell = "G4 P0.05\n";
constexpr double kFeed = 6000;  // mm/min
constexpr int kCirclePoints = 720;

using Positions = std::vector<double>;  // mm, degrees, in the order of kLetters

struct Case {
  Machine machine = read_machine(ABBE_SOURCE_DIR "/examples/machines/trunnion-mill.machine.toml");
  ErrorSet truth, identified;
  std::vector<Positions> poses;

  Case() {
    RandomErrorOptions options;
    options.seed = 31;
    options.only = {"EXX", "EYY", "EZZ", "EAA", "ECC", "EX0X", "EY0Y", "EZ0Z", "EA0A", "EC0C"};
    truth = random_errors(machine, options);
    scale_errors(machine, truth, {.measure = VolumetricMeasure::mean, .value_um = 100, .remove_rigid_motion = false});
    const double play[] = {0.012, 0.008, 0.006, 60e-6, 40e-6};  // mm, rad: lost motion, so negative reversal values
    for (std::size_t k = 0; k < kAxes; ++k) truth.reversals.push_back({axis(k), -play[k], 0});
    std::mt19937_64 generator(6);
    identified = nearly(truth, 0.02, generator);
    const auto between = [&](double from, double to) {
      return std::uniform_real_distribution<double>(from, to)(generator);
    };
    for (std::size_t k = 0; k < kPoses; ++k) {
      poses.push_back(
          {between(-250, 250), between(-200, 200), between(-450, -50), between(-100, 20), between(20, 340)});
    }
  }
  std::size_t axis(std::size_t k) const { return machine.find_axis(kLetters.substr(k, 1)); }
  double unit(std::size_t k) const { return machine.axes[axis(k)].kind == AxisKind::rotary ? kDegree : 1; }

  std::vector<double> in_chain(const Positions& positions) const {
    std::vector<double> commands(kAxes);
    for (std::size_t k = 0; k < kAxes; ++k) commands[axis(k)] = positions[k] * unit(k);
    return commands;
  }
  Eigen::Vector3d nominal(const Positions& positions) const {
    return nominal_workpiece_from_tool(machine, in_chain(positions)).translation;
  }
  Eigen::Vector3d actual(const Positions& positions) const {
    return actual_workpiece_from_tool(machine, truth, in_chain(positions)).translation;
  }

  /// What is to be added to a command so that the identified error goes away, mm or degrees: c with
  /// s (q + c + z) + e(q + c) = s q, after an approach from the given side.
  double correction(std::size_t k, double position, int approach) const {
    const std::size_t i = axis(k);
    const auto own = static_cast<Component>(std::string("XYZABC").find(kLetters[k]));
    double zero = 0, reversal = 0;
    for (const LocationError& location : identified.locations) {
      if (location.axis == i && location.component == own) zero += location.value;
    }
    for (const Reversal& known : identified.reversals) {
      if (known.axis == i) reversal = known.value;
    }
    const double q = position * unit(k), sense = machine.axes[i].sense();
    double c = 0;
    for (int turn = 0; turn < 20; ++turn) {
      c = -zero - identified.evaluate(i, q + c)[static_cast<std::size_t>(own)] / sense;
    }
    return (c - approach * reversal / 2) / unit(k);
  }
};

/// Axes with play: the slide stays until its drive has gone through half of it.
class Slides {
 public:
  explicit Slides(const Case& c) : half_play_(kAxes, 0.0) {
    for (std::size_t k = 0; k < kAxes; ++k) {
      for (const Reversal& reversal : c.truth.reversals) {
        if (reversal.axis == c.axis(k)) half_play_[k] = -reversal.value / c.unit(k) / 2;
      }
    }
  }
  const Positions& follow(const Positions& motors) {
    if (at_.empty()) at_ = motors;
    for (std::size_t k = 0; k < kAxes; ++k) {
      at_[k] = std::min(std::max(at_[k], motors[k] - half_play_[k]), motors[k] + half_play_[k]);
    }
    return at_;
  }

 private:
  std::vector<double> half_play_;
  Positions at_;
};

/// A closed curve in space on which all axes move and turn back.
Positions circle(int k) {
  const double turn = 2 * std::numbers::pi * k / kCirclePoints;
  return {70 * std::cos(turn), 60 * std::sin(turn), -250 + 20 * std::sin(2 * turn), -40 + 12 * std::cos(turn),
          180 + 30 * std::sin(turn)};
}

void write_words(std::ofstream& program, const Positions& positions, double offset = 0) {
  for (std::size_t k = 0; k < kAxes; ++k) program << " " << kLetters[k] << positions[k] + offset;
  program << "\n";
}

std::ofstream program_file(const std::string& path) {
  std::ofstream program(path);
  program << std::fixed;
  program.precision(9);
  program << "G21 G90 G94 G61 F" << kFeed << "\n";
  return program;
}

void prepare(const std::string& folder) {
  const Case c;
  write_errors(folder + "/identified.errors.toml", c.machine, {c.identified, {}, {}});
  std::ofstream poses = program_file(folder + "/poses.ngc");
  for (const Positions& pose : c.poses) {
    for (const double side : {-3.0, 3.0}) {
      poses << "G0";
      write_words(poses, pose, side);
      poses << "G0";
      write_words(poses, pose);
      poses << kDwell;
    }
  }
  poses << "G0";  // a trace ends with the last motion
  write_words(poses, c.poses.back(), 3);
  poses << "M2\n";
  std::ofstream path = program_file(folder + "/circle.ngc");
  for (int k = 0; k <= kCirclePoints; ++k) {
    path << (k == 0 ? "G0" : "G1");
    write_words(path, circle(k));
    if (k == 0) path << kDwell;
  }
  path << "M2\n";
}

std::vector<Positions> trace(const std::string& path) {
  std::vector<Positions> all = rows(path, 1 + kAxes);
  if (all.empty()) fail("no trace in " + path);
  for (Positions& row : all) row.erase(row.begin());
  return all;
}

double largest_difference(const Positions& one, const Positions& other) {
  double largest = 0;
  for (std::size_t k = 0; k < kAxes; ++k) largest = std::max(largest, std::abs(one[k] - other[k]));
  return largest;
}

/// Where LinuxCNC stood: each pose, first from below, then from above.
void judge_poses(const Case& c, const std::string& file) {
  Slides slides(c);
  std::vector<Positions> motors, standing;
  std::size_t since = 0;
  const std::vector<Positions> all = trace(file);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Positions& slide = slides.follow(all[k]);
    if (k > 0 && all[k] != all[k - 1]) since = k;
    // On a busy computer it may also stand where it turns round, 3 mm and degrees away.
    const std::size_t n = motors.size();
    if (k - since == kStanding && n < 2 * kPoses && largest_difference(all[k], c.poses[n / 2]) < 1) {
      motors.push_back(all[k]);
      standing.push_back(slide);
    }
  }
  if (motors.size() != 2 * kPoses) {
    fail("LinuxCNC stood at " + std::to_string(motors.size()) + " places, not at " + std::to_string(2 * kPoses));
  }
  Slides uncompensated(c);
  Mean before, after, off_um, off_urad;
  for (std::size_t n = 0; n < motors.size(); ++n) {
    const Positions& pose = c.poses[n / 2];
    const int approach = n % 2 == 0 ? 1 : -1;
    Positions from(pose), known(pose);
    for (std::size_t k = 0; k < kAxes; ++k) {
      from[k] -= 3 * approach;
      known[k] += c.correction(k, pose[k], approach);
      const double difference = std::abs(motors[n][k] - known[k]) * c.unit(k);
      (c.unit(k) == 1 ? off_um : off_urad).add(1e3 * difference * (c.unit(k) == 1 ? 1 : 1e3));
    }
    const Eigen::Vector3d wanted = c.nominal(pose);
    uncompensated.follow(from);
    before.add((c.actual(uncompensated.follow(pose)) - wanted).norm());
    after.add((c.actual(standing[n]) - wanted).norm());
  }
  std::printf("%zu poses from both sides: motors differ from the exact corrections by %.3f um, %.3f urad at most\n",
              kPoses, off_um.largest, off_urad.largest);
  std::printf("tool error: mean %.1f um, largest %.1f um; compensated: mean %.2f um, largest %.2f um\n",
              1e3 * before.mean(), 1e3 * before.largest, 1e3 * after.mean(), 1e3 * after.largest);
  // The tables keep to 0.2 um and 0.2 urad; LinuxCNC's files have 7 decimals, of degrees 0.002 urad.
  if (!(off_um.largest < 0.21) || !(off_urad.largest < 0.21)) fail("LinuxCNC does not command the corrections");
  if (!(before.mean() > 0.05)) fail("the machine has no errors worth the test");
  if (!(after.mean() < before.mean() / 20)) fail("the tool error does not fall as far as the errors are known");
}

void judge_circle(const Case& c, const std::string& file) {
  std::vector<Eigen::Vector3d> path;
  Slides uncompensated(c);
  Mean before, after;
  for (int k = 0; k <= 8 * kCirclePoints; ++k) {
    const int corner = std::min(k / 8, kCirclePoints - 1);
    const double share = (k - 8 * corner) / 8.0;
    const Positions from = circle(corner), to = circle(corner + 1);
    Positions between(kAxes);
    for (std::size_t i = 0; i < kAxes; ++i) between[i] = from[i] + share * (to[i] - from[i]);
    path.push_back(c.nominal(between));
    before.add((c.actual(uncompensated.follow(between)) - path.back()).norm());
  }
  Slides slides(c);
  std::size_t on = 0, since = 0, turning = 0;
  bool started = false;
  const std::vector<Positions> all = trace(file);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Positions& slide = slides.follow(all[k]);
    if (k > 0 && all[k] != all[k - 1]) since = k;
    // It stands where the curve begins.
    started = started || (k - since == kStanding && largest_difference(all[k], circle(0)) < 1);
    if (!started) continue;
    const Eigen::Vector3d tool = c.actual(slide);
    double nearest = std::numeric_limits<double>::infinity();
    std::size_t best = on;
    for (std::size_t i = on; i < std::min(on + 40, path.size() - 1); ++i) {
      const double distance = distance_to_segment(tool, path[i], path[i + 1]);
      if (distance < nearest) {
        nearest = distance;
        best = i;
      }
    }
    on = best > 4 ? std::max(on, best - 4) : on;
    after.add(nearest);
    turning += nearest > 2.5e-3;
  }
  if (!started || on + 10 < path.size() - 1) fail("LinuxCNC does not go round the curve");
  std::printf(
      "curve of five axes, %zu cycles: tool error mean %.1f um, largest %.1f um; compensated, from the path: mean "
      "%.2f um, largest %.2f um; %zu cycles more than 2.5 um from it, where axes turn round\n",
      after.count, 1e3 * before.mean(), 1e3 * before.largest, 1e3 * after.mean(), 1e3 * after.largest, turning);
  if (!(after.mean() < before.mean() / 20)) fail("the program is not compensated");
  // LinuxCNC takes up play once an axis has turned round, within cycles.
  if (!(after.largest < before.largest / 6) || turning > 150) fail("the program is not compensated where axes turn");
}

}  // namespace
}  // namespace abbe

int main(int argc, char** argv) {
  const std::string what = argc > 2 ? argv[1] : "";
  if (what == "prepare" && argc == 3) {
    abbe::prepare(argv[2]);
    return 0;
  }
  if (what != "judge" || argc != 4) return 2;
  const abbe::Case c;
  abbe::judge_poses(c, argv[2]);
  abbe::judge_circle(c, argv[3]);
  return 0;
}
