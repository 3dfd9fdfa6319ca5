#include "bindings/use/piece_parts.h"

#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <numeric>

namespace abbe::python {
namespace {

PieceTrace trace_of(const Machine& machine, const ArrayLike& positions, const std::optional<ArrayLike>& time,
                    const std::string& file) {
  const Positions given(positions, machine);
  if (given.single() || given.count() < 2) {
    throw InputError({.field = "positions_mm_rad"}, "has less than two samples", "shape (n, axes)");
  }
  PieceTrace trace{file, {given.list(), {}, std::vector<std::size_t>(given.count())}};
  std::iota(trace.trace.lines.begin(), trace.trace.lines.end(), std::size_t{1});
  if (!time) return trace;
  trace.trace.time_s = number_list(*time, "time_s", "the time of each sample, s");
  if (trace.trace.time_s.size() != given.count() ||
      std::adjacent_find(trace.trace.time_s.begin(), trace.trace.time_s.end(), std::greater<>()) !=
          trace.trace.time_s.end()) {
    throw InputError({.field = "time_s"}, "does not fit the samples",
                     fmt::format("{} times that never decrease, s", given.count()));
  }
  return trace;
}

/// [n, 3] of [3, n].
nb::object rows_of(const Eigen::Matrix3Xd& columns) {
  const auto count = static_cast<std::size_t>(columns.cols());
  return array_of({columns.data(), columns.data() + 3 * count}, {count, 3});
}

template <class Get>
void points_attribute(nb::class_<PieceDeviation>& bound, const char* name, const char* signature, const Get& get,
                      const char* words) {
  bound.def_prop_ro(
      name, [get](const PieceDeviation& d) { return rows_of(get(d)); }, nb::sig(signature), words);
}

void bind_deviation(nb::module_& module) {
  nb::class_<PieceDeviation> bound(module, "PieceDeviation",
                                   "What a tool leaves on a test piece, sample by sample while it cuts.");
  bound.def_ro("rows", &PieceDeviation::rows, "[n] indices of the samples.")
      .def_ro("reached_mm", &PieceDeviation::reached, "How far along the curve the cut goes, mm.")
      .def_ro("length_mm", &PieceDeviation::length, "Of the whole curve, mm.")
      .def_prop_ro(
          "along_mm", [](const PieceDeviation& d) { return copied_array(d.along); },
          nb::sig("def along_mm(self) -> numpy.ndarray"), "[n] place along the curve, mm.")
      .def_prop_ro(
          "foot_mm", [](const PieceDeviation& d) { return copied_array(d.foot); },
          nb::sig("def foot_mm(self) -> numpy.ndarray"), "[n] flank deviation at the foot, mm; above 0: material left.")
      .def_prop_ro(
          "head_mm", [](const PieceDeviation& d) { return copied_array(d.head); },
          nb::sig("def head_mm(self) -> numpy.ndarray"), "[n] the same at the head.");
  using D = PieceDeviation;
  points_attribute(
      bound, "contour_mm", "def contour_mm(self) -> numpy.ndarray", [](const D& d) { return d.contour; },
      "[n, 3] functional point from the nearest place of its curve, mm.");
  points_attribute(
      bound, "foot_points_mm", "def foot_points_mm(self) -> numpy.ndarray", [](const D& d) { return d.foot_point; },
      "[n, 3] of the surface there.");
  points_attribute(
      bound, "head_points_mm", "def head_points_mm(self) -> numpy.ndarray", [](const D& d) { return d.head_point; },
      "[n, 3]");
  points_attribute(
      bound, "foot_normals", "def foot_normals(self) -> numpy.ndarray", [](const D& d) { return d.foot_normal; },
      "[n, 3] out of the material.");
  points_attribute(
      bound, "head_normals", "def head_normals(self) -> numpy.ndarray", [](const D& d) { return d.head_normal; },
      "[n, 3]");
  points_attribute(
      bound, "tool_mm", "def tool_mm(self) -> numpy.ndarray", [](const D& d) { return d.tool; },
      "[n, 3] place on the curve of the functional point, mm.");
  points_attribute(
      bound, "tangents", "def tangents(self) -> numpy.ndarray", [](const D& d) { return d.tangent; },
      "[n, 3] along the curve there.");
}

void bind_figures(nb::module_& module) {
  nb::class_<FlankFigures>(module, "FlankFigures", "One edge of the surface of a test piece: foot or head.")
      .def_ro("lowest_mm", &FlankFigures::lowest)
      .def_ro("highest_mm", &FlankFigures::highest)
      .def_ro("rms_mm", &FlankFigures::rms, "About zero, evenly along the curve.")
      .def_prop_ro("largest_mm", &FlankFigures::largest, "Magnitude.")
      .def_prop_ro("range_mm", &FlankFigures::range);
  nb::class_<PieceFigures>(module, "PieceFigures", "Figures of a cut.")
      .def_ro("foot", &PieceFigures::foot)
      .def_ro("head", &PieceFigures::head)
      .def_prop_ro(
          "contour_mean_mm", [](const PieceFigures& f) { return f.contour.mean; }, "Across the curve, mm.")
      .def_prop_ro("contour_largest_mm", [](const PieceFigures& f) { return f.contour.largest; })
      .def_prop_ro(
          "datum_shift_mm", [](const PieceFigures& f) { return f.datum.shift; },
          "Shift of the workpiece that was taken out, mm.")
      .def_prop_ro(
          "datum_turn_rad", [](const PieceFigures& f) { return f.datum.turn; }, "Its turn, rad, about datum_centre_mm.")
      .def_prop_ro("datum_centre_mm", [](const PieceFigures& f) { return f.datum.centre; })
      .def_prop_ro(
          "foot_left_mm", [](const PieceFigures& f) { return copied_array(f.foot_left); },
          nb::sig("def foot_left_mm(self) -> numpy.ndarray"), "[n] deviations that the figures are of, mm.")
      .def_prop_ro(
          "head_left_mm", [](const PieceFigures& f) { return copied_array(f.head_left); },
          nb::sig("def head_left_mm(self) -> numpy.ndarray"));
  nb::class_<Roundness>(module, "ConeRoundness", "Roundness of one section across the axis of a cone, ISO 12181-1.")
      .def_ro("evaluated", &Roundness::evaluated)
      .def_ro("roundness_mm", &Roundness::roundness, "Largest less smallest radius, mm.")
      .def_ro("centre_mm", &Roundness::centre, "From the axis of the cone, mm.")
      .def_ro("radius_deviation_mm", &Roundness::radius_deviation, "Mean radius less nominal, mm.");
}

}  // namespace

void bind_piece_parts(nb::module_& module) {
  nb::class_<PieceTrace>(module, "Trace", "What the axes of a machine were commanded while a program ran.")
      .def(
          "__init__",
          [](PieceTrace* self, const Machine& machine, const ArrayLike& positions, const std::optional<ArrayLike>& time,
             const std::string& file) { new (self) PieceTrace(trace_of(machine, positions, time, file)); },
          nb::arg("machine"), nb::arg("positions_mm_rad"), nb::arg("time_s") = nb::none(), nb::arg("file") = "trace",
          "positions_mm_rad [n, axes]: a row for each servo cycle or so. time_s [n]. file: name for messages.")
      .def_static(
          "read",
          [](const std::filesystem::path& path, const Machine& machine) {
            return PieceTrace{path.string(), read_trace(path, machine)};
          },
          nb::arg("path"), nb::arg("machine"), "From a CSV: a column for each axis (X_mm, A_deg), and time_s.")
      .def_static(
          "parse",
          [](const std::string& text, const Machine& machine, const std::string& file) {
            return PieceTrace{file, parse_trace(text, file, machine)};
          },
          nb::arg("text"), nb::arg("machine"), nb::arg("file") = "trace.csv", "From the text of such a file.")
      .def_ro("file", &PieceTrace::file)
      .def_prop_ro(
          "positions_mm_rad", [](const PieceTrace& t) { return copied_poses(t.trace.commands); },
          nb::sig("def positions_mm_rad(self) -> numpy.ndarray"), "[n, axes]")
      .def_prop_ro(
          "time_s",
          [](const PieceTrace& t) -> nb::object {
            if (t.trace.time_s.empty()) return nb::none();
            return copied_array(t.trace.time_s);
          },
          nb::sig("def time_s(self) -> numpy.ndarray | None"), "[n] s; None: not stated.")
      .def("__len__", [](const PieceTrace& t) { return t.trace.commands.count(); })
      .def("__repr__", [](const PieceTrace& t) {
        return fmt::format("<abbe.Trace {}: {} samples>", t.file, t.trace.commands.count());
      });
  bind_deviation(module);
  bind_figures(module);
  nb::class_<PieceRun>(module, "PieceRun", "One run of a test piece.")
      .def_ro("file", &PieceRun::file)
      .def_ro("samples", &PieceRun::samples)
      .def_ro("duration_s", &PieceRun::duration_s, "Of the cut; None: the trace has no times.")
      .def_ro("deviation", &PieceRun::deviation)
      .def_ro("as_cut", &PieceRun::as_cut, "Without the best fit of the workpiece.")
      .def_ro("aligned", &PieceRun::aligned, "With the best fit of the workpiece.")
      .def_ro("foot", &PieceRun::foot, "Roundness of a cone at its foot.")
      .def_ro("head", &PieceRun::head, "Roundness of a cone at its head.");
  nb::class_<VerifiedPiece>(module, "VerifiedPiece", "A test piece that was run without and with a compensation.")
      .def_ro("is_cone", &VerifiedPiece::is_cone)
      .def_ro("name", &VerifiedPiece::name)
      .def_ro("before", &VerifiedPiece::before)
      .def_ro("after", &VerifiedPiece::after)
      .def("__repr__", [](const VerifiedPiece& p) { return fmt::format("<abbe.VerifiedPiece {}>", p.name); });
}

}  // namespace abbe::python
