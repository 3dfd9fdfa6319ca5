#include "bindings/use/program_result.h"

#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <nlohmann/json.hpp>

#include "bindings/files.h"

namespace abbe::python {
namespace {

/// A place with its number of axes and what is known of its uncertainty.
struct Place {
  ProgramPlace place;
  std::size_t axes = 0;
  std::optional<double> uncertainty;
};

struct Count {
  StatusCount count;
};

ProgramWordsRequest words_request(const ProgramResult& result, const std::optional<std::string>& output) {
  const std::string file = output.value_or(result.output);
  return {.program = result.program_file,
          .output = file,
          .tolerance_um = result.tolerance_um,
          .leave_out_factor = result.leave_out_factor,
          .dry_run = file.empty()};
}

std::optional<Place> place_of(const ProgramResult& result, const ProgramPlace& place,
                              std::optional<double> uncertainty) {
  if (place.line == 0) return std::nullopt;
  return Place{place, result.machine.axes.size(), uncertainty};
}

std::optional<Place> largest_shift(const ProgramResult& result) {
  const PlaceUncertainty& known = result.corrected.largest;
  return place_of(result, result.corrected.report.largest_shift,
                  known.stated ? std::optional(known.point) : std::nullopt);
}

std::map<std::string, Place> by_axis(const ProgramResult& result) {
  std::map<std::string, Place> places;
  for (std::size_t i = 0; i < result.machine.axes.size(); ++i) {
    const PlaceUncertainty& known = result.corrected.by_axis[i];
    const auto place = place_of(result, result.corrected.report.by_axis[i],
                                known.axes_known ? std::optional(known.axis[i]) : std::nullopt);
    if (place) places.emplace(result.machine.axes[i].name, *place);
  }
  return places;
}

std::map<std::string, Count> statuses(const ProgramResult& result) {
  std::map<std::string, Count> counts;
  for (std::size_t i = 1; i < kCorrectionStatuses; ++i) {
    const StatusCount& count = result.corrected.report.status[i];
    if (count.count > 0) counts[correction_status_text(static_cast<CorrectionStatus>(i))] = {count};
  }
  return counts;
}

template <std::size_t N>
nb::object first_of(const std::array<double, N>& values, std::size_t count) {
  return copied_array({values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count)});
}

template <class Get>
void count_attribute(nb::class_<ProgramResult>& bound, const char* name, const Get& get, const char* words) {
  bound.def_prop_ro(
      name, [get](const ProgramResult& r) { return Count{get(r.corrected.report)}; }, words);
}

void bind_counts(nb::class_<ProgramResult>& bound) {
  using Report = ProgramReport;
  count_attribute(
      bound, "held_at_travel", [](const Report& r) { return r.held_at_travel; },
      "Ends of rapid moves that were kept at the end of a travel.");
  count_attribute(
      bound, "held_starts", [](const Report& r) { return r.held_starts; },
      "Moves at work that begin where a rapid move was kept at the end of a travel.");
  count_attribute(
      bound, "bent_with_spindle", [](const Report& r) { return r.bent_with_spindle; },
      "Moves with the spindle, which are not split, whose path leaves the tolerance.");
  count_attribute(
      bound, "play_with_spindle", [](const Report& r) { return r.play_with_spindle; },
      "Moves with the spindle in which axes with reversal values turn round.");
  count_attribute(
      bound, "not_proven", [](const Report& r) { return r.not_proven; },
      "Moves whose path could not be shown to stay within the tolerance.");
  count_attribute(
      bound, "tool_changes", [](const Report& r) { return r.tool_changes; },
      "Moves that begin where the machine stood with another tool length.");
  count_attribute(
      bound, "inverse_time", [](const Report& r) { return r.inverse_time; },
      "Pieces whose duration needs inverse time.");
  count_attribute(
      bound, "above_limit", [](const Report& r) { return r.above_limit; },
      "Ends where the correction of the point is above the limit.");
}

void bind_parts(nb::module_& module) {
  nb::class_<Place>(module, "ProgramPlace", "Where in a program a figure is largest.")
      .def_prop_ro(
          "value_mm_rad", [](const Place& p) { return p.place.value; }, "The figure, mm or rad.")
      .def_ro("uncertainty_mm_rad", &Place::uncertainty, "Its standard uncertainty (JCGM 100); None: not stated.")
      .def_prop_ro(
          "line", [](const Place& p) { return p.place.line; }, "Of the program, from 1.")
      .def_prop_ro(
          "position_mm_rad", [](const Place& p) { return first_of(p.place.position, p.axes); },
          nb::sig("def position_mm_rad(self) -> numpy.ndarray"), "[axes] commands as programmed.")
      .def_prop_ro(
          "corrected_mm_rad", [](const Place& p) { return first_of(p.place.corrected, p.axes); },
          nb::sig("def corrected_mm_rad(self) -> numpy.ndarray"),
          "[axes] commands that reach the same with the errors.")
      .def_prop_ro(
          "tool_length_mm", [](const Place& p) { return p.place.tool_length; }, "In force there, x y z, mm.")
      .def_prop_ro("status", [](const Place& p) { return correction_status_text(p.place.status); })
      .def("__repr__", [](const Place& p) {
        return fmt::format("<abbe.ProgramPlace: {:.6g} in line {}>", p.place.value, p.place.line);
      });
  nb::class_<Count>(module, "ProgramCount", "How often something is in a program, and where first.")
      .def_prop_ro("count", [](const Count& c) { return c.count.count; })
      .def_prop_ro(
          "first_lines",
          [](const Count& c) {
            std::vector<std::size_t> lines;
            for (const std::size_t line : c.count.line) {
              if (line > 0) lines.push_back(line);
            }
            return lines;
          },
          "Lines of the program, at most five.")
      .def("__repr__", [](const Count& c) { return fmt::format("<abbe.ProgramCount: {}>", c.count.count); });
}

void write_program(const ProgramResult& result, const std::filesystem::path& path, bool overwrite) {
  std::string refused;
  for (const std::string& reason : result.corrected.refused) refused += (refused.empty() ? "" : "; ") + reason;
  refuse_to_write(argument_words(refused));
  if (!result.text) {
    throw InputError({.field = "program"}, "the text is not here", "correct_program(), or an output for the file");
  }
  write_text(path, *result.text, overwrite);
}

}  // namespace

void bind_program_result(nb::module_& module) {
  bind_parts(module);
  nb::class_<ProgramResult> bound(
      module, "CorrectedProgram",
      "A corrected NC program, and what was done to it. Made by correct_program() and correct_program_file().");
  bound
      .def_prop_ro(
          "program", [](const ProgramResult& r) -> nb::object { return r.text ? text_of_bytes(*r.text) : nb::none(); },
          nb::sig("def program(self) -> str | None"),
          "Text of the corrected program; None where it is refused, or is in a file. Bytes that are no UTF-8 are kept\n"
          "as surrogates (errors='surrogateescape').")
      .def_prop_ro(
          "refused",
          [](const ProgramResult& r) {
            std::vector<std::string> reasons;
            for (const std::string& reason : r.corrected.refused) reasons.push_back(argument_words(reason));
            return reasons;
          },
          "Why the program must not be used, a sentence each; empty: it may be.")
      .def_ro("machine", &ProgramResult::machine)
      .def_prop_ro(
          "lines", [](const ProgramResult& r) { return r.corrected.text.lines; }, "That were run.")
      .def_prop_ro("moves", [](const ProgramResult& r) { return r.corrected.report.moves; })
      .def_prop_ro("pieces", [](const ProgramResult& r) { return r.corrected.report.pieces; })
      .def_prop_ro("split_moves", [](const ProgramResult& r) { return r.corrected.report.split_moves; })
      .def_prop_ro("largest_shift", &largest_shift, "Of the functional point by the correction; None: no move.")
      .def_prop_ro("by_axis", &by_axis, "Largest change of the commands of each axis.")
      .def_prop_ro(
          "largest_orientation_left",
          [](const ProgramResult& r) { return place_of(r, r.corrected.report.largest_orientation_left, std::nullopt); },
          "Of the tool direction, where the machine cannot turn it; None: nowhere.")
      .def_prop_ro("statuses", &statuses, "Ends of moves and pieces by the status of their correction.")
      .def_prop_ro(
          "uncorrected_moves", [](const ProgramResult& r) { return r.corrected.text.uncorrected_moves; },
          "Rapid moves that were not corrected, because some axis was not yet where the program had sent it.")
      .def_prop_ro(
          "left_out", [](const ProgramResult& r) { return r.corrected.left_out; },
          "Errors below their uncertainty, which are not corrected.")
      .def(
          "text",
          [](const ProgramResult& r, const std::optional<std::string>& output) {
            return program_text(words_request(r, output), r.machine, r.corrected);
          },
          nb::arg("output") = nb::none(),
          "What `abbe compensate gcode` prints. output: name of the file that is written; without one of a dry run.")
      .def(
          "to_dict",
          [](const ProgramResult& r, const std::optional<std::string>& output) {
            return python_value(program_json(words_request(r, output), r.machine, r.corrected));
          },
          nb::arg("output") = nb::none(),
          nb::sig("def to_dict(self, output: str | None = None) -> dict[str, typing.Any]"),
          "The same as `abbe compensate gcode --json`.")
      .def("write", &write_program, nb::arg("path"), nb::arg("overwrite") = false,
           "Writes the program, whole or not at all. Raises InputError if it is refused.")
      .def("__repr__", [](const ProgramResult& r) {
        return fmt::format("<abbe.CorrectedProgram: {} moves, {} pieces, largest correction {:.3f} um{}>",
                           r.corrected.report.moves, r.corrected.report.pieces,
                           1e3 * r.corrected.report.largest_shift.value,
                           r.corrected.refused.empty() ? "" : ", refused");
      });
  bind_counts(bound);
}

}  // namespace abbe::python
