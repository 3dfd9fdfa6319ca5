#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <limits>
#include <memory>

#include "abbe/formats/files/text_file.h"
#include "abbe/runtime/abbe_runtime_states.h"
#include "abbe/study/compensation/frozen_errors.h"
#include "bindings/use/arguments.h"

namespace abbe::python {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// A frozen compensation with the bytes that it was made of.
struct Compensation {
  std::string bytes;
  std::unique_ptr<abbe_runtime, decltype(&abbe_runtime_free)> runtime{nullptr, &abbe_runtime_free};
  abbe_runtime_information about{};

  std::size_t axes() const { return static_cast<std::size_t>(about.axes); }
};

Compensation load(std::string bytes, const std::string& file) {
  Compensation result;
  std::array<char, 256> why{};
  abbe_runtime* handle = nullptr;
  if (abbe_runtime_load(bytes.data(), bytes.size(), why.data(), why.size(), &handle) != ABBE_OK) {
    throw InputError({.file = file}, why.data(), "a whole file of abbe.freeze(), of this version");
  }
  result.runtime.reset(handle);
  if (abbe_runtime_channels(handle) > 0) {
    throw InputError({.file = file, .field = "bytes"}, "the errors depend on states, which this class does not take",
                     "a compensation whose errors have no measured states");
  }
  abbe_runtime_describe(handle, &result.about);
  result.bytes = std::move(bytes);
  return result;
}

struct FrozenAxis {
  abbe_runtime_axis axis{};
  std::string name() const { return axis.letter + (axis.number > 0 ? std::to_string(axis.number) : std::string()); }
};

std::vector<FrozenAxis> axes_of(const Compensation& self) {
  std::vector<FrozenAxis> axes(self.axes());
  for (std::size_t i = 0; i < axes.size(); ++i) {
    abbe_runtime_describe_axis(self.runtime.get(), static_cast<int>(i), &axes[i].axis);
  }
  return axes;
}

/// What calls of the C interface said.
struct Outcome {
  std::vector<int> status;
  bool single = false;

  nb::object ints() const {
    if (single) return nb::int_(status[0]);
    return array_of_ints(std::vector<int>(status));
  }
  template <class Test>
  nb::object flags(const Test& test) const {
    if (single) return nb::bool_(test(status[0]));
    std::vector<std::uint8_t> values;
    values.reserve(status.size());
    for (const int one : status) values.push_back(test(one) ? 1 : 0);
    return array_of_bools(std::move(values));
  }
};

bool has_flag(int status, int flag) { return status >= 0 && (status & flag) != 0; }

/// Commands of axes.
struct FrozenCorrections : Outcome {
  nb::object positions_mm_rad;
  std::vector<int> iterations;
};

struct FrozenPoints : Outcome {
  nb::object points_mm, words_mm_rad;
};

struct FrozenUncertainties : Outcome {
  nb::object uncertainty_mm;
};

/// Where the tool is, of every call, or of all of them.
class Tools {
 public:
  Tools(const std::optional<ArrayLike>& tool, std::size_t poses) {
    if (!tool) return;
    rows_.emplace(*tool, "tool_mm", 3, "functional point from the gauge point, mm");
    if (!rows_->single() && rows_->count() != poses) {
      throw InputError({.field = "tool_mm"}, fmt::format("has {} rows", rows_->count()),
                       fmt::format("one tool, or one for each of {} poses", poses));
    }
  }
  const double* at(std::size_t k, double* memory) const {
    if (!rows_) return nullptr;
    for (std::size_t i = 0; i < 3; ++i) memory[i] = rows_->at(k, i);
    return memory;
  }

 private:
  std::optional<Rows> rows_;
};

void check_enable(double enable) {
  if (!(enable >= 0 && enable <= 1)) {
    throw InputError({.field = "enable"}, fmt::format("is {}", enable), "0 (nothing is compensated) to 1 (all errors)");
  }
}

/// Calls work(k, tool, state) for every pose on several threads, each block of poses with a state of its own.
template <class Work>
void for_poses(std::size_t count, const Tools& tools, const Work& work) {
  const auto block = [&](std::size_t first, std::size_t number) {
    abbe_runtime_state state;
    abbe_runtime_start(&state);
    std::array<double, 3> tool{};
    for (std::size_t k = first; k < first + number; ++k) work(k, tools.at(k, tool.data()), state);
  };
  if (count == 0) return;
  if (count == 1) return block(0, 1);
  const nb::gil_scoped_release release;
  for_each_block_of(count, block);
}

std::array<double, ABBE_RUNTIME_AXES> row_of(const Rows& rows, std::size_t k, std::size_t width) {
  std::array<double, ABBE_RUNTIME_AXES> values{};
  for (std::size_t i = 0; i < width; ++i) values[i] = rows.at(k, i);
  return values;
}

constexpr const char* kCommands = "a command for each axis, mm or rad";

using Corrector = decltype(&abbe_runtime_correct);

FrozenCorrections corrected(const Compensation& self, Corrector call, const ArrayLike& positions, const char* name,
                            const std::optional<ArrayLike>& tool, double enable) {
  check_enable(enable);
  const std::size_t axes = self.axes();
  const Rows rows(positions, name, axes, kCommands);
  const Tools tools(tool, rows.count());
  std::vector<double> out(rows.count() * axes, kUnknown);
  FrozenCorrections result;
  result.single = rows.single();
  result.status.resize(rows.count());
  result.iterations.resize(rows.count());
  for_poses(rows.count(), tools, [&](std::size_t k, const double* at, abbe_runtime_state& state) {
    const auto in = row_of(rows, k, axes);
    result.status[k] = call(self.runtime.get(), &state, in.data(), at, enable, out.data() + k * axes);
    result.iterations[k] = state.iterations;
  });
  result.positions_mm_rad =
      rows.single() ? array_of(std::move(out), {axes}) : array_of(std::move(out), {rows.count(), axes});
  return result;
}

FrozenCorrections joints_of_points(const Compensation& self, const ArrayLike& points, const ArrayLike& words,
                                   const std::optional<ArrayLike>& tool, double enable) {
  check_enable(enable);
  const std::size_t axes = self.axes();
  const Rows point(points, "points_mm", 3, "functional point in world coordinates, mm");
  const Rows word(words, "words_mm_rad", axes, "a command for each axis, mm or rad; those of solved axes are not read");
  if (!word.single() && word.count() != point.count()) {
    throw InputError({.field = "words_mm_rad"}, fmt::format("has {} rows", word.count()),
                     fmt::format("one row, or one for each of {} points", point.count()));
  }
  const Tools tools(tool, point.count());
  std::vector<double> out(point.count() * axes, kUnknown);
  FrozenCorrections result;
  result.single = point.single();
  result.status.resize(point.count());
  result.iterations.resize(point.count());
  for_poses(point.count(), tools, [&](std::size_t k, const double* at, abbe_runtime_state& state) {
    const auto in = row_of(point, k, 3), other = row_of(word, k, axes);
    result.status[k] =
        abbe_runtime_inverse(self.runtime.get(), &state, in.data(), other.data(), at, enable, out.data() + k * axes);
    result.iterations[k] = state.iterations;
  });
  result.positions_mm_rad =
      point.single() ? array_of(std::move(out), {axes}) : array_of(std::move(out), {point.count(), axes});
  return result;
}

FrozenPoints points_of_joints(const Compensation& self, const ArrayLike& joints, const std::optional<ArrayLike>& tool,
                              double enable) {
  check_enable(enable);
  const std::size_t axes = self.axes();
  const Rows rows(joints, "positions_mm_rad", axes, kCommands);
  const Tools tools(tool, rows.count());
  std::vector<double> points(rows.count() * 3, kUnknown), words(rows.count() * axes, kUnknown);
  FrozenPoints result;
  result.single = rows.single();
  result.status.resize(rows.count());
  for_poses(rows.count(), tools, [&](std::size_t k, const double* at, abbe_runtime_state& state) {
    const auto in = row_of(rows, k, axes);
    result.status[k] = abbe_runtime_forward(self.runtime.get(), &state, in.data(), at, enable, points.data() + 3 * k,
                                            words.data() + k * axes);
  });
  const bool single = rows.single();
  result.points_mm = single ? array_of(std::move(points), {3}) : array_of(std::move(points), {rows.count(), 3});
  result.words_mm_rad = single ? array_of(std::move(words), {axes}) : array_of(std::move(words), {rows.count(), axes});
  return result;
}

FrozenUncertainties frozen_uncertainties(const Compensation& self, const ArrayLike& positions,
                                         const std::optional<ArrayLike>& tool) {
  const Rows rows(positions, "positions_mm_rad", self.axes(), kCommands);
  const Tools tools(tool, rows.count());
  std::vector<double> out(rows.count(), kUnknown);
  FrozenUncertainties result;
  result.single = rows.single();
  result.status.resize(rows.count());
  for_poses(rows.count(), tools, [&](std::size_t k, const double* at, abbe_runtime_state&) {
    const auto in = row_of(rows, k, self.axes());
    result.status[k] = abbe_runtime_uncertainty(self.runtime.get(), in.data(), at, &out[k]);
  });
  if (rows.single()) {
    result.uncertainty_mm = nb::float_(out[0]);
  } else {
    result.uncertainty_mm = array_of(std::move(out), {rows.count()});
  }
  return result;
}

Triple tool_of_offset(const Compensation& self, const Triple& offset) {
  Triple tool{};
  for (const double value : offset) {
    if (!std::isfinite(value)) throw InputError({.field = "offset_mm"}, fmt::format("has {}", value), "three lengths");
  }
  abbe_runtime_tool_of_offset(self.runtime.get(), offset.data(), tool.data());
  return tool;
}

template <class Result>
nb::class_<Result> bind_outcome(nb::module_& module, const char* name, const char* words) {
  nb::class_<Result> bound(module, name, words);
  bound
      .def_prop_ro(
          "status", [](const Result& r) { return r.ints(); }, nb::sig("def status(self) -> numpy.ndarray | int"),
          "[n] results of the C interface (abbe_runtime.h); FrozenCompensation.status_text() puts one into words.")
      .def_prop_ro(
          "computed", [](const Result& r) { return r.flags([](int s) { return s >= 0; }); },
          nb::sig("def computed(self) -> numpy.ndarray | bool"),
          "[n] whether there is a result; NaN where there is "
          "none.")
      .def_prop_ro(
          "outside_map", [](const Result& r) { return r.flags([](int s) { return has_flag(s, ABBE_OUTSIDE_MAP); }); },
          nb::sig("def outside_map(self) -> numpy.ndarray | bool"),
          "[n] the errors are not known there: every axis keeps the errors of the end of its range.")
      .def_prop_ro(
          "outside_travel",
          [](const Result& r) { return r.flags([](int s) { return has_flag(s, ABBE_OUTSIDE_TRAVEL); }); },
          nb::sig("def outside_travel(self) -> numpy.ndarray | bool"), "[n] a joint lies beyond its travel.")
      .def_prop_ro(
          "outside_tool", [](const Result& r) { return r.flags([](int s) { return has_flag(s, ABBE_OUTSIDE_TOOL); }); },
          nb::sig("def outside_tool(self) -> numpy.ndarray | bool"),
          "[n] the tool is shorter or longer than the file was checked for.");
  return bound;
}

void bind_frozen_results(nb::module_& module) {
  bind_outcome<FrozenCorrections>(module, "FrozenCorrections", "Axis commands of a frozen compensation.")
      .def_ro("positions_mm_rad", &FrozenCorrections::positions_mm_rad,
              nb::sig("def positions_mm_rad(self) -> numpy.ndarray"), "[n, axes] commands, mm or rad.")
      .def_prop_ro(
          "reached",
          [](const FrozenCorrections& r) {
            return r.flags([](int s) { return s >= 0 && (s & ABBE_RESULT_MASK) != ABBE_POSITION_LEFT; });
          },
          nb::sig("def reached(self) -> numpy.ndarray | bool"), "[n] whether the point is where it is wanted.")
      .def_prop_ro(
          "iterations",
          [](const FrozenCorrections& r) -> nb::object {
            if (r.single) return nb::int_(r.iterations[0]);
            return array_of_ints(std::vector<int>(r.iterations));
          },
          nb::sig("def iterations(self) -> numpy.ndarray | int"), "[n] that each pose took.");
  bind_outcome<FrozenPoints>(module, "FrozenPoints", "Where the tool of a frozen compensation is.")
      .def_ro("points_mm", &FrozenPoints::points_mm, nb::sig("def points_mm(self) -> numpy.ndarray"),
              "[n, 3] functional point in world coordinates, mm.")
      .def_ro("words_mm_rad", &FrozenPoints::words_mm_rad, nb::sig("def words_mm_rad(self) -> numpy.ndarray"),
              "[n, axes] commands as programmed; of axes that are solved from the point their nominal joints.");
  bind_outcome<FrozenUncertainties>(module, "FrozenUncertainties",
                                    "Uncertainty of the corrections of a frozen compensation.")
      .def_ro("uncertainty_mm", &FrozenUncertainties::uncertainty_mm,
              nb::sig("def uncertainty_mm(self) -> numpy.ndarray | float"),
              "[n] standard uncertainty of the correction of the tool point, in the direction in which it is largest, "
              "mm;\nNaN where there is none.");
  nb::class_<FrozenAxis>(module, "FrozenAxis", "An axis of a frozen compensation.")
      .def_prop_ro("name", &FrozenAxis::name)
      .def_prop_ro(
          "kind", [](const FrozenAxis& a) { return a.axis.rotary != 0 ? "rotary" : "linear"; }, "'linear' or 'rotary'.")
      .def_prop_ro(
          "solved", [](const FrozenAxis& a) { return a.axis.solved != 0; },
          "Whether it is found from the point of the tool; else its word is its nominal joint.")
      .def_prop_ro("endless", [](const FrozenAxis& a) { return a.axis.endless != 0; })
      .def_prop_ro("travel_mm_rad", [](const FrozenAxis& a) { return std::pair(a.axis.travel_min, a.axis.travel_max); })
      .def_prop_ro(
          "map_mm_rad", [](const FrozenAxis& a) { return std::pair(a.axis.map_min, a.axis.map_max); },
          "From where to where the errors are known.")
      .def("__repr__", [](const FrozenAxis& a) { return fmt::format("<abbe.FrozenAxis {}>", a.name()); });
}

void bind_information(nb::class_<Compensation>& bound) {
  bound
      .def_prop_ro(
          "machine", [](const Compensation& c) { return c.about.machine; }, "Name of the machine.")
      .def_prop_ro(
          "version", [](const Compensation& c) { return c.about.version; }, "Of the program that made the file.")
      .def_prop_ro("checksum", [](const Compensation& c) { return c.about.checksum; })
      .def_prop_ro(
          "source_checksum", [](const Compensation& c) { return c.about.source_checksum; }, "Of machine and errors.")
      .def_prop_ro("axes", &axes_of, "The axes in the order of the chain.")
      .def_prop_ro(
          "tool_centre", [](const Compensation& c) { return c.about.tool_centre != 0; },
          "Whether inverse() and forward() work: the machine has three linear axes to take a point.")
      .def_prop_ro(
          "tool_mm",
          [](const Compensation& c) {
            return Triple{c.about.tool[0], c.about.tool[1], c.about.tool[2]};
          },
          "Tool of calls that give none: functional point from the gauge point, mm.")
      .def_prop_ro(
          "tool_length_mm",
          [](const Compensation& c) { return std::pair(c.about.tool_length_min, c.about.tool_length_max); },
          "Shortest and longest tool that the file was checked for, mm.")
      .def_prop_ro("largest_correction_mm", [](const Compensation& c) { return c.about.largest_correction_mm; })
      .def_prop_ro("largest_correction_rad", [](const Compensation& c) { return c.about.largest_correction_rad; })
      .def_prop_ro("accuracy_mm", [](const Compensation& c) { return c.about.accuracy_mm; })
      .def_prop_ro("accuracy_rad", [](const Compensation& c) { return c.about.accuracy_rad; })
      .def_prop_ro("worst_iterations", [](const Compensation& c) { return c.about.worst_iterations; })
      .def_prop_ro(
          "has_uncertainty", [](const Compensation& c) { return c.about.has_uncertainty != 0; },
          "Whether uncertainty() works: the errors that were frozen state theirs.")
      .def_prop_ro("largest_uncertainty_mm", [](const Compensation& c) { return c.about.largest_uncertainty_mm; })
      .def_prop_ro("mean_uncertainty_mm", [](const Compensation& c) { return c.about.mean_uncertainty_mm; })
      .def_prop_ro("uncertainty_lattice_mm", [](const Compensation& c) { return c.about.uncertainty_lattice_mm; })
      .def_prop_ro(
          "bytes", [](const Compensation& c) { return nb::bytes(c.bytes.data(), c.bytes.size()); }, "Of the file.");
}

}  // namespace

void bind_frozen_compensation(nb::module_& module) {
  bind_frozen_results(module);
  nb::class_<Compensation> bound(
      module, "FrozenCompensation",
      "What a control computes with a frozen compensation, for arrays of poses.\n\n"
      "Made of the bytes of FrozenErrors, or read from a file of `abbe compensate freeze`. Calls take [n, axes] or\n"
      "[axes], mm and rad in the order of the chain; tool_mm is the functional point from the gauge point, [3] or\n"
      "[n, 3], else that of the file; enable is the part of all errors that is compensated, 0 to 1. Blocks of poses\n"
      "are computed on several threads, without the GIL. Method: docs/runtime.md.\n\n"
      ">>> import abbe\n"
      ">>> mill = abbe.Machine.from_chain(\"w X' Y' b Z t\")\n"
      ">>> errors = abbe.Errors(mill)\n"
      ">>> errors.add_location('EC0Y', value_urad=20)\n"
      ">>> compensation = abbe.FrozenCompensation(abbe.freeze(errors).bytes)\n"
      ">>> joints = compensation([[100, 100, 0], [0, 200, 0]])\n"
      ">>> joints.positions_mm_rad.round(6).tolist()\n"
      "[[100.002, 100.0, 0.0], [0.004, 200.0, 0.0]]\n"
      ">>> compensation.status_text(joints.status[0])\n"
      "'ok'\n");
  const auto correct = [](const Compensation& self, const ArrayLike& nominal, const std::optional<ArrayLike>& tool,
                          double enable) {
    return corrected(self, &abbe_runtime_correct, nominal, "positions_mm_rad", tool, enable);
  };
  bound
      .def(
          "__init__",
          [](Compensation* self, const nb::bytes& bytes) {
            new (self) Compensation(load(std::string(bytes.c_str(), bytes.size()), ""));
          },
          nb::arg("bytes"), "Raises InputError for bytes that are no whole file of this version.")
      .def_static(
          "read", [](const std::filesystem::path& path) { return load(read_text_file(path), path.string()); },
          nb::arg("path"), "From a file (*.abbec).")
      .def("__call__", correct, nb::arg("positions_mm_rad"), nb::kw_only(), nb::arg("tool_mm") = nb::none(),
           nb::arg("enable") = 1.0, "The same as correct().")
      .def("correct", correct, nb::arg("positions_mm_rad"), nb::kw_only(), nb::arg("tool_mm") = nb::none(),
           nb::arg("enable") = 1.0,
           "Commands at which the actual tool is where the nominal machine has it at these nominal commands.")
      .def(
          "uncorrect",
          [](const Compensation& self, const ArrayLike& joints, const std::optional<ArrayLike>& tool, double enable) {
            return corrected(self, &abbe_runtime_uncorrect, joints, "positions_mm_rad", tool, enable);
          },
          nb::arg("positions_mm_rad"), nb::kw_only(), nb::arg("tool_mm") = nb::none(), nb::arg("enable") = 1.0,
          "The exact inverse of correct(): nominal commands from compensated ones.")
      .def("inverse", &joints_of_points, nb::arg("points_mm"), nb::arg("words_mm_rad"), nb::kw_only(),
           nb::arg("tool_mm") = nb::none(), nb::arg("enable") = 1.0,
           "Compensated commands for points of the tool in world coordinates, [n, 3].\n\n"
           "words_mm_rad: commands [n, axes] or [axes] of axes that are not solved from the point: rotary axes and\n"
           "further linear ones; those of the others are not read. With enable=0 the nominal machine.")
      .def("forward", &points_of_joints, nb::arg("positions_mm_rad"), nb::kw_only(), nb::arg("tool_mm") = nb::none(),
           nb::arg("enable") = 1.0, "The exact inverse of inverse(): points and words from compensated commands.")
      .def("uncertainty", &frozen_uncertainties, nb::arg("positions_mm_rad"), nb::kw_only(),
           nb::arg("tool_mm") = nb::none(),
           "Standard uncertainty of the whole correction of the tool point at nominal commands.\n\n"
           "From the uncertainties of the errors that were frozen (JCGM 100), linear between the nodes of a lattice.")
      .def("tool_of_offset", &tool_of_offset, nb::arg("offset_mm"),
           "tool_mm for a tool length offset of a control (G43): (0, 0, length) for a tool along Z.")
      .def_static(
          "status_text", [](int status) { return abbe_runtime_text(status); }, nb::arg("status"),
          "A status in words, with its gravest flag: 'outside the map'.")
      .def("__getstate__", [](const Compensation& self) { return nb::bytes(self.bytes.data(), self.bytes.size()); })
      .def("__setstate__",
           [](Compensation& self, const nb::bytes& bytes) {
             new (&self) Compensation(load(std::string(bytes.c_str(), bytes.size()), "pickled compensation"));
           })
      .def("__repr__", [](const Compensation& self) {
        return fmt::format("<abbe.FrozenCompensation of {}: {} axes, {} bytes>", self.about.machine, self.about.axes,
                           self.bytes.size());
      });
  bind_information(bound);
  nb::cast<nb::class_<FrozenErrors>>(module.attr("FrozenErrors"))
      .def(
          "compensation", [](const FrozenErrors& frozen) { return load(std::string(frozen.bytes()), ""); },
          "What a control computes with the file.");
}

}  // namespace abbe::python
