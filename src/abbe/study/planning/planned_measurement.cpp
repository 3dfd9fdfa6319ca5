#include "abbe/study/planning/planned_measurement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "abbe/errors/poses.h"
#include "abbe/formats/files/file_name.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/machine/position_words.h"
#include "abbe/report/version.h"

namespace abbe {
namespace {

constexpr double kTravelRounding = 1e-9;  // mm, rad

void check_within_travel(const Axis& axis, double position, const std::string& option) {
  if (axis.endless) return;
  if (position >= axis.travel_min - kTravelRounding && position <= axis.travel_max + kTravelRounding) return;
  const double unit = position_unit(axis);
  throw InputError(
      {.field = option},
      fmt::format("{:.9g} {} is outside the travel of axis {}", position / unit, position_suffix(axis), axis.name),
      fmt::format("{:.9g} to {:.9g} {}", axis.travel_min / unit, axis.travel_max / unit, position_suffix(axis)));
}

/// Where the machine stands before the program, if that is said.
std::optional<std::vector<double>> start_pose(const MeasurementRequest& request) {
  if (request.start.empty()) return std::nullopt;
  std::vector<double> pose(request.machine.axes.size(), std::numeric_limits<double>::quiet_NaN());
  for (const HeldAxis& at : request.start) {
    check_within_travel(request.machine.axes.at(at.axis), at.position, "--start");
    pose[at.axis] = at.position;
  }
  for (std::size_t i = 0; i < pose.size(); ++i) {
    if (!std::isnan(pose[i])) continue;
    const Axis& axis = request.machine.axes[i];
    throw InputError({.field = "--start"}, "does not say where axis " + axis.name + " stands",
                     fmt::format("a position of every axis, also {}_{}=...", axis.name, position_suffix(axis)));
  }
  return pose;
}

void check_obstacles(const MeasurementRequest& request) {
  for (const Obstacle& obstacle : request.obstacles) {
    if (obstacle.mesh.size() == 0) {
      throw InputError({.file = obstacle.name}, "has no triangle", "a mesh of what stands in the way");
    }
    if (obstacle.carrier == ObstacleCarrier::axis && obstacle.axis >= request.machine.axes.size()) {
      throw InputError({.field = "--obstacle-mesh"}, "the machine has no such axis", request.machine.chain());
    }
  }
  for (const auto& [axis, position] : request.ways.clear_at) {
    check_within_travel(request.machine.axes.at(axis), position, "--clear-at");
  }
  const NcDialect dialect = request.program.dialect;
  if (!request.obstacles.empty() && !(request.program.feed > 0) &&
      (dialect == NcDialect::iso || dialect == NcDialect::fanuc)) {
    throw InputError({.field = "--feed-mm-per-min"},
                     fmt::format("G0 of the dialect {} need not be a straight line in the axes, so that ways cannot be "
                                 "checked against obstacles",
                                 nc_dialect_names()[static_cast<std::size_t>(dialect)]),
                     "a feed, with which all moves are G1");
  }
}

std::string section_words(const std::string& setup, const std::string& station) {
  if (setup.empty() && station.empty()) return "measurement";
  if (setup.empty()) return "station " + station;
  return station.empty() ? "set-up " + setup : fmt::format("set-up {}, station {}", setup, station);
}

/// Indices of readings, section by section.
std::vector<std::vector<std::size_t>> sections_of(const MeasurementRequest& request, PlannedMeasurement& planned) {
  std::vector<std::vector<std::size_t>> members;
  std::map<std::pair<std::string, std::string>, std::size_t> known;
  for (std::size_t k = 0; k < request.list.readings.size(); ++k) {
    const ListedReading& reading = request.list.readings[k];
    const bool by_setup = request.sections != MeasurementSections::none;
    const bool by_station = request.sections == MeasurementSections::stations;
    const std::pair key(by_setup ? reading.setup : std::string(), by_station ? reading.station : std::string());
    const auto [place, is_new] = known.emplace(key, members.size());
    if (is_new) {
      members.emplace_back();
      planned.sections.push_back({key.first, key.second, section_words(key.first, key.second)});
    }
    members[place->second].push_back(k);
  }
  return members;
}

/// The same readings in an order of short travel; those of one pose stay together and in their order.
std::vector<std::size_t> in_short_order(const Machine& machine, const std::vector<ListedReading>& readings,
                                        const std::vector<std::size_t>& members) {
  std::map<std::vector<double>, std::vector<std::size_t>> at;
  PoseList poses;
  for (const std::size_t k : members) {
    std::vector<std::size_t>& here = at[readings[k].pose];
    if (here.empty()) poses.append(readings[k].pose);
    here.push_back(k);
  }
  const PoseList ordered = order_by_travel(machine, poses);
  std::vector<std::size_t> result;
  for (std::size_t k = 0; k < ordered.count(); ++k) {
    const std::vector<std::size_t>& here = at[ordered.pose(k)];
    result.insert(result.end(), here.begin(), here.end());
  }
  return result;
}

double way_time(const MeasurementRequest& request, const std::vector<double>& from, const std::vector<double>& to) {
  double time = 0, squared = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const double motion = std::abs(to[i] - from[i]);
    const bool is_linear = request.machine.axes[i].kind == AxisKind::linear;
    time = std::max(time, motion / (is_linear ? request.linear_speed : request.rotary_speed));
    if (is_linear) squared += motion * motion;
  }
  return request.program.feed > 0 ? std::max(time, std::sqrt(squared) / request.program.feed) : time;
}

std::string reading_comment(const PlannedReading& reading, const std::string& what) {
  std::string words = fmt::format("reading {}", reading.number);
  if (!reading.listed.point.empty()) words += ", point " + reading.listed.point;
  if (!reading.listed.station.empty()) words += ", station " + reading.listed.station;
  if (!reading.listed.what.empty()) words += ", " + what + " " + reading.listed.what;
  return words;
}

/// Finds the ways between the readings, one after the other.
class MeasurementWays {
 public:
  MeasurementWays(const MeasurementRequest& request, int decimals, PlannedMeasurement& planned)
      : request_(request),
        decimals_(decimals),
        planned_(planned),
        ways_(planned.machine, request.obstacles, request.tool, request.ways) {}

  /// @param at  where the machine stands; empty: not known
  /// @returns false if there is no way to one of them, which is then told
  bool find(std::optional<std::vector<double>> at) {
    std::string from = "the start";
    const MeasuringProgramOptions& program = request_.program;
    const double standing =
        program.dwell + program.reading + (program.trigger == NcTrigger::output ? program.pulse : 0);
    for (PlannedReading& reading : planned_.readings) {
      if (!at || *at != reading.pose) {
        if (!request_.obstacles.empty() && !reaches(at, from, reading)) return false;
        time_ += at ? time_of(*at, reading) : 0;
      }
      time_ += standing;
      reading.finished = time_;
      at = reading.pose;
      from = words(reading);
    }
    planned_.time = time_;
    return true;
  }

 private:
  static std::string words(const PlannedReading& reading) { return reading_words(reading.number, reading.listed); }

  bool reaches(const std::optional<std::vector<double>>& at, const std::string& from, PlannedReading& reading) {
    const auto touched = [&](const WayCollision& collision) {
      return fmt::format("touches {} at {}", planned_.obstacles[collision.obstacle],
                         position_words(planned_.machine, collision.pose, "{:.3f}"));
    };
    if (const std::optional<WayCollision> here = ways_.standing(reading.pose)) {
      planned_.refused = fmt::format("{}: at {} the tool {}", planned_.readings_file, words(reading), touched(*here));
      return false;
    }
    if (!at) return true;
    Way way = ways_.find(*at, reading.pose);
    // The program states poses on the way with as many digits as all others; that way counts.
    std::vector<double> before = *at;
    for (std::vector<double>& pose : way.via) {
      pose = stated_pose(planned_.machine, pose, decimals_);
      way.is_clear = way.is_clear && !ways_.straight(before, pose);
      before = pose;
    }
    if (!way.via.empty()) way.is_clear = way.is_clear && !ways_.straight(before, reading.pose);
    if (way.is_clear) {
      reading.via = std::move(way.via);
      return true;
    }
    const bool may_retract = request_.ways.clearance > 0 || !request_.ways.clear_at.empty();
    planned_.refused = fmt::format(
        "{}: on the straight way from {} to {} the tool {}, and {}", planned_.readings_file, from, words(reading),
        touched(*way.collision),
        may_retract ? "no way with it retracted is clear either" : "neither --clearance-mm nor --clear-at is given");
    return false;
  }

  double time_of(std::vector<double> from, const PlannedReading& reading) const {
    double time = 0;
    for (const std::vector<double>& pose : reading.via) {
      time += way_time(request_, from, pose);
      from = pose;
    }
    return time + way_time(request_, from, reading.pose);
  }

  const MeasurementRequest& request_;
  int decimals_;
  PlannedMeasurement& planned_;
  ClearWays ways_;
  double time_ = 0;
};

void add_notes(const MeasurementRequest& request, PlannedMeasurement& planned) {
  const MeasuringProgramOptions& program = request.program;
  if (!program.machine_coordinates) {
    planned.notes.emplace_back(
        "positions are those of the machine file: the zero offset in force must be its zero, without tool length");
  }
  if (!request.obstacles.empty() && request.start.empty()) {
    planned.notes.emplace_back("the way to the first reading is not checked (--start says where it begins)");
  }
  if (request.list.has_approach) {
    planned.notes.emplace_back(
        "the file says from which side axes came; the program does not repeat that, so readings of lost motion differ");
  }
}

std::vector<MeasuringSection> program_sections(const PlannedMeasurement& planned) {
  std::vector<MeasuringSection> sections;
  for (const PlannedSection& section : planned.sections) {
    MeasuringSection& written = sections.emplace_back();
    written.words = section.words;
    for (std::size_t k = section.first; k < section.first + section.count; ++k) {
      const PlannedReading& reading = planned.readings[k];
      written.stops.push_back({reading.via, reading.pose, reading_comment(reading, planned.what)});
    }
  }
  return sections;
}

}  // namespace

const std::vector<std::string>& measurement_section_names() {
  static const std::vector<std::string> names = {"stations", "setups", "none"};
  return names;
}

std::optional<MeasurementSections> measurement_sections(const std::string& name) {
  const std::vector<std::string>& names = measurement_section_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<MeasurementSections>(found - names.begin());
}

std::size_t PlannedMeasurement::ways_around() const {
  return static_cast<std::size_t>(
      std::count_if(readings.begin(), readings.end(), [](const PlannedReading& r) { return !r.via.empty(); }));
}

PlannedMeasurement plan_measurement(const MeasurementRequest& request) {
  if (request.list.readings.empty()) {
    throw InputError({.file = request.readings_file}, "has no reading", "at least one");
  }
  check_obstacles(request);
  // What the control cannot do is told before anything is computed.
  static_cast<void>(measuring_program(request.machine, {}, request.program));
  const std::optional<std::vector<double>> start = start_pose(request);
  const int decimals = request.program.decimals.value_or(default_decimals(request.program.dialect));
  PlannedMeasurement planned;
  planned.machine = request.machine;
  planned.readings_file = request.readings_file;
  planned.what = request.list.what;
  planned.dialect = nc_dialect_names()[static_cast<std::size_t>(request.program.dialect)];
  for (const Obstacle& obstacle : request.obstacles) planned.obstacles.push_back(obstacle.name);
  const std::vector<std::vector<std::size_t>> members = sections_of(request, planned);
  for (std::size_t s = 0; s < members.size(); ++s) {
    planned.sections[s].first = planned.readings.size();
    planned.sections[s].count = members[s].size();
    const std::vector<std::size_t> order =
        request.shorten ? in_short_order(request.machine, request.list.readings, members[s]) : members[s];
    for (const std::size_t k : order) {
      const ListedReading& listed = request.list.readings[k];
      planned.readings.push_back({k + 1, listed, stated_pose(request.machine, listed.pose, decimals), {}, 0});
    }
  }
  add_notes(request, planned);
  if (!MeasurementWays(request, decimals, planned).find(start)) return planned;

  MeasuringProgramOptions options = request.program;
  options.comments.insert(options.comments.begin(),
                          {fmt::format("{} readings of {} on {}", planned.readings.size(),
                                       file_name(planned.readings_file), planned.machine.name),
                           fmt::format("abbe {}, chain {}", version_text(), planned.machine.chain())});
  options.comments.insert(options.comments.end(), planned.notes.begin(), planned.notes.end());
  planned.program = measuring_program(planned.machine, program_sections(planned), options);
  return planned;
}

}  // namespace abbe
