#pragma once

// Touches of a ball at several positions of the rotary axes, as a program for LinuxCNC: `abbe program --probe-ball-mm`:
//
//   #include <abbe/formats/machine/machine_file.h>
//   #include <abbe/study/planning/planned_probing.h>
//
//   #include <cstdio>
//
//   int main() {
//     abbe::ProbingRequest request;
//     request.machine = abbe::read_machine("examples/machines/trunnion-mill.machine.toml");
//     request.readings_file = "examples/measuring_program/poses.csv";
//     request.list = abbe::read_reading_list(request.readings_file, request.machine);
//     request.ball_centre = {80, 0, 60};  // mm, workpiece frame
//     request.ball_radius = 12.5;
//     request.ways.clearance = 150;
//     const abbe::PlannedProbing planned = abbe::plan_probing(request);
//     if (!planned.refused.empty()) return 1;
//     std::printf("%zu touches at %zu positions\n", planned.touches.size(), planned.positions);
//     return 0;  // planned.program is the text of the program
//   }
//
// It prints:
//
//   60 touches at 12 positions
//
// Moves and their checks: docs/measuring-programs.md.

#include <Eigen/Core>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/formats/nc/probing_program.h"
#include "abbe/formats/readings/planned_touches.h"
#include "abbe/formats/readings/reading_list.h"
#include "abbe/machine/machine.h"
#include "abbe/plan/ways/clear_ways.h"
#include "abbe/plan/ways/obstacle.h"
#include "abbe/study/planning/planned_measurement.h"

namespace abbe {

/// A ball on the table that is to be touched; lengths in mm. Messages name a field by the option of `abbe program`.
struct ProbingRequest {
  Machine machine;   ///< nominal; its functional point is the centre of the stylus tip
  ReadingList list;  ///< positions of the rotary axes; linear axes go where the ball then is
  std::string readings_file;

  Eigen::Vector3d ball_centre = Eigen::Vector3d::Zero();  ///< --probe-ball-mm, workpiece frame
  double ball_radius = 0;
  double tip_radius = 3;    ///< --tip-radius-mm
  std::size_t touches = 5;  ///< --touches-per-ball: along the tool, and the others around it in equal steps; at least 4
  double before = 3;        ///< --pre-touch-mm: between the tip and the ball where a touch begins
  double beyond = 2;        ///< --over-travel-mm: how far behind the ball's surface the control gives up

  std::vector<Obstacle> obstacles;  ///< besides the ball
  /// Stylus and what is behind it; the radius is at least that of the tip.
  ToolShape tool;
  WayOptions ways;

  ProbingProgramOptions program;
};

/// A request with the machine, readings, obstacles, tool, ways, words, decimals, feed and dwell of a measurement.
/// @throws InputError for another dialect than linuxcnc
ProbingRequest probing_request(const MeasurementRequest& measurement);

/// The program and its touches, or the reason why there is none.
struct PlannedProbing {
  Machine machine;
  std::string readings_file;
  std::vector<PlannedTouch> touches;  ///< in the order of the program
  std::size_t positions = 0;          ///< of the ball
  std::size_t ways_around = 0;        ///< between them
  std::string program;                ///< empty if refused
  std::string refused;                ///< which reading, and why
};

/// Where the linear axes have to stand, ways between the balls, touches and the program. At each position of the rotary
/// axes the tip comes from the spindle's side, touches along the tool's line, and from the sides; between two touches
/// it goes over the ball. Every move but the touches is clear of the ball and of the obstacles, every touch of the
/// latter (ClearWays). Opens no file and prints nothing.
/// @throws InputError for fewer than four touches, lengths that are not finite and above zero, and as probing_program()
PlannedProbing plan_probing(const ProbingRequest& request);

/// For people; complete lines.
std::string planned_probing_text(const PlannedProbing& planned);

/// For programs, "abbe-probing-program/1".
nlohmann::ordered_json planned_probing_json(const PlannedProbing& planned);

}  // namespace abbe
