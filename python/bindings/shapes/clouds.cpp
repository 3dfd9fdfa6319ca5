#include <fmt/format.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <nlohmann/json.hpp>

#include "abbe/formats/shapes/ending.h"
#include "abbe/formats/shapes/geometry_check.h"
#include "abbe/formats/shapes/ply_file.h"
#include "abbe/report/words/geometry_check_words.h"
#include "bindings/files.h"
#include "bindings/shapes/shapes.h"
#include "bindings/use/arguments.h"

namespace abbe::python {
namespace {

CheckedCloud check(const NamedPoints& points) {
  if (points.file.cloud.size() == 0)
    throw InputError({.file = points.name}, "there are no points", "at least one point");
  const nb::gil_scoped_release release;
  return checked_cloud(points.file);
}

}  // namespace

void bind_clouds(nb::module_& module) {
  nb::class_<NamedPoints>(module, "PointCloud",
                          "Points of a scan in the order in which they were taken, mm; they do not change.\n\n"
                          ">>> import abbe\n"
                          ">>> len(abbe.PointCloud([[0, 0, 0], [1, 0, 0]]))\n"
                          "2\n")
      .def(
          "__init__",
          [](NamedPoints* self, const ArrayLike& points, const std::optional<ArrayLike>& normals,
             const std::string& name) {
            new (self) NamedPoints{points_of_array(points, "points_mm", normals), name};
          },
          nb::arg("points_mm"), nb::arg("normals") = nb::none(), nb::arg("name") = "points",
          "points_mm [n, 3]. normals [n, 3], out of the material, of any length. name: for texts and messages.")
      .def_static(
          "read",
          [](const std::filesystem::path& path, const std::optional<std::string>& unit,
             std::map<std::string, std::string> columns, std::vector<std::string> ignore) {
            PointCloudOptions options;
            options.unit = file_unit("unit", unit);
            options.mapping.columns = std::move(columns);
            options.mapping.ignore = std::move(ignore);
            options.mapping.ignored_by = "ignore";
            return NamedPoints{computed([&] { return read_point_cloud(path, options); }), path.string()};
          },
          nb::arg("path"), nb::kw_only(), nb::arg("unit") = nb::none(),
          nb::arg("columns") = std::map<std::string, std::string>{}, nb::arg("ignore") = std::vector<std::string>{},
          "From a file: csv, xyz, ply, pcd, e57, obj (docs/geometry-files.md). unit: 'mm', 'm' or 'inch', for a file "
          "that\n"
          "states none (default: mm). columns: {'x_mm': 'East'}, for a CSV file with other names; ignore: its columns "
          "to\n"
          "skip. Raises InputError.")
      .def_prop_ro(
          "points_mm",
          [](nb::handle_t<NamedPoints> self) { return rows_view(initialised(self).file.cloud.points, self); },
          nb::sig("def points_mm(self) -> numpy.ndarray"), "[n, 3], read-only.")
      .def_prop_ro(
          "normals",
          [](nb::handle_t<NamedPoints> self) -> nb::object {
            const PointCloud& cloud = initialised(self).file.cloud;
            return cloud.has_normals() ? rows_view(cloud.normals, self) : nb::none();
          },
          nb::sig("def normals(self) -> numpy.ndarray | None"), "[n, 3] unit vectors; None if not known.")
      .def_prop_ro(
          "deviation_mm",
          [](const NamedPoints& p) -> nb::object {
            if (p.file.deviation_mm.empty()) return nb::none();
            return copied_array(p.file.deviation_mm);
          },
          nb::sig("def deviation_mm(self) -> numpy.ndarray | None"), "[n] of a CSV file with such a column; else None.")
      .def_prop_ro(
          "format", [](const NamedPoints& p) { return p.file.format; }, "'CSV', 'PLY, ascii', ..., 'array'.")
      .def_prop_ro(
          "unit", [](const NamedPoints& p) { return unit_words(p.file.unit); },
          "Unit of the file, and how it is known.")
      .def_prop_ro(
          "left_out", [](const NamedPoints& p) { return p.file.left_out; },
          "Number of points of the file that are not in the cloud, because they have no coordinates (PCD, E57).")
      .def_prop_ro(
          "notes", [](const NamedPoints& p) { return p.file.notes; }, "Sentences on what was left out of the file.")
      .def_ro("name", &NamedPoints::name)
      .def(
          "check_text", [](const NamedPoints& p) { return cloud_text(check(p)); },
          "Extent, centroid and repeated points of the cloud, as text.")
      .def(
          "check", [](const NamedPoints& p) { return python_value(cloud_json(check(p))); },
          nb::sig("def check(self) -> dict[str, typing.Any]"), "The same as a dictionary; units in the keys.")
      .def(
          "csv", [](const NamedPoints& p) { return point_cloud_csv(p.file.cloud, p.file.deviation_mm, p.file.names); },
          "CSV: x_mm,y_mm,z_mm, then nx,ny,nz, deviation_mm and point where there are any; reads back to the same "
          "bits.")
      .def(
          "write",
          [](const NamedPoints& p, const std::filesystem::path& path, bool overwrite) {
            const std::string ending = path.extension().string();
            if (ending != ".csv" && ending != ".ply") {
              throw InputError({.file = path.string()}, "has another ending", ".csv or .ply");
            }
            const PointCloud& cloud = p.file.cloud;
            write_text(
                path,
                ending == ".csv"
                    ? point_cloud_csv(cloud, p.file.deviation_mm, p.file.names)
                    : ply_bytes({.points = cloud.points, .normals = cloud.normals, .deviation = p.file.deviation_mm}),
                overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false, "Writes .csv or .ply (binary), whole or not at all.")
      .def("__len__", [](const NamedPoints& p) { return static_cast<std::size_t>(p.file.cloud.size()); })
      .def("__repr__", [](const NamedPoints& p) {
        return fmt::format("<abbe.PointCloud '{}': {} points{}>", p.name, p.file.cloud.size(),
                           p.file.cloud.has_normals() ? " with normals" : "");
      });
}

}  // namespace abbe::python
