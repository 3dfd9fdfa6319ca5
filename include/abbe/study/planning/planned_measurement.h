#pragma once

// Readings of a plan as a program of the machine, as `abbe program` writes them:
//
//   #include <abbe/formats/machine/machine_file.h>
//   #include <abbe/study/planning/planned_measurement.h>
//
//   #include <cstdio>
//
//   int main() {
//     abbe::MeasurementRequest request;
//     request.machine = abbe::read_machine("examples/machines/trunnion-mill.machine.toml");
//     request.readings_file = "examples/measuring_program/poses.csv";
//     request.list = abbe::read_reading_list(request.readings_file, request.machine);
//     request.obstacles = {{"box 1", abbe::box_mesh({-60, -60, 0}, {60, 60, 80}), abbe::ObstacleCarrier::table}};
//     request.tool = {5, 150};  // mm
//     request.ways.clearance = 200;
//     request.program.dialect = abbe::NcDialect::linuxcnc;
//     const abbe::PlannedMeasurement planned = abbe::plan_measurement(request);
//     if (!planned.refused.empty()) return 1;
//     std::printf("%zu readings, %zu ways around the box\n", planned.readings.size(), planned.ways_around());
//     return 0;  // planned.program is the text of the program
//   }
//
// It prints:
//
//   12 readings, 2 ways around the box
//
// Dialects, ways and their checks: docs/measuring-programs.md.

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/nc/measuring_program.h"
#include "abbe/formats/readings/reading_list.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/inverse_plan.h"
#include "abbe/machine/machine.h"
#include "abbe/plan/ways/clear_ways.h"
#include "abbe/plan/ways/obstacle.h"

namespace abbe {

/// Where the program stops for the operator.
enum class MeasurementSections {
  stations,  ///< at every set-up and every station of one; their readings are brought together
  setups,    ///< at every set-up
  none       ///< nowhere: all instruments stand there at once
};

/// "stations", "setups", "none", in this order.
const std::vector<std::string>& measurement_section_names();
/// @returns nothing for another name
std::optional<MeasurementSections> measurement_sections(const std::string& name);

/// Readings that a machine is to be driven to; lengths in mm, angles in rad, times in s.
///
/// Messages name a field by the option of `abbe program` that sets it, given below.
struct MeasurementRequest {
  Machine machine;  ///< nominal
  ReadingList list;
  std::string readings_file;  ///< its name, for texts and messages

  MeasurementSections sections = MeasurementSections::stations;  ///< --stop-at
  bool shorten = false;         ///< --shorten: readings of a section in an order of short travel, not that of the file
  std::vector<HeldAxis> start;  ///< --start: where the axes stand before the program; empty: not known

  std::vector<Obstacle> obstacles;  ///< --obstacle-box-mm, --obstacle-mesh
  ToolShape tool;                   ///< --tool-radius-mm, --tool-length-mm
  WayOptions ways;                  ///< --clearance-mm, --clear-at

  /// --dialect and the like; comments are added to those that are there.
  MeasuringProgramOptions program;

  double linear_speed = 100;           ///< --linear-speed-mm-per-s: of rapid moves, for the time
  double rotary_speed = 30 * kDegree;  ///< --rotary-speed-deg-per-s
};

/// A reading in the order of the program.
struct PlannedReading {
  std::size_t number = 0;  ///< row of the file, from 1
  ListedReading listed;
  std::vector<double> pose;              ///< [axes] as the program states it, rounded
  std::vector<std::vector<double>> via;  ///< poses on the way to it
  double finished = 0;                   ///< s from the start of the program, without stops
};

/// Readings that are taken without a stop of the program.
struct PlannedSection {
  std::string setup, station;        ///< empty: the file does not say
  std::string words;                 ///< for the operator
  std::size_t first = 0, count = 0;  ///< in PlannedMeasurement::readings
};

/// A program that takes readings, or the reason why there is none. It holds no reference to the request.
struct PlannedMeasurement {
  Machine machine;
  std::string readings_file, what;       ///< what: the file's word for targets, or empty
  std::vector<PlannedReading> readings;  ///< in the order of the program
  std::vector<PlannedSection> sections;  ///< at least one
  std::vector<std::string> obstacles;    ///< names of those that were checked
  std::vector<std::string> notes;        ///< what the user has to know
  double time = 0;                       ///< s, without stops
  std::string dialect;
  std::string program;  ///< empty if refused
  std::string refused;  ///< why there is no program: the readings and the obstacle; empty: there is one

  /// Number of paths that are not straight.
  std::size_t ways_around() const;
};

/// Readings, ways between them and the program. Opens no file and prints nothing.
/// @throws InputError for an incomplete start, a position outside a travel, an obstacle without triangles or on an axis
///   that does not exist, obstacles beside rapid moves that need not be straight (iso, fanuc), and as
///   measuring_program()
PlannedMeasurement plan_measurement(const MeasurementRequest& request);

/// For people: readings, sections, time, ranges of the axes; complete lines.
std::string planned_measurement_text(const PlannedMeasurement& planned);

/// For programs, "abbe-measuring-program/1"; units in the keys.
nlohmann::ordered_json planned_measurement_json(const PlannedMeasurement& planned);

/// A sheet for the operator: set-ups, readings with the positions of the axes, room for values. One page of HTML for
/// paper of size A4.
std::string planned_measurement_sheet(const PlannedMeasurement& planned);

}  // namespace abbe
