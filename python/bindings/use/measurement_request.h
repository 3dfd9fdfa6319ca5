#pragma once

// What programs of readings and programs of touches take in the same way.
#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/study/planning/planned_measurement.h"
#include "bindings/shapes/shapes.h"
#include "bindings/use/arguments.h"

namespace abbe::python {

/// A path, a StudyPlan, or positions [n, axes].
struct ReadingsToTake {
  nb::handle source;
};

/// What carries a box, and two opposite corners, mm.
using ObstacleBoxes = std::vector<std::pair<std::string, std::array<double, 6>>>;
/// What carries a mesh, and the mesh.
using ObstacleMeshes = std::vector<std::pair<std::string, MeshArgument>>;

/// What must not be touched, and how the tool gets around it.
struct WayArguments {
  ObstacleBoxes boxes;
  ObstacleMeshes meshes;
  double tool_radius_mm = 0, tool_length_mm = 0, clearance_mm = 0;
  AxisPositions clear_at;
};

/// What a program needs, whatever the control.
struct NcArguments {
  std::map<std::string, std::string> words;
  std::optional<int> decimals;
  std::optional<double> feed_mm_per_min;
  double dwell_s = 2;
};

/// A request with its machine, readings, obstacles and ways, words, decimals, feed and dwell.
/// @param readings_file  name of the readings for texts; else that of the file, or "readings"
/// @throws InputError
MeasurementRequest measurement_request(const Machine& machine, const ReadingsToTake& readings,
                                       const std::optional<std::string>& readings_file, const WayArguments& ways,
                                       const NcArguments& program);

/// A time of standing still. @throws InputError
double standing_time(const char* name, double seconds);

/// The program. @throws InputError with the reason why there is none
const std::string& program_or_refusal(const std::string& program, const std::string& refused);

}  // namespace abbe::python

namespace nanobind::detail {

template <>
struct type_caster<abbe::python::ReadingsToTake> {
  NB_TYPE_CASTER(abbe::python::ReadingsToTake, const_name("str | os.PathLike | StudyPlan | numpy.typing.ArrayLike"))
  bool from_python(handle source, std::uint32_t, cleanup_list*) noexcept {
    value.source = source;
    return !source.is_none();
  }
};

}  // namespace nanobind::detail
