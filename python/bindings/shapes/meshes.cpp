#include <fmt/format.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/shapes/geometry_check.h"
#include "abbe/report/words/geometry_check_words.h"
#include "bindings/files.h"
#include "bindings/job.h"
#include "bindings/shapes/shapes.h"
#include "bindings/use/arguments.h"

namespace abbe::python {
namespace {

Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic> corners_of(const ArrayLike& triangles, Eigen::Index vertices) {
  const Rows rows(triangles, "triangles", 3, "indices of vertices");
  if (rows.single()) throw InputError({.field = "triangles"}, "is a single row", "shape (n, 3): indices of vertices");
  Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic> corners(3, static_cast<Eigen::Index>(rows.count()));
  for (std::size_t k = 0; k < rows.count(); ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double index = rows.at(k, i);
      if (!(index >= 0 && index < static_cast<double>(vertices)) || index != std::floor(index)) {
        throw InputError({.field = "triangles"}, fmt::format("row {}, number {}: {}", k, i, index),
                         fmt::format("whole numbers from 0, below the {} vertices", vertices));
      }
      corners(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = static_cast<std::uint32_t>(index);
    }
  }
  return corners;
}

NamedMesh mesh_of_arrays(const ArrayLike& vertices, const ArrayLike& triangles, const std::string& name) {
  MeshFile file;
  file.mesh.vertices = points_of_array(vertices, "vertices_mm").cloud.points;
  file.mesh.triangles = corners_of(triangles, file.mesh.vertices.cols());
  file.format = "array";
  file.unit = {FileLength::millimetre, UnitSource::given};
  return {std::move(file), name};
}

NamedMesh mesh_from(const std::filesystem::path& path, const std::optional<std::string>& unit,
                    std::optional<double> chord_mm, double step_seconds, bool leave_out_faces,
                    const nb::object& progress) {
  MeshFileOptions options;
  options.unit = file_unit("unit", unit);
  if (chord_mm && !(*chord_mm > 0 && std::isfinite(*chord_mm))) {
    throw InputError({.field = "chord_mm"}, fmt::format("is {}", *chord_mm), "a length in mm above zero");
  }
  if (!(step_seconds > 0 && std::isfinite(step_seconds))) {
    throw InputError({.field = "step_seconds"}, fmt::format("is {}", step_seconds), "a time in s above zero");
  }
  options.step.chord_mm = chord_mm;
  options.step.most_seconds = step_seconds;
  options.step.leave_out_faces = leave_out_faces;
  return job_result(progress, [&](const JobControl& control) {
    options.step.progress = [&](const std::string& what, std::size_t done, std::size_t total) {
      control.progress(what.c_str(), done, total);
    };
    return naming_arguments([&] { return NamedMesh{read_mesh(path, options), path.string()}; });
  });
}

CheckedMesh check(const NamedMesh& mesh) {
  const nb::gil_scoped_release release;
  return checked_mesh(mesh.file());
}

void bind_facts(nb::class_<NamedMesh>& bound) {
  bound.def_prop_ro("name", &NamedMesh::name, "For texts and messages: the path of a file.")
      .def_prop_ro(
          "format", [](const NamedMesh& m) { return m.file().format; }, "'STL, binary', ..., 'array'.")
      .def_prop_ro(
          "unit", [](const NamedMesh& m) { return unit_words(m.file().unit); },
          "Unit of the file, and how it is known.")
      .def_prop_ro(
          "notes", [](const NamedMesh& m) { return m.file().notes; }, "What a reader of results must know.")
      .def_prop_ro(
          "faces", [](const NamedMesh& m) { return m.file().faces; },
          "Number of faces that the file states: those of STEP; objects, groups and materials of OBJ; else 0.")
      .def_prop_ro(
          "face_of_triangle",
          [](const NamedMesh& m) -> nb::object {
            const std::vector<std::uint32_t>& faces = m.file().face_of_triangle;
            if (faces.empty()) return nb::none();
            return array_of_ints(std::vector<int>(faces.begin(), faces.end()));
          },
          nb::sig("def face_of_triangle(self) -> numpy.ndarray | None"),
          "[m] index of the face, from 0; None if faces is 0.")
      .def_prop_ro(
          "face_names", [](const NamedMesh& m) { return m.file().face_names; }, "Of OBJ: 'object / group / material'.")
      .def_prop_ro(
          "deviation_mm", [](const NamedMesh& m) { return m.file().deviation_mm; },
          "STEP: largest distance measured between the triangles and the exact faces.")
      .def_prop_ro(
          "left_out", [](const NamedMesh& m) { return m.file().left_out; },
          "STEP: faces that are missing, with the reason.");
}

}  // namespace

void bind_meshes(nb::module_& module) {
  nb::class_<NamedMesh> bound(module, "Mesh",
                              "The surface of a part as triangles, mm; it does not change.\n\n"
                              "The vertices of a triangle run anticlockwise, seen from outside.\n\n"
                              ">>> import abbe\n"
                              ">>> corner = abbe.Mesh([[0, 0, 0], [10, 0, 0], [0, 10, 0]], [[0, 1, 2]])\n"
                              ">>> corner.closest([[2, 3, 5.0]]).distance_mm.tolist()\n"
                              "[5.0]\n");
  bound
      .def(
          "__init__",
          [](NamedMesh* self, const ArrayLike& vertices, const ArrayLike& triangles, const std::string& name) {
            new (self) NamedMesh(mesh_of_arrays(vertices, triangles, name));
          },
          nb::arg("vertices_mm"), nb::arg("triangles"), nb::arg("name") = "mesh",
          "vertices_mm [n, 3]. triangles [m, 3]: indices of vertices. Raises InputError.")
      .def_static(
          "read", &mesh_from, nb::arg("path"), nb::kw_only(), nb::arg("unit") = nb::none(),
          nb::arg("chord_mm") = nb::none(), nb::arg("step_seconds") = 60.0, nb::arg("leave_out_faces") = false,
          nb::arg("progress") = nb::none(),
          "From a file: STL, PLY, OBJ, STEP (docs/geometry-files.md); the contents decide which.\n\n"
          "unit: 'mm', 'm' or 'inch', for a file that states none (default: mm). For STEP: chord_mm, the largest "
          "distance of\n"
          "the triangles from the exact faces (0.01 mm, less for very small parts and more for very large ones);\n"
          "step_seconds, a time limit; leave_out_faces, to leave out faces that cannot be read. The "
          "environment\n"
          "variable ABBE_STEP_PROGRAM says where abbe-step is, which reads them.\n"
          "progress: a function of the step, what is done and its total. Raises InputError.")
      .def_prop_ro(
          "vertices_mm",
          [](nb::handle_t<NamedMesh> self) { return rows_view(initialised(self).mesh().vertices, self); },
          nb::sig("def vertices_mm(self) -> numpy.ndarray"), "[n, 3], read-only.")
      .def_prop_ro(
          "triangles",
          [](nb::handle_t<NamedMesh> self) {
            const auto& triangles = initialised(self).mesh().triangles;
            const std::array<std::size_t, 2> shape{static_cast<std::size_t>(triangles.cols()), 3};
            return nb::cast(nb::ndarray<nb::numpy, const std::uint32_t>(triangles.data(), 2, shape.data(), self),
                            nb::rv_policy::reference);
          },
          nb::sig("def triangles(self) -> numpy.ndarray"), "[m, 3] indices of vertices, read-only.")
      .def(
          "check_text", [](const NamedMesh& m) { return mesh_text(check(m)); },
          "Whether the mesh is closed and oriented, its area, volume and holes, as text.")
      .def(
          "check", [](const NamedMesh& m) { return python_value(mesh_json(check(m))); },
          nb::sig("def check(self) -> dict[str, typing.Any]"), "The same as a dictionary; units in the keys.")
      .def(
          "write",
          [](const NamedMesh& m, const std::filesystem::path& path, bool overwrite) {
            refuse_existing(path, overwrite);
            computed([&] { write_mesh(path, m.mesh()); });
          },
          nb::arg("path"), nb::arg("overwrite") = false,
          "Writes .stl (binary, coordinates rounded to float) or .ply (binary, double), whole or not at all.")
      .def("__len__", [](const NamedMesh& m) { return static_cast<std::size_t>(m.mesh().size()); })
      .def("__repr__",
           [](const NamedMesh& m) { return fmt::format("<abbe.Mesh '{}': {} triangles>", m.name(), m.mesh().size()); });
  bind_facts(bound);
  bind_closest_points(module);
}

}  // namespace abbe::python
