#include "bindings/study/compared_parts.h"

#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "abbe/study/comparison/compared_campaigns.h"
#include "bindings/arrays.h"
#include "bindings/tables.h"
#include "bindings/use/arguments.h"

namespace abbe::python {
namespace {

using NumberPair = std::pair<double, double>;

/// What there is only for an error that both campaigns have identified.
template <class Value>
std::optional<Value> if_comparable(const ComparedError& error, const Value& value) {
  if (!is_comparable(error.verdict)) return std::nullopt;
  return value;
}

/// What there is only for such an error if it is a function.
template <class Value>
std::optional<Value> if_motion(const ComparedError& error, const Value& value) {
  if (!error.is_motion) return std::nullopt;
  return if_comparable(error, value);
}

std::optional<double> if_judged(const ComparedError& error, double probability) {
  if (!error.chi_square) return std::nullopt;
  return probability;
}

nb::object array_if_any(const std::vector<double>& values) {
  if (values.empty()) return nb::none();
  return copied_array(values);
}

const ComparedError& error_named(const ComparedPair& pair, const std::string& name) {
  for (const ComparedError& error : pair.errors) {
    if (error.name == name) return error;
  }
  throw nb::key_error(fmt::format("there is no error '{}' to compare", name).c_str());
}

void bind_compared_curve(nb::module_& module) {
  using Curve = ComparedCurve;
  const auto uncertainty = nb::sig("def u_first_mm_rad(self) -> numpy.ndarray | None");
  nb::class_<Curve>(module, "ComparedCurve",
                    "An error motion of two campaigns over the range that both know, [n] each; mm or rad.\n\n"
                    "Both are in the same gauge, in the functions that both campaigns can describe.")
      .def_prop_ro(
          "positions_mm_rad", [](const Curve& c) { return copied_array(c.position); },
          nb::sig("def positions_mm_rad(self) -> numpy.ndarray"), "[n] of the axis.")
      .def_prop_ro(
          "first_mm_rad", [](const Curve& c) { return copied_array(c.first); },
          nb::sig("def first_mm_rad(self) -> numpy.ndarray"), "[n] in the earlier campaign.")
      .def_prop_ro(
          "second_mm_rad", [](const Curve& c) { return copied_array(c.second); },
          nb::sig("def second_mm_rad(self) -> numpy.ndarray"), "[n] in the later campaign.")
      .def_prop_ro(
          "change_mm_rad", [](const Curve& c) { return copied_array(c.change); },
          nb::sig("def change_mm_rad(self) -> numpy.ndarray"), "[n] later minus earlier.")
      .def_prop_ro(
          "u_first_mm_rad", [](const Curve& c) { return array_if_any(c.u_first); }, uncertainty,
          "[n] standard uncertainty; None: not stated.")
      .def_prop_ro(
          "u_second_mm_rad", [](const Curve& c) { return array_if_any(c.u_second); },
          nb::sig("def u_second_mm_rad(self) -> numpy.ndarray | None"), "[n] likewise.")
      .def_prop_ro(
          "u_change_mm_rad", [](const Curve& c) { return array_if_any(c.u_change); },
          nb::sig("def u_change_mm_rad(self) -> numpy.ndarray | None"), "[n] likewise, from both.")
      .def("__len__", [](const Curve& c) { return c.position.size(); })
      .def("__repr__",
           [](const Curve& c) { return fmt::format("<abbe.ComparedCurve: {} positions>", c.position.size()); });
}

void bind_error(nb::module_& module) {
  using Error = ComparedError;
  nb::class_<Error>(module, "ComparedError",
                    "The change of one error from the earlier to the later campaign of a pair; mm or rad.\n\n"
                    "Without a change that can be stated (see verdict), numbers are None.")
      .def_ro("name", &Error::name, "'EXX', 'EC0Y', 'reversal_X', 'tool_offset'.")
      .def_ro("words", &Error::words, "Such as 'positioning error motion of X'.")
      .def_ro("is_angle", &Error::is_angle, "Whether numbers are in rad; else in mm.")
      .def_ro("is_motion", &Error::is_motion, "Whether it is a function of the position of its axis.")
      .def_prop_ro(
          "verdict", [](const Error& e) { return change_verdict_name(e.verdict); },
          "'changed', 'not_significant', 'not_known' (no uncertainty is stated); 'partly_set', 'only_first',\n"
          "'only_second' or 'by_convention': conventions set it, or a part of it, and there is no change to be stated.")
      .def_prop_ro(
          "change_mm_rad", [](const Error& e) { return if_comparable(e, e.change); },
          "Later minus earlier, where its amount is largest; of the tool offset, the length of the change.")
      .def_prop_ro(
          "expanded_uncertainty_mm_rad", [](const Error& e) { return e.expanded_uncertainty; },
          "Of the change at this position, k = 2; None: not stated.")
      .def_prop_ro(
          "values_mm_rad", [](const Error& e) { return if_comparable(e, NumberPair(e.value[0], e.value[1])); },
          "Of the earlier and the later campaign there.")
      .def_prop_ro(
          "at_mm_rad", [](const Error& e) { return if_motion(e, e.at); },
          "Position of the axis there, mm or rad; None: it is no function.")
      .def_prop_ro(
          "range_mm_rad", [](const Error& e) { return if_motion(e, NumberPair(e.from, e.to)); },
          "Range of the axis in which both campaigns know it; None: it is no function.")
      .def_prop_ro(
          "only_described_mm_rad", [](const Error& e) { return if_motion(e, NumberPair(e.beyond[0], e.beyond[1])); },
          "Largest amount in the earlier and the later campaign that the functions of the other cannot describe, "
          "which\n"
          "is left out; None: it is no function.")
      .def_ro("chi_square", &Error::chi_square, "Of the whole function; None: not judged.")
      .def_prop_ro(
          "degrees_of_freedom",
          [](const Error& e) { return e.chi_square ? std::optional<std::size_t>(e.rank) : std::nullopt; },
          "Of chi_square.")
      .def_prop_ro(
          "probability", [](const Error& e) { return if_judged(e, e.probability); },
          "Of a larger chi-square without a change.")
      .def_prop_ro(
          "adjusted_probability", [](const Error& e) { return if_judged(e, e.adjusted); },
          "The same after Holm's procedure over the errors of the pair: changed where it is at most the level.")
      .def_prop_ro(
          "at_tool_mm", [](const Error& e) { return if_comparable(e, e.at_tool); },
          "Largest displacement of the functional point if nothing else had changed, mm.")
      .def_prop_ro(
          "curve", [](const Error& e) { return e.curve.position.empty() ? nullptr : &e.curve; },
          nb::rv_policy::reference_internal, nb::sig("def curve(self) -> ComparedCurve | None"),
          "Over the range; None: it is no function, cannot be compared, or page=False was given.")
      .def("__repr__", [](const Error& e) {
        if (!is_comparable(e.verdict))
          return fmt::format("<abbe.ComparedError {}: {}>", e.name, change_verdict_name(e.verdict));
        return fmt::format("<abbe.ComparedError {}: {:.3f} {}, {}>", e.name, (e.is_angle ? 1e6 : 1e3) * e.change,
                           e.is_angle ? "urad" : "um", change_verdict_name(e.verdict));
      });
}

std::vector<std::string> changed_names(const ComparedPair& pair) {
  std::vector<std::string> names;
  for (const ComparedError& error : pair.errors) {
    if (error.verdict == ChangeVerdict::changed) names.push_back(error.name);
  }
  return names;
}

/// There are errors that can be compared.
bool has_map(const ComparedPair& pair) { return pair.stated.poses.count() > 0; }

void bind_pair(nb::module_& module) {
  using Pair = ComparedPair;
  nb::class_<Pair> bound(module, "ComparedPair",
                         "A later campaign against an earlier one.\n\n"
                         "pair['EXX'] is the error of that name; to_dataframe() has all of them.");
  add_tables(bound, "changes_frame", nullptr);
  bound.def_ro("first", &Pair::first, "Index of the earlier campaign.")
      .def_ro("second", &Pair::second, "Index of the later campaign.")
      .def_ro("errors", &Pair::errors, "That are in both, each a ComparedError.")
      .def("__getitem__", &error_named, nb::arg("name"), nb::rv_policy::reference_internal,
           "The error of that name. Raises KeyError.")
      .def_prop_ro("changed", &changed_names, "Names of the errors that changed significantly.")
      .def_ro("only_first", &Pair::only_first, "Names of errors that only the earlier campaign has.")
      .def_ro("only_second", &Pair::only_second, "Names of errors that only the later campaign has.")
      .def_ro("no_range_in_common", &Pair::apart, "Names of error motions that are known in different ranges.")
      .def_ro("conventions", &Pair::conventions, "That were set for both, because one campaign knows no better.")
      .def_ro("partial", &Pair::partial, "What moves the tool and is not in both.")
      .def_ro("tools_differ", &Pair::tools_differ, "Then tool offset errors are not compared.")
      .def_ro("chi_square", &Pair::chi_square,
              "Of all judged errors together; None: nothing is judged, or the campaigns differ in their gauge.")
      .def_prop_ro(
          "degrees_of_freedom",
          [](const Pair& p) { return p.chi_square ? std::optional<std::size_t>(p.rank) : std::nullopt; },
          "Of chi_square.")
      .def_prop_ro(
          "probability",
          [](const Pair& p) { return p.chi_square ? std::optional<double>(p.probability) : std::nullopt; },
          "Of a larger chi-square of all together without a change.")
      .def_prop_ro(
          "positions_mm_rad", [](const Pair& p) { return has_map(p) ? copied_poses(p.stated.poses) : nb::none(); },
          nb::sig("def positions_mm_rad(self) -> numpy.ndarray | None"),
          "[n, axes] commands of the map; None: there is no error to compare.")
      .def_prop_ro(
          "grid", [](const Pair& p) { return p.stated.grid; }, "Positions per axis, the last axis varies fastest.")
      .def_prop_ro(
          "poses_words", [](const Pair& p) { return p.stated.words; }, "The poses in words.")
      .def_prop_ro(
          "change", [](const Pair& p) { return has_map(p) ? &p.change : nullptr; }, nb::rv_policy::reference_internal,
          nb::sig("def change(self) -> ErrorMap | None"),
          "Map of the change of the displacement after the best fit of the datum; None: there is no error to compare.")
      .def_prop_ro(
          "expanded_uncertainty_mm", [](const Pair& p) { return array_if_any(p.expanded); },
          nb::sig("def expanded_uncertainty_mm(self) -> numpy.ndarray | None"),
          "[n] of the length of the change, 2 sqrt(u_x^2 + u_y^2 + u_z^2), mm; None: not stated.")
      .def_ro("share", &Pair::share, "Share of the poses where the change is larger than that; None: not stated.")
      .def("__repr__", [](const Pair& p) {
        return fmt::format("<abbe.ComparedPair {} - {}: {} of {} errors changed>", p.second, p.first,
                           p.count(ChangeVerdict::changed), p.errors.size());
      });
}

}  // namespace

void bind_compared_parts(nb::module_& module) {
  bind_compared_curve(module);
  bind_error(module);
  bind_pair(module);
}

}  // namespace abbe::python
