#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <Eigen/Geometry>

#include "abbe/formats/machine/placement_file.h"
#include "bindings/files.h"
#include "bindings/shapes/shapes.h"
#include "bindings/use/arguments.h"

namespace abbe::python {
namespace {

using Covariance = Eigen::Matrix<double, 6, 6>;

Covariance covariance_of_six(const ArrayLike& argument) {
  const Rows rows(argument, "covariance", 6, "covariance of translation (mm) and rotation vector (rad)");
  if (rows.count() != 6 || rows.single())
    throw InputError({.field = "covariance"}, "has another shape", "shape (6, 6)");
  Covariance result;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 6; ++j) {
      result(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = rows.at(i, j);
    }
  }
  if ((result - result.transpose()).cwiseAbs().maxCoeff() > 1e-10 * result.cwiseAbs().maxCoeff()) {
    throw InputError({.field = "covariance"}, "is not symmetric", "a covariance matrix");
  }
  return result;
}

}  // namespace

void bind_placements(nb::module_& module) {
  nb::class_<PlacementFile>(module, "Placement",
                            "Where a workpiece is clamped: its frame seen from the workpiece frame of the machine.\n\n"
                            ">>> import abbe, numpy\n"
                            ">>> matrix = numpy.eye(4)\n"
                            ">>> matrix[:3, 3] = 100, 50, 0\n"
                            ">>> abbe.Placement(matrix).matrix[:3, 3].tolist()\n"
                            "[100.0, 50.0, 0.0]\n")
      .def(
          "__init__",
          [](PlacementFile* self, const ArrayLike& matrix4, const std::optional<ArrayLike>& covariance) {
            PlacementFile made{{rigid_transform(matrix4, "matrix"), std::nullopt}};
            if (covariance) made.placement.covariance = covariance_of_six(*covariance);
            new (self) PlacementFile(std::move(made));
          },
          nb::arg("matrix"), nb::arg("covariance") = nb::none(),
          "matrix [4, 4]: table from workpiece, mm. covariance [6, 6] of a small motion: translation (mm), rotation\n"
          "vector (rad).")
      .def_static("read", &read_placement, nb::arg("path"), "From a file (*.placement.toml). Raises InputError.")
      .def_static("parse", &parse_placement, nb::arg("text"), nb::arg("file") = "placement.toml",
                  "From the text of such a file.")
      .def_prop_ro(
          "matrix", [](const PlacementFile& p) { return transform_matrix(p.placement.table_from_workpiece); },
          "Table from workpiece, [4, 4], mm.")
      .def_prop_ro(
          "covariance", [](const PlacementFile& p) -> std::optional<Covariance> { return p.placement.covariance; },
          "[6, 6] of translation (mm) and rotation vector (rad); None: not stated.")
      .def_ro("warnings", &PlacementFile::warnings)
      .def("text", &placement_text, nb::arg("table_to_workpiece") = false,
           "Text of a file, in the reading 'workpiece-to-table' or 'table-to-workpiece'.")
      .def(
          "write",
          [](const PlacementFile& p, const std::filesystem::path& path, bool overwrite, bool to_workpiece) {
            write_text(path, placement_text(p, to_workpiece), overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false, nb::arg("table_to_workpiece") = false, "Writes text().")
      .def(
          "machine_with_workpiece",
          [](const PlacementFile& p, const Machine& machine) { return with_workpiece(machine, p.placement); },
          nb::arg("machine"), "The machine with a workpiece clamped so.")
      .def("__repr__", [](const PlacementFile& p) {
        const Eigen::Vector3d& at = p.placement.table_from_workpiece.translation;
        return fmt::format("<abbe.Placement at {:.6g} {:.6g} {:.6g} mm>", at[0], at[1], at[2]);
      });
  module.def(
      "rotation_xyz",
      [](const Triple& angles) {
        for (const double angle : angles) {
          if (!std::isfinite(angle)) throw InputError({.field = "angles_rad"}, fmt::format("has {}", angle), "angles");
        }
        return rotation_xyz({angles[0], angles[1], angles[2]});
      },
      nb::arg("angles_rad"),
      "Rx(alpha) Ry(beta) Rz(gamma), intrinsic, [3, 3]. Yin et al., Machines 9 (2021) 237, eq. 8.");
  module.def(
      "angles_xyz",
      [](const ArrayLike& rotation) {
        const Rows rows(rotation, "rotation", 3, "a rotation");
        if (rows.single() || rows.count() != 3) {
          throw InputError({.field = "rotation"}, "has another shape", "shape (3, 3)");
        }
        Eigen::Matrix3d turned;
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t j = 0; j < 3; ++j) {
            turned(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = rows.at(i, j);
          }
        }
        return angles_xyz(turned);
      },
      nb::arg("rotation"), "(alpha, beta, gamma) of a rotation [3, 3], rad; the inverse of rotation_xyz().");
}

}  // namespace abbe::python
