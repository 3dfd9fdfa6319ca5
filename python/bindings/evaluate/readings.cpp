#include "bindings/evaluate/readings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <utility>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "bindings/use/arguments.h"

namespace abbe::python {
namespace {

/// Texts of an array of them, or nothing if it holds something else.
std::optional<std::vector<std::string>> words_of(const nb::object& array) {
  const std::string kind = nb::cast<std::string>(nb::str(array.attr("dtype").attr("kind")));
  if (kind != "U" && kind != "O") return std::nullopt;
  std::vector<std::string> words;
  for (const nb::handle item : nb::list(array)) {
    std::string word;
    if (!nb::try_cast(item, word, false)) return std::nullopt;
    words.push_back(std::move(word));
  }
  return words;
}

NamedColumn column_of(const std::string& name, nb::handle values) {
  nb::object array;
  try {
    array = nb::module_::import_("numpy").attr("asarray")(values);
  } catch (nb::python_error& error) {
    if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError)) throw;
    throw InputError({.field = name}, "is not a column", "one number or text for each reading");
  }
  if (nb::cast<int>(array.attr("ndim")) != 1) {
    throw InputError({.field = name}, "has another shape", "shape (n,): one number or text for each reading");
  }
  if (std::optional<std::vector<std::string>> words = words_of(array)) return {name, std::move(*words)};
  const Numbers numbers = ArrayLike{array}.numbers(name.c_str());
  std::vector<double> copied(numbers.shape(0));
  for (std::size_t k = 0; k < copied.size(); ++k) {
    copied[k] = numbers.data()[static_cast<std::int64_t>(k) * numbers.stride(0)];
  }
  return {name, std::move(copied)};
}

}  // namespace

std::optional<std::filesystem::path> path_of(nb::handle source) {
  if (!PyUnicode_Check(source.ptr()) && !nb::hasattr(source, "__fspath__")) return std::nullopt;
  std::filesystem::path path;
  if (!nb::try_cast(source, path)) return std::nullopt;
  return path;
}

GivenReadings given_readings(const ReadingsArgument& argument, const char* name) {
  if (std::optional<std::filesystem::path> path = path_of(argument.source)) return ReadingsFile{std::move(*path)};
  constexpr const char* kExpected = "a path, or a dictionary or data frame of columns: {'deviation_um': ...}";
  if (!nb::hasattr(argument.source, "items") || PyType_Check(argument.source.ptr())) {
    throw InputError({.field = name}, fmt::format("is of type {}", nb::type_name(argument.source.type()).c_str()),
                     kExpected);
  }
  NamedColumns columns;
  for (const nb::handle item : argument.source.attr("items")()) {
    const auto entry = nb::cast<std::pair<nb::object, nb::object>>(item);
    std::string column;
    if (!nb::try_cast(entry.first, column, false)) {
      throw InputError({.field = name}, "the name of a column is not text", kExpected);
    }
    columns.push_back(column_of(column, entry.second));
  }
  return columns;
}

double quantity(const char* name, double value, Quantity quantity, const char* unit, double from, double to) {
  double inside = 0;
  if (!(value >= from && value <= to) ||
      parse_quantity(shortest_text(value), unit_named(quantity, unit), inside) != NumberProblem::none) {
    throw InputError({.field = name}, fmt::format("is {}", value),
                     fmt::format("{} in {} from {:g} to {:g}", quantity_words(quantity), unit, from, to));
  }
  return inside;
}

void refuse_word(const char* name, const std::string& word, const std::vector<std::string>& known) {
  throw InputError({.field = name}, fmt::format("'{}' is not known", word.substr(0, 60)),
                   fmt::format("{}", fmt::join(known, ", ")));
}

}  // namespace abbe::python
