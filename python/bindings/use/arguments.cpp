#include "bindings/use/arguments.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/nc/path_program.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/report/evaluations/partial_errors.h"

namespace abbe::python {
namespace {

struct NamedAxis {
  std::size_t axis = 0;
  double unit = 1;
};

/// "X_mm", "C_deg" or "C_rad".
NamedAxis named_axis(const Machine& machine, const char* argument, const std::string& key) {
  const std::size_t underscore = key.rfind('_');
  if (underscore != std::string::npos) {
    const std::size_t axis = machine.find_axis(key.substr(0, underscore));
    const std::string unit = key.substr(underscore + 1);
    if (axis != Machine::npos) {
      const Axis& found = machine.axes[axis];
      if (unit == position_suffix(found)) return {axis, position_unit(found)};
      if (unit == "rad" && found.kind == AxisKind::rotary) return {axis, 1};
    }
  }
  std::vector<std::string> names;
  for (const Axis& axis : machine.axes) names.push_back(axis.name + "_" + position_suffix(axis));
  throw InputError({.field = argument}, fmt::format("'{}' is no axis of the machine with its unit", key),
                   fmt::format("{}", fmt::join(names, ", ")));
}

double finite(const char* argument, const std::string& key, double value) {
  if (!std::isfinite(value)) throw InputError({.field = argument}, fmt::format("{} is {}", key, value), "a number");
  return value;
}

AxisRange range_of(const char* argument, const std::string& key, const std::vector<double>& numbers, double unit,
                   bool with_count) {
  const auto fail = [&](const char* expected) {
    throw InputError({.field = argument}, fmt::format("{} has {} numbers", key, numbers.size()), expected);
  };
  for (const double number : numbers) finite(argument, key, number);
  if (numbers.size() == 1) return AxisRange::fixed(numbers[0] * unit);
  if (!with_count) {
    if (numbers.size() != 2 || !(numbers[0] < numbers[1])) fail("a position, or (smaller, larger) position");
    return {numbers[0] * unit, numbers[1] * unit, 2, 0};
  }
  constexpr const char* kExpected = "a position, or (from, to, count) with a count from 2 to 1,000,000";
  if (numbers.size() != 3) fail(kExpected);
  if (!(numbers[2] >= 2 && numbers[2] <= 1e6) || numbers[2] != std::floor(numbers[2])) {
    throw InputError({.field = argument}, fmt::format("{} has a count of {}", key, numbers[2]), kExpected);
  }
  return {numbers[0] * unit, numbers[1] * unit, static_cast<std::size_t>(numbers[2]), 0};
}

void once(const Machine& machine, const char* argument, std::vector<bool>& given, std::size_t axis) {
  if (given[axis]) throw InputError({.field = argument}, "axis " + machine.axes[axis].name + " is there twice");
  given[axis] = true;
}

}  // namespace

std::vector<HeldAxis> axis_positions(const Machine& machine, const char* argument, const AxisPositions& positions) {
  std::vector<HeldAxis> result;
  std::vector<bool> given(machine.axes.size());
  for (const auto& [key, position] : positions) {
    const NamedAxis named = named_axis(machine, argument, key);
    once(machine, argument, given, named.axis);
    result.push_back({named.axis, finite(argument, key, position) * named.unit});
  }
  return result;
}

std::vector<std::optional<AxisRange>> axis_ranges(const Machine& machine, const char* argument,
                                                  const AxisRanges& ranges, bool with_count) {
  std::vector<std::optional<AxisRange>> result(machine.axes.size());
  std::vector<bool> given(machine.axes.size());
  for (const auto& [key, value] : ranges) {
    const NamedAxis named = named_axis(machine, argument, key);
    once(machine, argument, given, named.axis);
    const double* const position = std::get_if<double>(&value);
    const std::vector<double> numbers = position ? std::vector<double>{*position} : std::get<1>(value);
    result[named.axis] = range_of(argument, key, numbers, named.unit, with_count);
  }
  return result;
}

double number_within(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return value;
  throw InputError({.field = name}, fmt::format("is {}", value), fmt::format("{} to {}", low, high));
}

double feed_of(const std::optional<double>& feed_mm_per_min) {
  if (!feed_mm_per_min) return 0;
  if (*feed_mm_per_min > 0 && std::isfinite(*feed_mm_per_min)) return *feed_mm_per_min / 60;
  throw InputError({.field = "feed_mm_per_min"}, fmt::format("is {}", *feed_mm_per_min), "above zero");
}

std::map<std::string, std::string> program_words(const Machine& machine,
                                                 const std::map<std::string, std::string>& words) {
  std::vector<std::string> texts;
  for (const auto& [axis, word] : words) texts.push_back(axis + "=" + word);
  return axis_words(machine, texts, "words");
}

std::size_t axis_index(const Machine& machine, const std::string& name) {
  const std::size_t axis = machine.find_axis(name);
  if (axis == Machine::npos) throw nb::key_error(fmt::format("no axis '{}' in {}", name, machine.chain()).c_str());
  return axis;
}

std::vector<std::size_t> axis_indices(const Machine& machine, const std::vector<std::string>& names) {
  std::vector<std::size_t> axes;
  for (const std::string& name : names) axes.push_back(axis_index(machine, name));
  return axes;
}

void require_trusted(const MachineErrors& errors, bool accept_misfit, const std::string& file) {
  naming_arguments([&] { abbe::require_trusted(errors.file, file, accept_misfit); });
  for (const std::string& reason : errors.file.distrusted) {
    const std::string text = fmt::format("{}: used although marked as not to be trusted: {}", file, reason);
    if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw nb::python_error();
  }
}

std::string argument_words(const std::string& text) {
  std::string words;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool starts_word = i == 0 || text[i - 1] == ' ' || text[i - 1] == '(';
    const bool is_option = text.compare(i, 2, "--") == 0 && i + 2 < text.size() &&
                           std::islower(static_cast<unsigned char>(text[i + 2])) != 0;
    if (!starts_word || !is_option) {
      words += text[i];
      continue;
    }
    std::string name;
    const auto belongs = [](char c) {
      return c == '-' || std::islower(static_cast<unsigned char>(c)) != 0 ||
             std::isdigit(static_cast<unsigned char>(c)) != 0;
    };
    for (i += 2; i < text.size() && belongs(text[i]); ++i) {
      name += text[i] == '-' ? '_' : text[i];
    }
    --i;
    words += name == "for" ? "format" : name == "word" ? "words" : name == "as" ? "kind" : name;
  }
  return words;
}

InputError with_argument_names(const InputError& error) {
  InputError::Place place = error.place();
  place.field = argument_words(place.field);
  return {place, argument_words(error.problem()), argument_words(error.expected())};
}

void refuse_to_write(const std::string& refused) {
  if (!refused.empty()) throw InputError({.field = "refused"}, refused + "; nothing is written");
}

nb::object python_value(const nlohmann::ordered_json& json) {
  const std::string text = json_text(json);
  return nb::module_::import_("json").attr("loads")(nb::str(text.c_str(), text.size()));
}

nb::object text_of_bytes(std::string_view bytes) {
  PyObject* const text = PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "surrogateescape");
  if (!text) throw nb::python_error();
  return nb::steal(text);
}

std::string bytes_of_text(const nb::object& text, const char* argument) {
  if (PyBytes_Check(text.ptr())) {
    return {PyBytes_AS_STRING(text.ptr()), static_cast<std::size_t>(PyBytes_GET_SIZE(text.ptr()))};
  }
  if (!PyUnicode_Check(text.ptr())) {
    throw InputError({.field = argument}, fmt::format("is of type {}", nb::type_name(text.type()).c_str()),
                     "text or bytes");
  }
  const nb::object bytes = nb::steal(PyUnicode_AsEncodedString(text.ptr(), "utf-8", "surrogateescape"));
  if (!bytes.is_valid()) throw nb::python_error();
  return bytes_of_text(bytes, argument);
}

nb::object array_of_ints(std::vector<int>&& values) {
  auto* kept = new std::vector<int>(std::move(values));
  nb::capsule owner(kept, [](void* memory) noexcept { delete static_cast<std::vector<int>*>(memory); });
  return nb::cast(nb::ndarray<nb::numpy, int>(kept->data(), {kept->size()}, owner), nb::rv_policy::reference);
}

nb::object copied_array(const std::vector<double>& values) {
  return array_of(std::vector<double>(values), {values.size()});
}

nb::object copied_poses(const PoseList& poses) {
  Columns<double> columns(poses.axis.size(), poses.count());
  for (std::size_t i = 0; i < poses.axis.size(); ++i) {
    std::copy(poses.axis[i].begin(), poses.axis[i].end(), columns[i]);
  }
  return columns.release({poses.axis.size()}, false);
}

Rows::Rows(const ArrayLike& argument, const char* name, std::size_t width, const char* words)
    : array_(argument.numbers(name)) {
  if ((array_.ndim() != 1 && array_.ndim() != 2) || array_.shape(array_.ndim() - 1) != width) {
    throw InputError({.field = name}, "has another shape", fmt::format("shape ({0},) or (n, {0}): {1}", width, words));
  }
  step_ = array_.stride(array_.ndim() - 1);
  count_ = single() ? 1 : array_.shape(0);
  row_step_ = single() ? 0 : array_.stride(0);
  for (std::size_t k = 0; k < count_; ++k) {
    for (std::size_t i = 0; i < width; ++i) {
      if (std::isfinite(at(k, i))) continue;
      throw InputError({.field = name}, fmt::format("row {}, number {}: {}", k, i, at(k, i)), "finite numbers");
    }
  }
}

std::vector<double> number_list(const ArrayLike& argument, const char* name, const char* words) {
  const Numbers array = argument.numbers(name);
  if (array.ndim() != 1) throw InputError({.field = name}, "has another shape", fmt::format("shape (n,): {}", words));
  std::vector<double> values;
  for (std::size_t k = 0; k < array.shape(0); ++k) {
    values.push_back(array.data()[static_cast<std::int64_t>(k) * array.stride(0)]);
    if (!std::isfinite(values.back())) {
      throw InputError({.field = name}, fmt::format("number {} is {}", k, values.back()), "finite numbers");
    }
  }
  return values;
}

void bind_use_arguments(nb::module_& module) {
  if (!nb::type<SampleStatistics>().is_valid()) {
    nb::class_<SampleStatistics>(module, "Statistics",
                                 "Summary of a sample, in the unit that the name of the attribute with it ends in.")
        .def_ro("count", &SampleStatistics::count, "Values used.")
        .def_ro("excluded", &SampleStatistics::excluded, "Values left out: outside the range that is known.")
        .def_ro("mean", &SampleStatistics::mean)
        .def_ro("rms", &SampleStatistics::rms, "Root mean square about zero.")
        .def_ro("deviation", &SampleStatistics::deviation, "Sample standard deviation about the mean.")
        .def_ro("minimum", &SampleStatistics::minimum)
        .def_ro("maximum", &SampleStatistics::maximum)
        .def_ro("maximum_at", &SampleStatistics::maximum_at, "Index of the maximum in the sample.")
        .def_ro("median", &SampleStatistics::median)
        .def_ro("p90", &SampleStatistics::p90)
        .def_ro("p95", &SampleStatistics::p95)
        .def_ro("p99", &SampleStatistics::p99)
        .def("__repr__", [](const SampleStatistics& s) {
          return fmt::format("<abbe.Statistics of {}: mean {:.6g}, p95 {:.6g}, maximum {:.6g}>", s.count, s.mean, s.p95,
                             s.maximum);
        });
  }
  if (!nb::type<LeftOutErrors>().is_valid()) {
    nb::class_<LeftOutErrors>(module, "LeftOutErrors", "Errors that are smaller than their uncertainty.")
        .def_ro("names", &LeftOutErrors::names, "Those that were left out.")
        .def_ro("kept", &LeftOutErrors::kept, "Small against their own uncertainty, but not together with others.")
        .def_ro("largest_shift_mm", &LeftOutErrors::largest_shift,
                "Of the functional point by what is left out, over the travel, mm.")
        .def_prop_ro(
            "where_mm_rad", [](const LeftOutErrors& errors) { return copied_array(errors.where); },
            nb::sig("def where_mm_rad(self) -> numpy.ndarray"), "[axes] commands there; empty if nothing is left out.")
        .def("__repr__", [](const LeftOutErrors& errors) {
          return fmt::format("<abbe.LeftOutErrors: {}>", fmt::join(errors.names, ", "));
        });
  }
  if (!nb::type<PartialErrors>().is_valid()) {
    nb::class_<PartialErrors>(module, "PartialErrors",
                              "How many of the errors that move the tool of a machine an errors file states.")
        .def_ro("known", &PartialErrors::known, "Error motions and location errors that are stated.")
        .def_ro("missing", &PartialErrors::missing, "Names of the others; they are taken as zero.")
        .def_prop_ro("is_partial", &PartialErrors::is_partial)
        .def_prop_ro(
            "caution", [](const PartialErrors& errors) { return errors.is_partial() ? errors.caution() : ""; },
            "A sentence that names what is missing; empty if nothing is.")
        .def("__repr__",
             [](const PartialErrors& errors) { return fmt::format("<abbe.PartialErrors: {}>", errors.short_words()); });
  }
}

}  // namespace abbe::python
