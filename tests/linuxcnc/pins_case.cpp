// What the pins of the kinematics module shall say on the trunnion mill, and the judge of what they said.
//
//   pins_case prepare|judge FOLDER
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "abbe/runtime/abbe_runtime.h"
#include "hidden_machine.h"
#include "judging.h"

namespace abbe {
namespace {

constexpr double kEdge = 300;            // mm; the errors of X are known to here,
constexpr double kHeldFrom = kEdge + 1;  // and from here on they stay as they are: docs/runtime.md
constexpr double kLongestPause = 0.005;  // s; what the module counts of a longer one
constexpr std::size_t kJoints = 5;
constexpr std::size_t kLag = 6;  // cycles by which joints follow

const Eigen::Vector3d kTools[] = {{0, 0, 0}, {0, 0, 150}, {0, 0, 400}, {5, -3, 80}};  // offsets by number, mm

/// A place and what the module shall say there.
struct Place {
  int tool;
  double joints[kJoints];  // X Y Z A C, nominal; mm, degrees
  int status;
};

/// The first one is where the compensation is turned on and off.
const Place kPlaces[] = {
    {0, {100, -80, -200, -30, 60}, ABBE_OK},
    {0, {299.5, 20, -180, -40, 70}, ABBE_OK},
    {0, {302, 20, -180, -40, 70}, ABBE_OUTSIDE_MAP | ABBE_OUTSIDE_TRAVEL},
    {0, {310, 20, -180, -40, 70}, ABBE_OUTSIDE_MAP | ABBE_OUTSIDE_TRAVEL},
    {0, {340, 20, -180, -40, 70}, ABBE_OUTSIDE_MAP | ABBE_OUTSIDE_TRAVEL},
    {0, {250, 20, -180, -40, 70}, ABBE_OK},
    {1, {50, 60, -120, -20, -45}, ABBE_OK},
    {2, {50, 60, -120, -20, -45}, ABBE_OUTSIDE_TOOL},
    {3, {50, 60, -120, -20, -45}, ABBE_OK},
    {0, {50, 60, -120, -20, -45}, ABBE_OK},
    {0, {-40, 30, -150, 0, 25}, ABBE_TURN_LIMITED},
    {0, {-40, 30, -150, -60, 25}, ABBE_OK},
};
constexpr std::size_t kPlaceCount = std::size(kPlaces);

/// Columns of a row: tool offset, world, joints, corrections, then single pins.
enum Column : std::size_t {
  kWorld = 3,
  kJoint = kWorld + kJoints,
  kCorrection = kJoint + kJoints,
  kUncertainty = kCorrection + kJoints,
  kStatus,
  kEnabled,
  kOutsideMap,
  kOutsideTool,
  kTurnLimited,
  kLargest,
  kColumns
};

HiddenMachine mill() { return HiddenMachine({"trunnion-mill", {"X", "Y", "Z", "A", "C"}, "XYZAC", true}); }

void prepare(const std::string& folder) {
  const HiddenMachine hidden = mill();
  write_frozen(hidden, folder + "/mill.abbec", true);
  std::ifstream sound(folder + "/mill.abbec", std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(sound), {}};
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 4);
  std::ofstream(folder + "/damaged.abbec", std::ios::binary) << bytes;

  std::ofstream tools(folder + "/tools.tbl"), places(folder + "/places.txt");
  places.precision(14);
  for (int t = 1; t < 4; ++t)
    tools << "T" << t << " P" << t << " X" << kTools[t][0] << " Y" << kTools[t][1] << " Z" << kTools[t][2] << " D6\n";
  for (const Place& place : kPlaces) {
    const Eigen::Vector3d& offset = kTools[place.tool];
    places << place.tool << " " << offset[0] << " " << offset[1] << " " << offset[2];
    for (const double value : hidden.world_of(hidden.commands_of(place.joints), offset)) places << " " << value;
    places << "\n";
  }
}

/// The identified errors, those of X as they are at one of its positions.
ErrorSet with_x_held(const HiddenMachine& hidden, double position) {
  ErrorSet errors = hidden.identified;
  const std::size_t x = hidden.machine.find_axis("X");
  for (ErrorMotion& motion : errors.motions) {
    if (motion.axis != x) continue;
    motion.coefficients = {motion.basis.evaluate(position, motion.coefficients)};
    motion.basis = {BasisKind::monomial, 0, -10000, 10000};
  }
  return errors;
}

struct Free {
  void operator()(abbe_runtime* runtime) const { abbe_runtime_free(runtime); }
};

/// What the file itself says of the uncertainty, um.
class FrozenUncertaintyOf {
 public:
  explicit FrozenUncertaintyOf(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    char text[128];
    abbe_runtime* loaded = nullptr;
    if (abbe_runtime_load(bytes.data(), bytes.size(), text, sizeof text, &loaded) != ABBE_OK) fail(text);
    runtime_.reset(loaded);
  }
  double at(const std::vector<double>& commands, const Eigen::Vector3d& offset) const {
    double tool[3], uncertainty = 0;
    abbe_runtime_tool_of_offset(runtime_.get(), offset.data(), tool);
    if (abbe_runtime_uncertainty(runtime_.get(), commands.data(), tool, &uncertainty) < 0) fail("no uncertainty");
    return 1e3 * uncertainty;
  }

 private:
  std::unique_ptr<abbe_runtime, Free> runtime_;
};

void judge_place(const HiddenMachine& hidden, const Place& place, const std::vector<double>& row) {
  const Eigen::Vector3d offset(row[0], row[1], row[2]);
  if ((offset - kTools[place.tool]).norm() > 1e-12) fail("motion.tooloffset is not that of the tool table");
  const std::string where = "place " + std::to_string(&place - kPlaces) + ": ";
  if (row[kStatus] != place.status) fail(where + "status " + std::to_string(row[kStatus]));
  if (row[kOutsideMap] != ((place.status & ABBE_OUTSIDE_MAP) != 0)) fail(where + "outside-map");
  if (row[kOutsideTool] != ((place.status & ABBE_OUTSIDE_TOOL) != 0)) fail(where + "outside-tool");
  const bool limited = (place.status & ABBE_RESULT_MASK) == ABBE_TURN_LIMITED;
  if (row[kTurnLimited] != limited) fail(where + "turn-limited");

  const bool outside = place.joints[0] > kHeldFrom;
  const ErrorSet errors = outside ? with_x_held(hidden, kHeldFrom) : hidden.identified;
  const Library library(hidden, offset, errors);
  const std::vector<double> nominal = library.nominal(row.data() + kWorld);
  const std::vector<double> joints = hidden.commands_of(row.data() + kJoint);
  CorrectionStatus status = CorrectionStatus::not_run;
  std::vector<double> expected = library.compensated(nominal, status);
  // Beyond its travel the library keeps a command; the module leaves that to LinuxCNC's limits.
  if (outside) {
    HiddenMachine longer = hidden;
    longer.machine.axes[hidden.machine.find_axis("X")].travel_max = 1000;
    expected = Library(longer, offset, errors).compensated(nominal, status);
  }
  if (limited) {
    // Which bounded turn is taken is not the library's; that the point is reached and the turn small is.
    if (status != CorrectionStatus::turn_limited) fail(where + "the library bounds no turn there");
    double turn = 0;
    for (std::size_t j = 3; j < kJoints; ++j)
      turn += std::pow(joints[hidden.axis_of_joint[j]] - nominal[hidden.axis_of_joint[j]], 2);
    if (!(std::sqrt(turn) < 0.01 + 1e-9)) fail(where + "the turn is not bounded");
    if (!(library.error(errors, joints, nominal) < 1e-9)) fail(where + "the point is not reached");
    return;
  }
  if (status != CorrectionStatus::reached) fail(where + correction_status_text(status));
  double difference = 0;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const std::size_t i = hidden.axis_of_joint[j];
    difference = std::max({difference, std::abs(joints[i] - expected[i]),
                           std::abs(row[kCorrection + j] * hidden.unit(j) - (expected[i] - nominal[i]))});
  }
  if (!(difference < 1e-9)) fail(where + "joints or corrections are off by " + std::to_string(difference));
}

/// Rows of the places, before them the first place with the compensation off.
void judge_places(const std::string& folder) {
  const HiddenMachine hidden = mill();
  const std::vector<std::vector<double>> all = rows(folder + "/reached.txt", kColumns);
  if (all.size() != kPlaceCount + 1) fail("LinuxCNC reached " + std::to_string(all.size()) + " places");
  double largest = 0;
  for (std::size_t k = 0; k < kPlaceCount; ++k) {
    const std::vector<double>& row = all[k + 1];
    judge_place(hidden, kPlaces[k], row);
    double here = 0;
    for (std::size_t j = 0; j < 3; ++j) here = std::max(here, std::abs(row[kCorrection + j]));
    // Up to the first place nothing was enabled elsewhere.
    if (k == 0 && std::abs(row[kLargest] - here) > 1e-7)
      fail("largest-correction is not that of the first place: " + std::to_string(1e3 * (row[kLargest] - here)) +
           " um");
    if (row[kLargest] < std::max(largest, here - 1e-9)) fail("largest-correction is too small");
    largest = row[kLargest];
  }
  double held = 0;
  for (std::size_t j = 0; j < 3; ++j)
    held = std::max(held, std::abs(all[5][kCorrection + j] - all[3][kCorrection + j]));
  std::printf("%zu places: joints, corrections and flags are those of the library\n", kPlaceCount);
  std::printf("outside the map: corrections 40 and 2 mm from the edge differ by %.2f um\n", 1e3 * held);

  const FrozenUncertaintyOf frozen(folder + "/mill.abbec");
  const std::vector<double> nominal = hidden.commands_of(kPlaces[0].joints);
  const double of_nominal = frozen.at(nominal, kTools[0]);
  const double of_joints = frozen.at(hidden.commands_of(all[1].data() + kJoint), kTools[0]);
  const double off = std::abs(all[0][kUncertainty] - of_nominal), on = std::abs(all[1][kUncertainty] - of_nominal);
  std::printf(
      "uncertainty pin: %.1e um (off) and %.1e um (on) from that of nominal joints, which differs by %.1e um "
      "from that of compensated ones\n",
      off, on, std::abs(of_joints - of_nominal));
  if (!(std::abs(of_joints - of_nominal) > 1e-6)) fail("the test does not tell nominal joints from compensated ones");
  if (!(off < 1e-8 && on < 1e-8)) fail("the uncertainty is not that of nominal joints");
}

/// Samples of every servo cycle at the first place: joints, part enabled, corrections.
void judge_ramp(const std::string& folder, const std::string& name, double seconds, double taken) {
  const std::vector<std::vector<double>> samples = rows(folder + "/" + name, 2 * kJoints + 1);
  const std::vector<double> whole = rows(folder + "/reached.txt", kColumns).at(1);
  const double largest_part = 1.5 * kLongestPause / seconds;  // of a smooth step, s^2 (3 - 2 s)
  double part_step = 0, joint_step = 0, moved = 0;
  std::size_t between = 0, further = 0;
  for (std::size_t k = kLag + 1; k < samples.size(); ++k) {
    const double part = samples[k][kJoints];
    if (part > 0 && part < 1) ++between;
    // LinuxCNC's interpolation spreads a step over some cycles that follow.
    double step = 0;
    for (std::size_t i = k - kLag; i <= k; ++i)
      step = std::max(step, std::abs(samples[i][kJoints] - samples[i - 1][kJoints]));
    part_step = std::max(part_step, step);
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double full = std::abs(whole[kCorrection + j]);
      const double moves = std::abs(samples[k][j] - samples[k - 1][j]);
      if (moves > 1.001 * step * full + 1e-9) ++further;
      // If samples were lost in between, a joint may catch up within this one.
      const double within_lag = std::abs(part - samples[k - kLag - 1][kJoints]);
      if (moves > 1.001 * std::max(step, within_lag) * full + 1e-9)
        fail(name + ": joint " + std::to_string(j) + " moves further than the part that is enabled: " +
             std::to_string(moves / full) + " of its correction in a cycle");
      if (std::abs(samples[k][kJoints + 1 + j] - part * whole[kCorrection + j]) > 1e-3 * full)
        fail(name + ": a correction pin is not the part that is enabled");
      if (j >= 3) continue;
      joint_step = std::max(joint_step, moves);
      moved = std::max(moved, std::abs(samples[k][j] - samples[0][j]));
    }
  }
  std::printf("%s, %.1f s: %zu cycles, took %.2f s; joints move %.1f um, at most %.2f um from one cycle to the next\n",
              name.c_str(), seconds, between, taken, 1e3 * moved, 1e3 * joint_step);
  if (further > kJoints * samples.size() / 100)
    fail(name + ": joints often move further in a cycle than the part that is enabled");
  if (!(part_step <= largest_part + 1e-12)) fail(name + ": the part that is enabled jumps");
  if (!(static_cast<double>(between) > 0.5 * seconds / kLongestPause)) fail(name + ": the ramp is too short");
  if (!(taken > 0.99 * seconds)) fail(name + ": the ramp is quicker than ramp-seconds");
  if (!(moved > 0.01)) fail(name + ": nothing moves");
}

/// Samples of every servo cycle of a slow move over the edge of the map: world X, corrections.
void judge_edge(const std::string& folder) {
  const std::vector<std::vector<double>> samples = rows(folder + "/edge.txt", 1 + kJoints);
  double inside[kJoints] = {}, outside[kJoints] = {}, furthest = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    furthest = std::max(furthest, samples[k][0]);
    for (std::size_t j = 0; j < kJoints; ++j) {
      double& step = (samples[k][0] < kEdge - 1 ? inside : outside)[j];
      step = std::max(step, std::abs(samples[k][1 + j] - samples[k - 1][1 + j]));
    }
  }
  const double of_inside = *std::max_element(inside, inside + 3), of_outside = *std::max_element(outside, outside + 3);
  std::printf(
      "over the edge of the map, %zu cycles: corrections change by at most %.3f um from one cycle to the next, "
      "%.3f um before it\n",
      samples.size(), 1e3 * of_outside, 1e3 * of_inside);
  if (!(furthest > kEdge + 20) || samples.size() < 200) fail("the move does not cross the edge");
  if (!(of_inside > 0) || !(of_outside < 1.5 * of_inside)) fail("the correction jumps at the edge of the map");
}

void judge(const std::string& folder) {
  judge_places(folder);
  const std::vector<std::vector<double>> ramps = rows(folder + "/ramps.txt", 2);
  if (ramps.size() != 3) fail("three ramps were asked for");
  const char* names[] = {"on.txt", "off.txt", "interrupted.txt"};
  for (std::size_t k = 0; k < 3; ++k) judge_ramp(folder, names[k], ramps[k][0], ramps[k][1]);
  judge_edge(folder);
}

}  // namespace
}  // namespace abbe

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::string what = argv[1];
  if (what == "prepare") abbe::prepare(argv[2]);
  if (what == "judge") abbe::judge(argv[2]);
  return 0;
}
