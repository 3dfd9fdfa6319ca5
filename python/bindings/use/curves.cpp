#include "bindings/use/curves.h"

#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "abbe/formats/shapes/curve_file.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/study/scans/test_piece_sizes.h"
#include "bindings/arrays_of_each.h"

namespace abbe::python {
namespace {

NamedCurve named(Curve curve, const Machine& machine, std::string file) {
  NamedCurve result{std::move(curve), {}, std::move(file)};
  for (const std::size_t axis : result.curve.indexed) result.indexed.push_back(machine.axes[axis].name);
  return result;
}

/// A number of every point, or one for all of them.
std::vector<double> of_points(const ArrayLike& argument, const char* name, std::size_t count, const char* words) {
  const Numbers array = argument.numbers(name);
  if (array.ndim() == 0) {
    if (!std::isfinite(*array.data())) {
      throw InputError({.field = name}, fmt::format("is {}", *array.data()), "a finite number");
    }
    return std::vector<double>(count, *array.data());
  }
  std::vector<double> values = number_list(argument, name, words);
  if (values.size() != count) {
    throw InputError({.field = name}, fmt::format("has {} numbers", values.size()),
                     fmt::format("one, or {}: {}", count, words));
  }
  return values;
}

void refuse_below_zero(const std::vector<double>& values, const char* name) {
  for (const double value : values) {
    if (value < 0) throw InputError({.field = name}, fmt::format("has {}", value), "zero or more");
  }
}

NamedCurve curve_of(const ArrayLike& points, const std::optional<ArrayLike>& directions, const ArrayLike& feed,
                    const std::optional<ArrayLike>& working, const ArrayLike& dwell,
                    const std::map<std::string, std::vector<double>>& indexed, const std::string& file) {
  const Rows point(points, "points_mm", 3, "points in the workpiece frame, mm");
  if (point.single()) throw InputError({.field = "points_mm"}, "is a single point", "shape (n, 3), mm");
  const std::size_t count = point.count();
  std::optional<Rows> direction;
  if (directions) direction.emplace(*directions, "directions", 3, "from the functional point to the spindle");
  if (direction && !direction->single() && direction->count() != count) {
    throw InputError({.field = "directions"}, fmt::format("has {} rows", direction->count()),
                     fmt::format("one, or {}", count));
  }
  const std::vector<double> feeds = of_points(feed, "feed_mm_per_min", count, "on the way to each point");
  const std::vector<double> dwells = of_points(dwell, "dwell_s", count, "the time at each point, s");
  refuse_below_zero(feeds, "feed_mm_per_min");
  refuse_below_zero(dwells, "dwell_s");
  const std::vector<double> works =
      working ? of_points(*working, "working", count, "whether the tool works on the way to each point")
              : std::vector<double>(count, 1);
  NamedCurve result{{}, {}, file};
  for (const auto& [name, commands] : indexed) {
    if (commands.size() != count) {
      throw InputError({.field = "indexed_mm_rad"}, fmt::format("{} has {} commands", name, commands.size()),
                       fmt::format("{}", count));
    }
    result.indexed.push_back(name);
    result.curve.indexed.push_back(result.curve.indexed.size());  // curve_on() puts in the axes of a machine
  }
  for (std::size_t k = 0; k < count; ++k) {
    CurvePoint at;
    for (std::size_t i = 0; i < 3; ++i) {
      at.point[static_cast<Eigen::Index>(i)] = point.at(k, i);
      if (direction) at.direction[static_cast<Eigen::Index>(i)] = direction->at(k, i);
    }
    const double length = at.direction.norm();
    if (!(length > 0)) throw InputError({.field = "directions"}, fmt::format("row {} has no length", k), "a direction");
    if (direction) at.direction /= length;
    at.feed = feeds[k] / 60;
    at.working = works[k] != 0;
    at.dwell = dwells[k];
    for (const auto& [name, commands] : indexed) {
      if (!std::isfinite(commands[k])) {
        throw InputError({.field = "indexed_mm_rad"}, fmt::format("{} has {}", name, commands[k]), "finite numbers");
      }
      at.indexed.push_back(commands[k]);
    }
    result.curve.points.push_back(std::move(at));
  }
  return result;
}

std::string csv(const NamedCurve& self) {
  bool plain = self.curve.indexed.empty();
  for (const CurvePoint& point : self.curve.points) plain = plain && point.dwell == 0;
  if (!plain) {
    throw InputError({.field = "curve"}, "has axes set beforehand, or waits at a point",
                     "a curve of points, directions and feeds");
  }
  return curve_csv(self.curve);
}

struct PieceOfSizes {
  TestPiece piece;
  std::string name;
};

template <class Sizes>
PieceOfSizes made(Sizes sizes, double feed_mm_per_min, double chord_um, const char* name) {
  if (!(feed_mm_per_min >= 0.001 && feed_mm_per_min <= 1e6)) {
    throw InputError({.field = "feed_mm_per_min"}, fmt::format("is {}", feed_mm_per_min), "0.001 to 1000000");
  }
  if (!(chord_um >= 0.001 && chord_um <= 1000)) {
    throw InputError({.field = "chord_um"}, fmt::format("is {}", chord_um), "0.001 to 1000");
  }
  sizes.feed = feed_mm_per_min / 60;
  sizes.chord_tolerance = chord_um / 1000;
  return {computed([&] { return test_piece_of(sizes); }), name};
}

/// Sizes that are numbers; what else is wrong of them the library finds.
template <class Sizes>
Sizes finite(const Sizes& sizes, std::initializer_list<double> numbers) {
  for (const double number : numbers) {
    if (!std::isfinite(number)) throw InputError({.field = "sizes"}, fmt::format("{} among them", number), "numbers");
  }
  test_piece_of(sizes);
  return sizes;
}

ConeFrustum cone(double base_diameter, double height, double half_apex_deg, double inclination_deg, double azimuth_deg,
                 const Triple& centre, double tool_diameter) {
  ConeFrustum sizes;
  sizes.base_diameter = base_diameter;
  sizes.height = height;
  sizes.half_apex_angle = half_apex_deg * kDegree;
  sizes.inclination = inclination_deg * kDegree;
  sizes.lean_azimuth = azimuth_deg * kDegree;
  sizes.base_centre = vector(centre);
  sizes.tool_radius = tool_diameter / 2;
  return finite(sizes, {base_diameter, height, half_apex_deg, inclination_deg, azimuth_deg, centre[0], centre[1],
                        centre[2], tool_diameter});
}

SShape s_shape_of(double length, double amplitude, double height, double lean_deg, double twist_deg, double azimuth_deg,
                  const Triple& centre, double tool_diameter) {
  SShape sizes;
  sizes.length = length;
  sizes.amplitude = amplitude;
  sizes.height = height;
  sizes.lean = lean_deg * kDegree;
  sizes.twist = twist_deg * kDegree;
  sizes.azimuth = azimuth_deg * kDegree;
  sizes.centre = vector(centre);
  sizes.tool_radius = tool_diameter / 2;
  return finite(sizes, {length, amplitude, height, lean_deg, twist_deg, azimuth_deg, centre[0], centre[1], centre[2],
                        tool_diameter});
}

void bind_curve(nb::module_& module) {
  nb::class_<NamedCurve>(module, "Curve",
                         "A curve on the workpiece that a tool follows, with directions of the tool.\n\n"
                         ">>> import abbe\n"
                         ">>> curve = abbe.Curve([[0, 0, 0], [10, 0, 0]], feed_mm_per_min=600)\n"
                         ">>> len(curve), curve.working_runs()\n"
                         "(2, [(0, 1)])\n")
      .def(
          "__init__",
          [](NamedCurve* self, const ArrayLike& points, const std::optional<ArrayLike>& directions,
             const ArrayLike& feed, const std::optional<ArrayLike>& works, const ArrayLike& dwell,
             const std::map<std::string, std::vector<double>>& indexed, const std::string& file) {
            new (self) NamedCurve(curve_of(points, directions, feed, works, dwell, indexed, file));
          },
          nb::arg("points_mm"), nb::arg("directions") = nb::none(), nb::kw_only(), nb::arg("feed_mm_per_min") = 0.0,
          nb::arg("working") = nb::none(), nb::arg("dwell_s") = 0.0,
          nb::arg("indexed_mm_rad") = std::map<std::string, std::vector<double>>{}, nb::arg("file") = "curve",
          "points_mm [n, 3] in the workpiece frame. directions [n, 3] or [3]: from the functional point to the "
          "spindle;\nelse Z. feed_mm_per_min, working, dwell_s: one, or [n], on the way to each point and there. "
          "indexed_mm_rad:\n{'C2': [n] commands} of axes that are set beforehand. file: name for messages.")
      .def_static(
          "read",
          [](const std::filesystem::path& path, const Machine& machine) {
            return named(read_curve(path, machine), machine, path.string());
          },
          nb::arg("path"), nb::arg("machine"),
          "From a CSV or a program of straight moves (.ngc, .nc, .tap, .mpf): docs/tool-path.md.")
      .def_static(
          "parse",
          [](const std::string& text, const Machine& machine, bool program, const std::string& file) {
            return named(program ? parse_curve_program(text, file, machine) : parse_curve(text, file, machine), machine,
                         file);
          },
          nb::arg("text"), nb::arg("machine"), nb::kw_only(), nb::arg("program") = false, nb::arg("file") = "curve",
          "From the text of a CSV, or of a program.")
      .def_ro("file", &NamedCurve::file)
      .def_prop_ro(
          "points_mm", [](const NamedCurve& c) { return vectors_of_each(c.curve.points, &CurvePoint::point); },
          nb::sig("def points_mm(self) -> numpy.ndarray"), "[n, 3]")
      .def_prop_ro(
          "directions", [](const NamedCurve& c) { return vectors_of_each(c.curve.points, &CurvePoint::direction); },
          nb::sig("def directions(self) -> numpy.ndarray"), "[n, 3] from the functional point to the spindle.")
      .def_prop_ro(
          "feed_mm_per_min",
          [](const NamedCurve& c) {
            return numbers_of_each(c.curve.points, [](const CurvePoint& p) { return 60 * p.feed; });
          },
          nb::sig("def feed_mm_per_min(self) -> numpy.ndarray"), "[n] on the way to each point; 0: not stated.")
      .def_prop_ro(
          "dwell_s", [](const NamedCurve& c) { return numbers_of_each(c.curve.points, &CurvePoint::dwell); },
          nb::sig("def dwell_s(self) -> numpy.ndarray"), "[n]")
      .def_prop_ro(
          "working", [](const NamedCurve& c) { return flags_of_each(c.curve.points, &CurvePoint::working); },
          nb::sig("def working(self) -> numpy.ndarray"), "[n] whether the tool works on the way to each point.")
      .def_ro("indexed", &NamedCurve::indexed, "Names of axes that are set beforehand.")
      .def(
          "working_runs",
          [](const NamedCurve& c) {
            std::vector<std::pair<std::size_t, std::size_t>> runs;
            for (const WorkingRun& run : working_runs(c.curve)) runs.emplace_back(run.first, run.last);
            return runs;
          },
          "First and last points of the parts that the tool leaves on the workpiece, in order.")
      .def("csv", &csv, "Text of a CSV that read() takes. Raises InputError with indexed axes and dwells.")
      .def("__len__", [](const NamedCurve& c) { return c.curve.points.size(); })
      .def("__repr__",
           [](const NamedCurve& c) { return fmt::format("<abbe.Curve: {} points>", c.curve.points.size()); });
}

void bind_pieces(nb::module_& module) {
  nb::class_<PieceOfSizes>(module, "TestPiece",
                           "A ruled surface that the flank of an end mill mills in one cut, and the path of the tool.")
      .def_prop_ro(
          "curve",
          [](const PieceOfSizes& p) {
            return NamedCurve{p.piece.curve, {}, p.name};
          },
          "Path of the middle of the tool's end.")
      .def_prop_ro("tool_radius_mm", [](const PieceOfSizes& p) { return p.piece.tool_radius; })
      .def_prop_ro(
          "foot_mm", [](const PieceOfSizes& p) { return vectors_of_each(p.piece.rulings, &Ruling::foot); },
          nb::sig("def foot_mm(self) -> numpy.ndarray"), "[n, 3] lower ends of the rulings, workpiece frame.")
      .def_prop_ro(
          "head_mm", [](const PieceOfSizes& p) { return vectors_of_each(p.piece.rulings, &Ruling::head); },
          nb::sig("def head_mm(self) -> numpy.ndarray"), "[n, 3] upper ends.")
      .def_prop_ro(
          "foot_normals", [](const PieceOfSizes& p) { return vectors_of_each(p.piece.rulings, &Ruling::foot_normal); },
          nb::sig("def foot_normals(self) -> numpy.ndarray"), "[n, 3] out of the material.")
      .def_prop_ro(
          "head_normals", [](const PieceOfSizes& p) { return vectors_of_each(p.piece.rulings, &Ruling::head_normal); },
          nb::sig("def head_normals(self) -> numpy.ndarray"), "[n, 3] out of the material.")
      .def("__repr__", [](const PieceOfSizes& p) {
        return fmt::format("<abbe.TestPiece {}: {} points>", p.name, p.piece.curve.points.size());
      });
  nb::class_<ConeFrustum>(module, "ConeFrustum",
                          "Sizes of an inclined cone frustum, after ISO 10791-7 (M3) and NAS 979.\n\n"
                          ">>> import abbe\n"
                          ">>> len(abbe.ConeFrustum(height_mm=25).piece(chord_um=5).curve)\n"
                          "224\n")
      .def(
          "__init__",
          [](ConeFrustum* self, double base, double height, double half_apex, double inclination, double azimuth,
             const Triple& centre, double tool) {
            new (self) ConeFrustum(cone(base, height, half_apex, inclination, azimuth, centre, tool));
          },
          nb::kw_only(), nb::arg("base_diameter_mm") = 80.0, nb::arg("height_mm") = 20.0,
          nb::arg("half_apex_deg") = 15.0, nb::arg("inclination_deg") = 10.0, nb::arg("azimuth_deg") = 0.0,
          nb::arg("centre_mm") = Triple{0, 60, 40}, nb::arg("tool_diameter_mm") = 20.0,
          "centre_mm: of the base, workpiece frame. azimuth_deg: turn of the lean about Z. Raises InputError.")
      .def(
          "piece", [](const ConeFrustum& s, double feed, double chord) { return made(s, feed, chord, "cone frustum"); },
          nb::kw_only(), nb::arg("feed_mm_per_min") = 1200.0, nb::arg("chord_um") = 1.0,
          "The piece and its tool path, with points as dense as chord_um requires.")
      .def("__repr__", [](const ConeFrustum& s) {
        return fmt::format("<abbe.ConeFrustum: base {:g} mm, height {:g} mm>", s.base_diameter, s.height);
      });
  nb::class_<SShape>(module, "SShape",
                     "Sizes of a wall in the shape of an S, after ISO 10791-7 (M4).\n\n"
                     ">>> import abbe\n"
                     ">>> abbe.SShape().piece(chord_um=5)\n"
                     "<abbe.TestPiece S shape: 254 points>\n")
      .def(
          "__init__",
          [](SShape* self, double length, double amplitude, double height, double lean, double twist, double azimuth,
             const Triple& centre, double tool) {
            new (self) SShape(s_shape_of(length, amplitude, height, lean, twist, azimuth, centre, tool));
          },
          nb::kw_only(), nb::arg("length_mm") = 160.0, nb::arg("amplitude_mm") = 40.0, nb::arg("height_mm") = 40.0,
          nb::arg("lean_deg") = 5.0, nb::arg("twist_deg") = 15.0, nb::arg("azimuth_deg") = 0.0,
          nb::arg("centre_mm") = Triple{0, 0, 30}, nb::arg("tool_diameter_mm") = 20.0,
          "centre_mm: middle of the foot, workpiece frame. Raises InputError for sizes that make no wall.")
      .def(
          "piece", [](const SShape& s, double feed, double chord) { return made(s, feed, chord, "S shape"); },
          nb::kw_only(), nb::arg("feed_mm_per_min") = 1200.0, nb::arg("chord_um") = 1.0,
          "The piece and its tool path, with points as dense as chord_um requires.")
      .def("__repr__", [](const SShape& s) {
        return fmt::format("<abbe.SShape: length {:g} mm, height {:g} mm>", s.length, s.height);
      });
}

}  // namespace

Curve curve_on(const NamedCurve& curve, const Machine& machine) {
  Curve result = curve.curve;
  result.indexed = axis_indices(machine, curve.indexed);
  return result;
}

void bind_curves(nb::module_& module) {
  bind_curve(module);
  bind_pieces(module);
}

}  // namespace abbe::python
