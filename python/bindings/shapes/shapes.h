#pragma once

// Points and meshes as arguments, from files or arrays.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/geometry/rigid_transform.h"
#include "abbe/geometry/surface/closest_point.h"
#include "bindings/evaluate/readings.h"

namespace abbe::python {

/// A mesh with its name, and a search structure for closest points that is built on first use.
class NamedMesh {
 public:
  NamedMesh(MeshFile read, std::string called)
      : file_(std::make_shared<const MeshFile>(std::move(read))), name_(std::move(called)) {}

  const MeshFile& file() const { return *file_; }
  const TriangleMesh& mesh() const { return file_->mesh; }
  const std::string& name() const { return name_; }
  /// The GIL must be held.
  std::shared_ptr<const ClosestPointFinder> finder() const;

 private:
  std::shared_ptr<const MeshFile> file_;
  std::string name_;
  mutable std::shared_ptr<const ClosestPointFinder> finder_;
};

/// A path, points [n, 3], or a PointCloud.
struct PointsArgument {
  nb::handle source;
};

/// Points of an array, as if read from a file. @throws InputError for another shape, numbers that are not
///   finite or larger than a file may have
PointCloudFile points_of_array(const ArrayLike& points, const char* name,
                               const std::optional<ArrayLike>& normals = std::nullopt);

/// Points with their name.
struct NamedPoints {
  PointCloudFile file;
  std::string name;
};

/// A point cloud, a path, or an array. @param in_plane  an array may be [n, 2], and a file need not have z
NamedPoints points_of(const PointsArgument& argument, const char* name, const std::optional<std::string>& unit,
                      const std::string& called, bool in_plane = false);

using MeshArgument = std::variant<NamedMesh, std::filesystem::path>;
/// Reads it if it is a path. @param unit  for a file that states none
NamedMesh mesh_of(const MeshArgument& argument, const std::optional<std::string>& unit);

/// Its triangles. @throws InputError if faces were left out  @param expected  for the message: all of what
const TriangleMesh& whole_mesh(const NamedMesh& mesh, const char* expected);

/// Enters a scan and its part, each read where it is a path, with their names.
template <class Request>
void enter_scan_and_part(const PointsArgument& scan, const std::optional<std::string>& unit, const MeshArgument& part,
                         const std::optional<std::string>& part_unit, Request& request) {
  NamedPoints points = points_of(scan, "scan", unit, "");
  const NamedMesh mesh = mesh_of(part, part_unit);
  request.scan_file = points.name;
  request.part_file = mesh.name();
  request.scan = std::move(points.file);
  request.part = mesh.file();
}

/// "mm", "m", "inch". @throws InputError
std::optional<FileLength> file_unit(const char* name, const std::optional<std::string>& unit);

/// A transform as [4, 4] with mm. @throws InputError
RigidTransform rigid_transform(const ArrayLike& argument, const char* name);
Eigen::Matrix4d transform_matrix(const RigidTransform& transform);
/// [3], a point or a direction. @param words  what it is, for messages  @throws InputError
Eigen::Vector3d vector_of(const ArrayLike& argument, const char* name, const char* words);
std::optional<Eigen::Vector3d> direction_of(const std::optional<ArrayLike>& argument, const char* name);

/// [n, 3], a view of columns, which belong to `owner`; the array keeps it alive.
nb::object rows_view(const Eigen::Matrix3Xd& columns, nb::handle owner);
/// [n, 3], copied.
nb::object copied_rows(const Eigen::Matrix3Xd& columns);

void bind_clouds(nb::module_& module);
void bind_meshes(nb::module_& module);
void bind_closest_points(nb::module_& module);
void bind_ideal_shapes(nb::module_& module);
void bind_fits(nb::module_& module);
void bind_transforms(nb::module_& module);
void bind_registrations(nb::module_& module);
void bind_deviations(nb::module_& module);
void bind_scan_points(nb::module_& module);
void bind_planned_scans(nb::module_& module);

}  // namespace abbe::python

namespace nanobind::detail {

template <>
struct type_caster<abbe::python::PointsArgument> {
  NB_TYPE_CASTER(abbe::python::PointsArgument, const_name("str | os.PathLike | numpy.typing.ArrayLike | PointCloud"))
  bool from_python(handle source, std::uint32_t, cleanup_list*) noexcept {
    value.source = source;
    return !source.is_none();
  }
};

}  // namespace nanobind::detail
