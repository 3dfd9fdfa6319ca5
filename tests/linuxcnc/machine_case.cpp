// Poses and a program for the kinematics module on one machine, and the judge of what LinuxCNC commanded.
//
//   machine_case prepare|judge FOLDER MACHINE JOINTS WORDS tool|axes POSES stated|unstated
//
// JOINTS are the axes in the order of joints ("X,Y,Z,C1,A"), WORDS their words in a program ("XYZCA"); stated: the
// frozen compensation has its uncertainty. Judged against the library and against the true machine with its errors.
#include <Eigen/Eigenvalues>
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
#include "abbe/runtime/abbe_runtime.h"
#include "hidden_machine.h"
#include "judging.h"

namespace abbe {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kOnTheWay = 1;        // mm, degrees; nominal joints may leave the travel by it between poses,
constexpr double kSpare = 12;          // and joints of LinuxCNC by it: corrections are up to 10 mm near singularities
constexpr double kLargestTurn = 2e-3;  // rad, of corrections: some ten times the errors of direction
constexpr int kProgramBlocks = 180;

struct Job {
  HiddenMachine hidden;
  std::string folder;
  std::size_t poses = 0;
  bool stated = true;
};

/// A place where LinuxCNC stands still.
struct Place {
  std::vector<double> commands;  // nominal, chain order; mm, rad
  int tool = 0;
};

class Planner {
 public:
  explicit Planner(const Job& job)
      : hidden_(job.hidden), without_(hidden_, {0, 0, 0}), with_(hidden_, hidden_.tool_offset) {}

  Eigen::Vector3d offset(int tool) const { return tool == 0 ? Eigen::Vector3d(0, 0, 0) : hidden_.tool_offset; }
  const Library& library(int tool) const { return tool == 0 ? without_ : with_; }

  /// Where poses may be, chain order; settings only where the linear axes of all machines here are independent.
  void range(std::size_t axis, double& from, double& to) const {
    const Axis& a = hidden_.machine.axes[axis];
    const double margin = a.kind == AxisKind::rotary ? 0.5 * kDegree : 1;
    from = a.endless ? -170 * kDegree : a.travel_min + margin;
    to = a.endless ? 170 * kDegree : a.travel_max - margin;
    if (a.setting && !a.endless) to = std::min(to, from + 60 * kDegree);
  }

  /// Where the machine is homed: at zero or the end of travel that is nearest to it.
  std::vector<double> home() const {
    std::vector<double> commands;
    for (const Axis& axis : hidden_.machine.axes)
      commands.push_back(axis.endless ? 0 : std::clamp(0.0, axis.travel_min, axis.travel_max));
    return commands;
  }

  /// True if the library reaches the pose as far as the machine can, and not close to a singularity, where turns are so
  /// large that they take the rounding of directions with them.
  bool can_stand(const Place& place) const {
    CorrectionStatus status = CorrectionStatus::not_run;
    const std::vector<double> joints = library(place.tool).compensated(place.commands, status);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (hidden_.machine.axes[i].kind == AxisKind::rotary && std::abs(joints[i] - place.commands[i]) > kLargestTurn)
        return false;
    }
    return status == CorrectionStatus::reached || status == CorrectionStatus::orientation_left;
  }

  /// True if a straight move of the world keeps all joints within the limits of the configuration.
  bool can_move(const Place& from, const Place& to) const {
    const std::vector<double> start = hidden_.world_of(from.commands, offset(to.tool));
    const std::vector<double> end = hidden_.world_of(to.commands, offset(to.tool));
    for (const int steps : {8, 150}) {
      for (int k = 0; k <= steps; ++k) {
        std::vector<double> world(start);
        for (std::size_t j = 0; j < world.size(); ++j) world[j] += (end[j] - start[j]) * k / steps;
        if (!within_travel(library(to.tool).nominal(world.data()))) return false;
      }
    }
    return true;
  }

  bool within_travel(const std::vector<double>& commands) const {
    for (std::size_t i = 0; i < commands.size(); ++i) {
      const Axis& axis = hidden_.machine.axes[i];
      const double spare = kOnTheWay * (axis.kind == AxisKind::rotary ? kDegree : 1);
      if (!axis.endless && !(commands[i] > axis.travel_min - spare && commands[i] < axis.travel_max + spare))
        return false;
    }
    return !commands.empty();
  }

 private:
  const HiddenMachine& hidden_;
  Library without_, with_;
};

/// Places all over the travel that a straight move reaches from each other.
std::vector<Place> choose_poses(const Job& job, const Planner& planner, std::mt19937_64& generator) {
  std::vector<Place> places;
  Place last{planner.home(), 0};
  for (int tried = 0; places.size() < job.poses; ++tried) {
    if (tried > 200000) fail("too few poses can be reached by straight moves");
    Place next{last.commands, places.size() < job.poses / 2 ? 0 : 1};
    if (next.tool != last.tool) last = {planner.home(), next.tool};
    for (std::size_t i = 0; i < next.commands.size(); ++i) {
      double from = 0, to = 0;
      planner.range(i, from, to);
      next.commands[i] = std::uniform_real_distribution<double>(from, to)(generator);
    }
    if (!planner.can_move(last, next) || !planner.can_stand(next)) continue;
    // The tool is changed at home.
    if (places.size() + 1 == job.poses / 2 && !planner.can_move(next, {planner.home(), 0})) continue;
    places.push_back(next);
    last = next;
  }
  return places;
}

/// A curve in space with all axes moving, but settings.
std::vector<Place> choose_program(const Job& job, const Planner& planner, const Place& last,
                                  std::mt19937_64& generator) {
  const std::size_t axes = last.commands.size();
  for (int tried = 0; tried < 20000; ++tried) {
    std::vector<double> centre(axes), amplitude(axes);
    for (std::size_t i = 0; i < axes; ++i) {
      double from = 0, to = 0;
      planner.range(i, from, to);
      centre[i] = std::uniform_real_distribution<double>(0.7 * from + 0.3 * to, 0.3 * from + 0.7 * to)(generator);
      const Axis& axis = job.hidden.machine.axes[i];
      amplitude[i] = std::min(0.1 * (to - from), axis.kind == AxisKind::rotary ? 10 * kDegree : 40);
      if (axis.setting) amplitude[i] = 0;
    }
    std::vector<Place> curve;
    bool sound = true;
    for (int k = 0; k <= kProgramBlocks && sound; ++k) {
      const double turn = 2 * std::numbers::pi * k / kProgramBlocks;
      Place place{centre, 1};
      for (std::size_t i = 0; i < axes; ++i)
        place.commands[i] += amplitude[i] * std::sin((i % 2 == 0 ? 1 : 2) * turn + 0.5 * static_cast<double>(i));
      sound = planner.can_stand(place) && planner.can_move(curve.empty() ? last : curve.back(), place);
      curve.push_back(place);
    }
    if (sound) return curve;
  }
  fail("no program fits the machine");
}

void prepare(const Job& job) {
  const HiddenMachine& hidden = job.hidden;
  const double lattice = write_frozen(hidden, job.folder + "/machine.abbec", job.stated);
  std::ofstream(job.folder + "/lattice.txt") << lattice << "\n";
  const Planner planner(job);
  const auto file = [&](const char* name) {
    std::ofstream out(job.folder + "/" + name);
    out.precision(14);
    return out;
  };
  std::ofstream joints = file("joints.txt");
  const std::vector<double> home = planner.home();
  for (std::size_t j = 0; j < hidden.count(); ++j) {
    const Axis& axis = hidden.machine.axes[hidden.axis_of_joint[j]];
    const double from = axis.endless ? -99999 : axis.travel_min / hidden.unit(j) - kSpare;
    const double to = axis.endless ? 99999 : axis.travel_max / hidden.unit(j) + kSpare;
    joints << hidden.wiring.words[j] << " " << from << " " << to << " "
           << home[hidden.axis_of_joint[j]] / hidden.unit(j) << "\n";
  }
  const Eigen::Vector3d& t = hidden.tool_offset;
  file("tools.tbl") << "T1 P1 X" << t[0] << " Y" << t[1] << " Z" << t[2] << " D6 ;the machine's tool\n";

  std::mt19937_64 generator(9);
  const std::vector<Place> places = choose_poses(job, planner, generator);
  std::ofstream poses = file("poses.txt");
  const auto write = [&](const Place& place, bool judged) {
    const Eigen::Vector3d offset = planner.offset(place.tool);
    poses << judged << " " << place.tool << " " << offset[0] << " " << offset[1] << " " << offset[2];
    for (const double value : hidden.world_of(place.commands, offset)) poses << " " << value;
    poses << "\n";
  };
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (k > 0 && places[k].tool != places[k - 1].tool) write({home, 0}, false);
    write(places[k], true);
  }
  // With G43 the program is that of the tool's point.
  std::ofstream program = file("program.ngc"), start = file("start.ngc");
  program << "G21 G90 G94 G64 P0.001 T1 M6 G43\nF12000\n";
  const std::vector<Place> curve = choose_program(job, planner, places.back(), generator);
  for (std::size_t k = 0; k < curve.size(); ++k) {
    const std::vector<double> world = hidden.world_of(curve[k].commands, t);
    std::ostringstream place;
    place.precision(14);
    for (std::size_t j = 0; j < world.size(); ++j) {
      const char word = hidden.wiring.words[j];
      place << " " << word << world[j] - (word >= 'X' ? t[word - 'X'] : 0);
    }
    program << "G1" << place.str() << "\n";
    if (k == 0) start << "G0" << place.str() << "\n";
  }
  program << "M2\n";
}

/// What the errors of the identified model, by their stated uncertainty, leave of the tool error.
struct Left {
  Mean before, after;
  double square = 0, expected = 0;  // sums, mm^2
  void add(double error_before, double error_after, const Eigen::Matrix3d& covariance) {
    before.add(error_before);
    after.add(error_after);
    square += error_after * error_after;
    expected += covariance.trace();
  }
  /// Root mean square of what is left, of the one that the stated uncertainty predicts.
  double ratio() const { return std::sqrt(square / expected); }
};

/// Rows: tool offset (3), world, joints, corrections, uncertainty in um, status, part enabled.
void judge_poses(const Job& job) {
  const HiddenMachine& hidden = job.hidden;
  const std::size_t n = hidden.count();
  const std::vector<std::vector<double>> reached = rows(job.folder + "/reached.txt", 6 + 3 * n);
  if (reached.size() != job.poses)
    fail("LinuxCNC reached " + std::to_string(reached.size()) + " poses, not " + std::to_string(job.poses));
  const double lattice = rows(job.folder + "/lattice.txt", 1).at(0)[0];
  Mean difference, turned, correction, uncertainty;
  Left left;
  for (const std::vector<double>& row : reached) {
    const double *world = row.data() + 3, *joints = world + n, *corrections = joints + n, *others = corrections + n;
    const Library library(hidden, {row[0], row[1], row[2]});
    const std::vector<double> nominal = library.nominal(world);
    if (nominal.empty()) fail("a pose of the test cannot be reached");
    CorrectionStatus status = CorrectionStatus::not_run;
    const std::vector<double> expected = library.compensated(nominal, status);
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t i = hidden.axis_of_joint[j];
      (hidden.is_rotary(j) ? turned : difference).add(std::abs(joints[j] * hidden.unit(j) - expected[i]));
      correction.add(std::abs(corrections[j] * hidden.unit(j) - (expected[i] - nominal[i])));
    }
    const int wanted_status = status == CorrectionStatus::reached ? ABBE_OK : ABBE_ORIENTATION_LEFT;
    if (others[1] != wanted_status) fail("the status is " + std::to_string(others[1]));
    const Eigen::Matrix3d covariance = library.point_covariance(nominal);
    left.add(library.error(hidden.truth, nominal, nominal),
             library.error(hidden.truth, hidden.commands_of(joints), nominal), covariance);
    if (job.stated) {
      const double full = std::sqrt(covariance.selfadjointView<Eigen::Lower>().eigenvalues()[2]);
      uncertainty.add(std::abs(others[0] - 1e3 * full));
    } else if (others[0] != -1) {
      fail("an uncertainty is shown that the file does not have");
    }
  }
  std::printf(
      "%s: %zu poses: joints differ from the library's by %.1e mm and %.1e rad at most, correction pins by %.1e\n",
      hidden.machine.chain().c_str(), reached.size(), difference.largest, turned.largest, correction.largest);
  std::printf(
      "tool error on the true machine: mean %.1f um, largest %.1f um; compensated: mean %.2f um, largest %.2f um, rms "
      "%.2f of what the stated uncertainty predicts\n",
      1e3 * left.before.mean(), 1e3 * left.before.largest, 1e3 * left.after.mean(), 1e3 * left.after.largest,
      left.ratio());
  if (!(difference.largest < 1e-9 && turned.largest < 1e-10)) fail("joints differ");
  if (!(correction.largest < 1e-9)) fail("the correction pins are wrong");
  if (!(left.before.mean() > 0.05)) fail("the machine has no errors worth the test");
  if (!(left.after.mean() < left.before.mean() / 20))
    fail("the tool error does not fall as far as the errors are known");
  if (!(left.ratio() < 1.5 && left.ratio() > 0.5)) fail("what is left is not as uncertain as stated");
  if (!job.stated) return;
  std::printf("uncertainty pin: %.2f um at most off the full model, %.2f stated\n", uncertainty.largest, 1e3 * lattice);
  // What is stated is the largest difference at other poses.
  if (!(uncertainty.largest < 1.5e3 * lattice)) fail("the uncertainty pin is wrong");
}

/// Samples of every servo cycle of the program: joints, world coordinates. Joints follow the world some cycles later,
/// so what counts is how far the tool is from the path.
void judge_program(const Job& job) {
  const HiddenMachine& hidden = job.hidden;
  const std::size_t n = hidden.count();
  const std::vector<std::vector<double>> samples = rows(job.folder + "/program.txt", 2 * n);
  if (samples.size() < 200) fail("too few samples of the program");
  const Library library(hidden, hidden.tool_offset);
  std::vector<Eigen::Vector3d> path;
  Mean before, after;
  double length = 0;
  constexpr std::size_t kLag = 6;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const std::vector<double> nominal = library.nominal(samples[k].data() + n);
    if (nominal.empty()) fail("a pose of the program cannot be reached");
    path.push_back(nominal_workpiece_from_tool(library.machine(), nominal).translation);
    if (k > 0) length += (path[k] - path[k - 1]).norm();
    if (k < kLag) continue;
    const std::vector<double> joints = hidden.commands_of(samples[k].data());
    const Eigen::Vector3d tool = actual_workpiece_from_tool(library.machine(), hidden.truth, joints).translation;
    double nearest = 1e9;
    for (std::size_t i = k - kLag; i < k; ++i)
      nearest = std::min(nearest, distance_to_segment(tool, path[i], path[i + 1]));
    after.add(nearest);
    before.add(library.error(hidden.truth, nominal, nominal));
  }
  std::printf(
      "program, %zu cycles, %.0f mm: tool error mean %.1f um; compensated, from the path: mean %.2f, largest %.2f um\n",
      samples.size(), length, 1e3 * before.mean(), 1e3 * after.mean(), 1e3 * after.largest);
  if (!(length > 50)) fail("the program is too short");
  if (!(after.mean() < before.mean() / 20)) fail("the program is not compensated");
}

std::vector<std::string> split(const std::string& text) {
  std::istringstream words(text);
  std::vector<std::string> all;
  for (std::string word; std::getline(words, word, ',');) all.push_back(word);
  return all;
}

}  // namespace
}  // namespace abbe

int main(int argc, char** argv) {
  if (argc != 9) return 2;
  const std::string what = argv[1], space = argv[6], stated = argv[8];
  const abbe::Wiring wiring{argv[3], abbe::split(argv[4]), argv[5], space == "tool"};
  const abbe::Job job{abbe::HiddenMachine(wiring), argv[2], std::stoul(argv[7]), stated == "stated"};
  if (what == "prepare") abbe::prepare(job);
  if (what == "judge") {
    abbe::judge_poses(job);
    abbe::judge_program(job);
  }
  return 0;
}
