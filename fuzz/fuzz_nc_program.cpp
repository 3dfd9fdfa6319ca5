// NC programs: any bytes give moves or an InputError, in bounded time; what is written is read again and goes to the
// same places. Parameter files and tool tables beside them.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/compensate/program/machine_planes.h"
#include "abbe/formats/nc/nc_program.h"
#include "abbe/formats/text/input_error.h"

namespace {

/// Every move becomes a straight line to its end.
class StraightMoves final : public abbe::MoveCorrector {
 public:
  void correct(std::span<const abbe::ProgramMove> moves, abbe::CorrectedPieces& corrected) override {
    corrected.pieces.clear();
    corrected.first.assign(1, 0);
    for (const abbe::ProgramMove& move : moves) {
      if (move.kind != abbe::MoveKind::rapid && !(move.feed > 0)) std::abort();
      for (const double value : move.end) {
        if (!std::isfinite(value)) std::abort();
      }
      ends.push_back(move.end);
      // After G33.1 the control is where it began.
      stands.push_back(move.spindle == abbe::SpindleMove::rigid_tapping ? move.start : move.end);
      // A feed that no program can say is the corrector's to refuse.
      const double feed = std::clamp(move.feed, 1e-3, 1e6);
      corrected.pieces.push_back({move.end, feed, move.feed_mode});
      corrected.first.push_back(corrected.pieces.size());
    }
  }
  std::vector<abbe::WordValues> ends, stands;
};

bool is_near(const abbe::WordValues& a, const abbe::WordValues& b) {
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (std::abs(a[k] - b[k]) > 3e-6 + 1e-9 * std::abs(a[k])) return false;
  }
  return true;
}

struct Run {
  std::vector<abbe::WordValues> ends, stands;
  std::string text;
  std::size_t uncorrected = 0;
};

Run run(std::string_view text, const abbe::NcProgramOptions& options) {
  StraightMoves corrector;
  Run result;
  result.uncorrected = abbe::correct_nc_program(text, "fuzz.ngc", options, corrector, [&](std::string_view part) {
                         result.text += part;
                       }).uncorrected_moves;
  result.ends = std::move(corrector.ends);
  result.stands = std::move(corrector.stands);
  return result;
}

/// A table that tilts and turns, for tilted planes.
const abbe::MachinePlanes& planes() {
  static const abbe::MachinePlanes made = [] {
    abbe::Machine machine;
    machine.name = "trunnion";
    for (const char* name : {"C", "A", "X", "Y", "Z"}) {
      abbe::Axis& axis = machine.axes.emplace_back();
      axis.name = name;
      abbe::axis_kind_from_letter(name[0], axis.kind);
      axis.side = machine.axes.size() <= 2 ? abbe::ChainSide::workpiece : abbe::ChainSide::tool;
      axis.primed = machine.axes.size() <= 2;
      axis.direction = abbe::direction_from_letter(name[0]);
      axis.point = {1, -2, 3};
      axis.travel_min = axis.kind == abbe::AxisKind::rotary ? -2 : -500;
      axis.travel_max = -axis.travel_min;
    }
    machine.axes[0].endless = true;
    return abbe::MachinePlanes(machine, abbe::word_axes_by_name(machine));
  }();
  return made;
}

void check_again(const Run& first, const abbe::NcProgramOptions& options) {
  const Run second = run(first.text, options);
  // Moves that go nowhere are not written.
  std::size_t at = 0;
  abbe::WordValues stands{};
  bool known = false;
  for (std::size_t i = 0; i < first.ends.size(); ++i) {
    const abbe::WordValues& end = first.ends[i];
    if (at < second.ends.size() && is_near(second.ends[at], end)) {
      ++at;
    } else if (!known || !is_near(stands, end)) {
      std::abort();
    }
    stands = first.stands[i];
    known = true;
  }
  if (at != second.ends.size()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const unsigned flags = data[0];
  try {
    if (flags % 16 == 15) {
      abbe::parse_nc_parameters(text, "fuzz.var");
      return 0;
    }
    if (flags % 16 == 14) {
      abbe::parse_nc_tools(text, "fuzz.tbl", flags / 16 % 2 == 1);
      return 0;
    }
    abbe::NcProgramOptions options;
    options.words.fill(true);
    if (flags % 2 == 0) options.start.fill(0);
    options.block_delete = flags / 2 % 2 == 1;
    options.batch = flags / 4 % 2 == 1 ? 3 : 64;
    options.inches = flags / 16 % 2 == 1;
    options.tools = abbe::NcToolTable{{1, {0, 0, 50}}, {2, {1, 2, 30, 0.5}}};
    options.parameters = {{5161, 1}, {5163, 20}, {5181, 0}, {5211, 2}, {5220, 1}, {5241, 10}};
    options.planes = &planes();
    options.tool_centre = flags / 32 % 2 == 1;
    options.most_moves = 3000;
    options.most_idle_rounds = 200;
    const Run first = run(text, options);
    // Where an axis is not known its rapid moves pass as they are, and are not seen here.
    if (first.uncorrected == 0) check_again(first, options);
  } catch (const abbe::InputError&) {
  }
  return 0;
}
