#pragma once

// Readings as files or as columns of numbers, and numbers with a unit in their name.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "abbe/formats/text/named_columns.h"
#include "abbe/formats/text/unit.h"
#include "bindings/use/arguments.h"

namespace abbe::python {

/// A path, or a dictionary or data frame of columns named as in a file.
struct ReadingsArgument {
  nb::handle source;
};

/// The name of a file.
struct ReadingsFile {
  std::filesystem::path path;
};
using GivenReadings = std::variant<ReadingsFile, NamedColumns>;

/// The path or the columns of an argument. @throws InputError if it is neither, or a column is not a list
GivenReadings given_readings(const ReadingsArgument& argument, const char* name = "readings");

/// The path of an argument, or nothing if it is an array.
std::optional<std::filesystem::path> path_of(nb::handle source);

/// Largest uncertainty of a length that makes sense, um.
inline constexpr double kMostUm = 1e6;

/// A number in the unit of its name, in the inside unit, as the command reads it. @throws InputError out of range
double quantity(const char* name, double value, Quantity quantity, const char* unit, double from, double to);

/// @throws InputError that names all the words that are known
[[noreturn]] void refuse_word(const char* name, const std::string& word, const std::vector<std::string>& known);

/// The value of a word. @throws InputError that names all words
template <class Value>
Value word_value(const char* name, const std::string& word, const std::map<std::string, Value>& values) {
  const auto found = values.find(word);
  if (found != values.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [other, value] : values) known.push_back(other);
  refuse_word(name, word, known);
}

/// The entry whose option of the command has this name as an argument: "--u-x-um" is "u_x_um".
/// @throws InputError that names them all
template <class Entries>
const auto& entry_named(const char* name, const std::string& word, const Entries& entries) {
  std::vector<std::string> known;
  for (const auto& entry : entries) {
    known.push_back(argument_words(entry.option));
    if (known.back() == word) return entry;
  }
  refuse_word(name, word, known);
}

/// The C++ object of a Python object, whose memory arrays show. @throws TypeError of Python  __new__ made it, but
/// __init__ never ran
template <class Object>
const Object& initialised(nb::handle_t<Object> self) {
  if (!nb::inst_ready(self)) throw nb::type_error("the object was never initialised");
  return *nb::inst_ptr<Object>(self);
}

}  // namespace abbe::python

namespace nanobind::detail {

template <>
struct type_caster<abbe::python::ReadingsArgument> {
  NB_TYPE_CASTER(abbe::python::ReadingsArgument,
                 const_name("str | os.PathLike | collections.abc.Mapping[str, numpy.typing.ArrayLike] | "
                            "pandas.DataFrame"))
  bool from_python(handle source, std::uint32_t, cleanup_list*) noexcept {
    value.source = source;
    return !source.is_none();
  }
};

}  // namespace nanobind::detail
