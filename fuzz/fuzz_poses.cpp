// Files of poses of a fixed machine, traces of programs, planned poses of a tracker and of a ball bar, lists of
// readings, and touches with their log: any bytes give poses that fit what they name, or an InputError.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "abbe/formats/evaluations/trace_file.h"
#include "abbe/formats/readings/planned_poses.h"
#include "abbe/formats/readings/planned_touches.h"
#include "abbe/formats/readings/reading_list.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/instruments/trackers/laser_tracker.h"
#include "fuzz_machine_data.h"

namespace {

bool fits(const abbe::PoseList& poses, const abbe::Machine& machine) {
  for (const std::vector<double>& values : poses.axis) {
    if (values.size() != poses.count()) return false;
    if (!std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); })) return false;
  }
  return poses.axis.size() == machine.axes.size() && poses.count() > 0;
}

bool below(const std::vector<std::size_t>& indices, std::size_t count) {
  return std::all_of(indices.begin(), indices.end(), [count](std::size_t index) { return index < count; });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const abbe::Machine machine = fuzz_machine();
  static const abbe::Study study = abbe::parse_study(
      "name = \"s\"\nmachine = \"m.toml\"\n[simulate]\n[simulate.generator]\nseed = 1\nmean_volumetric_um = 40\n"
      "[[setup]]\nname = \"bar\"\ninstrument = \"ball-bar\"\nspindle_ball_mm = [0, 0, -150]\n"
      "noise = { length_um = 1 }\n[[setup.ball]]\nname = \"B1\"\ncentre_mm = [0, 0, 0]\n[[setup.ball]]\nname = \"B2\"\n"
      "centre_mm = [70, 0, 0]\n[[setup.plan]]\nkind = \"random\"\npoints = 4\naxis.X = {}\n[identify]\nlocations = "
      "[\"EX0C\"]\n",
      "no-folder/s.study.toml", machine);
  abbe::TrackerSetup stations;
  stations.stations.resize(2);
  stations.stations[0].name = "S1";
  stations.stations[1].name = "S2";
  stations.reflectors.resize(2);
  stations.reflectors[0].name = "R1";
  stations.reflectors[1].name = "R2";
  abbe::Setup tracker;
  tracker.name = "tracker";
  tracker.device = std::make_shared<abbe::LaserTracker>("tracker", stations, abbe::TrackerMeasure::cartesian);

  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const abbe::TraceFile trace = abbe::parse_trace(text, "trace.csv", machine);
    const bool timed = trace.time_s.empty() || trace.time_s.size() == trace.commands.count();
    if (!fits(trace.commands, machine) || trace.commands.count() < 2 || !timed ||
        !std::is_sorted(trace.time_s.begin(), trace.time_s.end())) {
      std::abort();
    }
  } catch (const abbe::InputError&) {
  }
  for (const abbe::Setup* const setup : {&study.setups[0], static_cast<const abbe::Setup*>(&tracker)}) {
    try {
      const abbe::PlannedPoses planned = abbe::parse_planned_poses(text, "poses.csv", machine, *setup);
      const std::size_t count = planned.poses.count();
      if (!fits(planned.poses, machine) || planned.station.size() != (setup == &tracker ? count : 0) ||
          !(planned.target.empty() || planned.target.size() == count) || !below(planned.station, 2) ||
          !below(planned.target, 2)) {
        std::abort();
      }
    } catch (const abbe::InputError&) {
    }
  }
  try {
    const abbe::ReadingList list = abbe::parse_reading_list(text, "readings.csv", machine);
    if (list.readings.empty()) std::abort();
    for (const abbe::ListedReading& reading : list.readings) {
      if (reading.pose.size() != machine.axes.size() || reading.line == 0) std::abort();
    }
  } catch (const abbe::InputError&) {
  }
  std::vector<abbe::PlannedTouch> touches(1);
  touches[0].pose.assign(machine.axes.size(), 0.0);
  try {
    touches = abbe::parse_planned_touches(text, "touches.csv", machine);
  } catch (const abbe::InputError&) {
  }
  try {
    if (abbe::probed_touches_csv(machine, touches, "touches.csv", text, "log.txt").empty()) std::abort();
  } catch (const abbe::InputError&) {
  }
  return 0;
}
