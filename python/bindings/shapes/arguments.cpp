#include "bindings/use/arguments.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/ndarray.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "bindings/shapes/shapes.h"

namespace abbe::python {
namespace {

/// The first coordinates of points or directions, row by row; the others are zero. @param words  what they are
Eigen::Matrix3Xd columns_of(const ArrayLike& array, const char* name, std::size_t width, const char* words) {
  const Rows rows(array, name, width, words);
  if (rows.single()) {
    throw InputError({.field = name}, "is a single row", fmt::format("shape (n, {}): {}", width, words));
  }
  Eigen::Matrix3Xd columns = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(rows.count()));
  for (std::size_t k = 0; k < rows.count(); ++k) {
    for (std::size_t i = 0; i < width; ++i) {
      const double value = rows.at(k, i);
      if (std::abs(value) > kLargestInput) {
        throw InputError({.field = name}, fmt::format("row {}, number {}: {}", k, i, value), "at most 1e9");
      }
      columns(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = value;
    }
  }
  return columns;
}

PointCloudFile file_of(Eigen::Matrix3Xd points) {
  PointCloudFile file;
  file.cloud.points = std::move(points);
  file.cloud.normals.resize(3, 0);
  file.format = "array";
  file.unit = {FileLength::millimetre, UnitSource::given};
  return file;
}

bool has_two_columns(const ArrayLike& points, const char* name) {
  const Numbers array = points.numbers(name);
  return array.ndim() == 2 && array.shape(1) == 2;
}

}  // namespace

std::shared_ptr<const ClosestPointFinder> NamedMesh::finder() const {
  if (finder_) return finder_;
  if (mesh().size() == 0) throw InputError({.file = name_}, "there are no triangles", "at least one triangle");
  std::shared_ptr<const ClosestPointFinder> made;
  {
    const nb::gil_scoped_release release;
    made = std::make_shared<const ClosestPointFinder>(mesh());
  }
  return finder_ = made;
}

PointCloudFile points_of_array(const ArrayLike& points, const char* name, const std::optional<ArrayLike>& normals) {
  PointCloudFile file = file_of(columns_of(points, name, 3, "points, mm"));
  if (!normals) return file;
  Eigen::Matrix3Xd& directions = file.cloud.normals;
  directions = columns_of(*normals, "normals", 3, "directions out of the material");
  if (directions.cols() != file.cloud.points.cols()) {
    throw InputError({.field = "normals"}, fmt::format("has {} rows", directions.cols()),
                     fmt::format("{} as in {}", file.cloud.points.cols(), name));
  }
  for (Eigen::Index k = 0; k < directions.cols(); ++k) {
    const double length = directions.col(k).norm();
    if (!(length > 0)) throw InputError({.field = "normals"}, fmt::format("row {} has no length", k), "a direction");
    directions.col(k) /= length;
  }
  return file;
}

std::optional<FileLength> file_unit(const char* name, const std::optional<std::string>& unit) {
  if (!unit) return std::nullopt;
  const std::optional<FileLength> length = file_length_named(*unit);
  if (length) return length;
  throw InputError({.field = name}, fmt::format("'{}' is not a unit of a file", unit->substr(0, 40)),
                   fmt::format("{}", fmt::join(file_length_names(), ", ")));
}

NamedPoints points_of(const PointsArgument& argument, const char* name, const std::optional<std::string>& unit,
                      const std::string& called, bool in_plane) {
  const std::optional<FileLength> length = file_unit("unit", unit);
  const bool is_cloud = nb::isinstance<NamedPoints>(argument.source);
  const std::optional<std::filesystem::path> path = is_cloud ? std::nullopt : path_of(argument.source);
  if (path) {
    PointCloudOptions options;
    options.unit = length;
    options.in_plane = in_plane;
    return {computed([&] { return read_point_cloud(*path, options); }), called.empty() ? path->string() : called};
  }
  if (length) throw InputError({.field = "unit"}, "has no effect on an array, which is in mm", "a file of points");
  if (is_cloud) {
    NamedPoints points = initialised(nb::handle_t<NamedPoints>(argument.source));
    if (!called.empty()) points.name = called;
    return points;
  }
  const ArrayLike array{argument.source};
  return {in_plane && has_two_columns(array, name) ? file_of(columns_of(array, name, 2, "points in the plane, mm"))
                                                   : points_of_array(array, name),
          called.empty() ? "points" : called};
}

NamedMesh mesh_of(const MeshArgument& argument, const std::optional<std::string>& unit) {
  const std::optional<FileLength> length = file_unit("part_unit", unit);
  if (const auto* const mesh = std::get_if<NamedMesh>(&argument)) {
    if (length) throw InputError({.field = "part_unit"}, "has no effect on a Mesh, which is in mm", "a file");
    return *mesh;
  }
  const auto& path = std::get<std::filesystem::path>(argument);
  MeshFileOptions options;
  options.unit = length;
  return {computed([&] { return read_mesh(path, options); }), path.string()};
}

const TriangleMesh& whole_mesh(const NamedMesh& mesh, const char* expected) {
  if (mesh.file().left_out.empty()) return mesh.mesh();
  throw InputError({.file = mesh.name()}, "faces are left out: " + mesh.file().left_out.front(), expected);
}

RigidTransform rigid_transform(const ArrayLike& argument, const char* name) {
  const Rows rows(argument, name, 4, "a rigid transform, mm");
  if (rows.count() != 4 || rows.single()) throw InputError({.field = name}, "has another shape", "shape (4, 4), mm");
  RigidTransform result;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    for (std::size_t j = 0; j < 3; ++j) result.rotation(row, static_cast<Eigen::Index>(j)) = rows.at(i, j);
    result.translation[row] = rows.at(i, 3);
  }
  const bool is_last_row = rows.at(3, 0) == 0 && rows.at(3, 1) == 0 && rows.at(3, 2) == 0 && rows.at(3, 3) == 1;
  const Eigen::Matrix3d& r = result.rotation;
  constexpr double kRounding = 1e-6;
  const bool is_rotation = (r.transpose() * r).isIdentity(kRounding) && r.col(0).cross(r.col(1)).dot(r.col(2)) > 0;
  if (!is_last_row || !is_rotation)
    throw InputError({.field = name}, "is not a rigid transform", "a rotation and a translation in mm");
  return result;
}

Eigen::Matrix4d transform_matrix(const RigidTransform& transform) {
  Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
  result.topLeftCorner<3, 3>() = transform.rotation;
  result.topRightCorner<3, 1>() = transform.translation;
  return result;
}

Eigen::Vector3d vector_of(const ArrayLike& argument, const char* name, const char* words) {
  const Rows rows(argument, name, 3, words);
  if (!rows.single()) throw InputError({.field = name}, "has another shape", fmt::format("shape (3,): {}", words));
  return {rows.at(0, 0), rows.at(0, 1), rows.at(0, 2)};
}

std::optional<Eigen::Vector3d> direction_of(const std::optional<ArrayLike>& argument, const char* name) {
  if (!argument) return std::nullopt;
  return vector_of(*argument, name, "a direction");
}

nb::object rows_view(const Eigen::Matrix3Xd& columns, nb::handle owner) {
  const std::array<std::size_t, 2> shape{static_cast<std::size_t>(columns.cols()), 3};
  return nb::cast(nb::ndarray<nb::numpy, const double>(columns.data(), 2, shape.data(), owner),
                  nb::rv_policy::reference);
}

nb::object copied_rows(const Eigen::Matrix3Xd& columns) {
  return array_of(std::vector<double>(columns.data(), columns.data() + columns.size()),
                  {static_cast<std::size_t>(columns.cols()), 3});
}

}  // namespace abbe::python
