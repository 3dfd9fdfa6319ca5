#include "bindings/use/measurement_request.h"

#include <fmt/format.h>
#include <nanobind/stl/filesystem.h>

#include "abbe/formats/files/file_name.h"
#include "abbe/formats/machine/obstacle_option.h"
#include "abbe/study/planning/plan_text.h"
#include "bindings/study/study_objects.h"

namespace abbe::python {
namespace {

constexpr double kLongestLength = 1e5;  // mm

void enter_readings(const ReadingsToTake& argument, const std::optional<std::string>& called,
                    MeasurementRequest& request) {
  const Machine& machine = request.machine;
  if (const std::optional<std::filesystem::path> path = path_of(argument.source)) {
    request.readings_file = called.value_or(path->string());
    request.list = computed([&] { return read_reading_list(*path, machine); });
    return;
  }
  request.readings_file = called.value_or("readings");
  if (nb::isinstance<PlanOutcome>(argument.source)) {
    const PlanOutcome& outcome = initialised(nb::handle_t<PlanOutcome>(argument.source));
    request.list = parse_reading_list(plan_csv(*outcome.study, outcome.plan), request.readings_file, machine);
    return;
  }
  constexpr const char* kName = "readings";
  request.list = listed_readings(Positions(ArrayLike{argument.source}, machine, kName).list(), kName, machine);
}

/// @throws InputError for what carries nothing
Obstacle carried_by(const Machine& machine, const std::string& carrier, const char* name) {
  std::optional<Obstacle> obstacle = obstacle_on(machine, carrier);
  if (obstacle) return *std::move(obstacle);
  throw InputError({.field = name}, fmt::format("'{}' carries no obstacle", carrier.substr(0, 60)),
                   "'base', 'table' or an axis of " + machine.chain());
}

std::vector<Obstacle> obstacles_of(const Machine& machine, const WayArguments& ways) {
  constexpr const char *kBoxes = "obstacle_boxes_mm", *kMeshes = "obstacle_meshes";
  std::vector<Obstacle> obstacles;
  for (const auto& [carrier, corners] : ways.boxes) {
    obstacles.push_back(box_obstacle(carried_by(machine, carrier, kBoxes), corners, obstacles.size() + 1, kBoxes,
                                     "('table', (x0, y0, z0, x1, y1, z1)) in mm"));
  }
  for (const auto& [carrier, argument] : ways.meshes) {
    Obstacle obstacle = carried_by(machine, carrier, kMeshes);
    const NamedMesh mesh = mesh_of(argument, std::nullopt);
    obstacle.name = file_name(mesh.name());
    obstacle.mesh = whole_mesh(mesh, "all faces of the obstacle, because the tool must keep clear of them");
    obstacles.push_back(std::move(obstacle));
  }
  return obstacles;
}

}  // namespace

MeasurementRequest measurement_request(const Machine& machine, const ReadingsToTake& readings,
                                       const std::optional<std::string>& readings_file, const WayArguments& ways,
                                       const NcArguments& program) {
  MeasurementRequest request;
  request.machine = machine;
  request.program.words = program_words(machine, program.words);
  if (program.decimals) {
    request.program.decimals = static_cast<int>(number_within("decimals", *program.decimals, 1, 9));
  }
  request.program.feed = feed_of(program.feed_mm_per_min);
  request.program.dwell = standing_time("dwell_s", program.dwell_s);
  request.tool.radius = number_within("tool_radius_mm", ways.tool_radius_mm, 0, kLongestLength);
  request.tool.length = number_within("tool_length_mm", ways.tool_length_mm, 0, kLongestLength);
  request.ways.clearance = number_within("clearance_mm", ways.clearance_mm, 0, kLongestLength);
  for (const HeldAxis& at : axis_positions(machine, "clear_at", ways.clear_at)) {
    request.ways.clear_at.emplace_back(at.axis, at.position);
  }
  request.obstacles = obstacles_of(machine, ways);
  enter_readings(readings, readings_file, request);
  return request;
}

double standing_time(const char* name, double seconds) { return number_within(name, seconds, 0, 3600); }

const std::string& program_or_refusal(const std::string& program, const std::string& refused) {
  refuse_to_write(argument_words(refused));
  return program;
}

}  // namespace abbe::python
