// A mill whose errors depend on a temperature and its lag, for the kinematics module, and the judge of what it did.
//
//   states_case prepare|judge FOLDER
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "abbe/errors/error_states.h"
#include "hidden_machine.h"
#include "judging.h"

namespace abbe {
namespace {

constexpr std::size_t kJoints = 5;
constexpr double kPlace[kJoints] = {100, -80, -200, -30, 60};  // X Y Z A C, nominal; mm, degrees
constexpr double kRate = 0.1;                                  // mm/s, set by states_drive.py
constexpr double kLongestPause = 0.005;                        // s; what the module counts of a longer one
/// A joint moves at most so many times as far as the tool point here, where no pose is singular: by the lever of the
/// turns that correct the direction.
constexpr double kLever = 4;

/// Columns of a sample: joints, corrections, value used of the channel, lag, mm behind.
enum Column : std::size_t { kCorrection = kJoints, kUsed = 2 * kJoints, kLag, kBehind, kEnabled, kColumns };

HiddenMachine warm_mill() {
  HiddenMachine hidden({"trunnion-mill", {"X", "Y", "Z", "A", "C"}, "XYZAC", true});
  hidden.machine.states = {
      {.name = "ambient", .unit = "degC", .reference = 20},
      {.name = "column", .kind = StateKind::lag, .unit = "degC", .reference = 20, .first = 0, .time_constant = 900}};
  const std::size_t z = hidden.machine.find_axis("Z"), c = hidden.machine.find_axis("C");
  const Basis line{.kind = BasisKind::legendre,
                   .order = 1,
                   .from = hidden.machine.axes[z].travel_min,
                   .to = hidden.machine.axes[z].travel_max};
  hidden.identified.motions.push_back({z, Component::Z, line, {0.004, 0.002}, {}, 0});
  hidden.identified.motions.push_back({z, Component::A, line, {4e-6, 1e-6}, {}, 1});
  hidden.identified.locations.push_back({c, Component::Y, 1.5e-3, 0, 0});
  return hidden;
}

void prepare(const std::string& folder) {
  const HiddenMachine hidden = warm_mill();
  write_frozen(hidden, folder + "/mill.abbec", false);
  std::ofstream(folder + "/tools.tbl");
  std::ofstream place(folder + "/place.txt");
  place.precision(14);
  for (const double value : hidden.world_of(hidden.commands_of(kPlace), {0, 0, 0})) place << value << " ";
  place << "\n";
}

void judge(const std::string& folder) {
  const HiddenMachine hidden = warm_mill();
  const std::vector<std::vector<double>> samples = rows(folder + "/samples.txt", kColumns);
  if (samples.size() < 5000) fail("only " + std::to_string(samples.size()) + " servo cycles were recorded");
  const std::vector<double> nominal = hidden.commands_of(kPlace);
  Mean difference;
  double step = 0, coldest = 1e9, warmest = -1e9, moved = 0;
  std::size_t behind = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const std::vector<double>& row = samples[k];
    for (std::size_t j = 0; j < 3; ++j) {
      step = std::max(step, std::abs(row[j] - samples[k - 1][j]));
      moved = std::max(moved, std::abs(row[j] - samples[0][j]));
    }
    if (row[kBehind] > 0) ++behind;
    if (row[kBehind] > 0 || row[kEnabled] < 1 || k % 20 != 0) continue;
    coldest = std::min(coldest, row[kUsed]);
    warmest = std::max(warmest, row[kUsed]);
    const std::vector<double> given{row[kUsed], row[kLag]};
    const ErrorSet errors = at_state(hidden.machine, hidden.identified, given);
    CorrectionStatus status = CorrectionStatus::not_run;
    const std::vector<double> expected = Library(hidden, {0, 0, 0}, errors).compensated(nominal, status);
    if (status != CorrectionStatus::reached) fail(correction_status_text(status));
    for (std::size_t j = 0; j < kJoints; ++j) {
      const std::size_t i = hidden.axis_of_joint[j];
      difference.add(std::abs(row[kCorrection + j] * hidden.unit(j) - (expected[i] - nominal[i])));
    }
  }
  std::printf(
      "%zu cycles: corrections at %zu states from %.1f to %.1f degC differ by %.1e mm or rad from the library\n",
      samples.size(), difference.count / kJoints, coldest, warmest, difference.largest);
  std::printf("joints moved by %.1f um with the states, at most %.3f um in a cycle; %zu cycles behind\n", 1e3 * moved,
              1e3 * step, behind);
  if (difference.count < 100 || !(warmest - coldest > 5)) fail("too few states were seen");
  if (!(difference.largest < 1e-9)) fail("the corrections are not those of the library");
  if (!(moved > 0.02)) fail("nothing moves");
  if (!(step < kLever * kRate * kLongestPause)) fail("a joint jumps");
  if (behind < 100) fail("the rate limits nothing");
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
