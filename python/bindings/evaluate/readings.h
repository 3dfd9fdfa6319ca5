#pragma once

// Readings as files or as columns of numbers, and numbers with a unit in their name.
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <variant>

#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/formats/text/named_columns.h"
#include "abbe/formats/text/unit.h"
#include "bindings/arrays.h"

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

/// Takes the argument apart. @throws InputError for what is neither, and for columns that are no lists
GivenReadings given_readings(const ReadingsArgument& argument, const char* name = "readings");

/// A path, or points [n, 3].
struct PointsArgument {
  nb::handle source;
};

/// Points of a program as a file of them would be read. @throws InputError for another shape, numbers that are not
///   finite or larger than a file may have
PointCloudFile points_of_array(const ArrayLike& points, const char* name,
                               const std::optional<ArrayLike>& normals = std::nullopt);
/// The path of an argument, or nothing if it is an array.
std::optional<std::filesystem::path> path_of(nb::handle source);

/// A number in the unit of its name, as the command reads it. @throws InputError outside of the range
double quantity(const char* name, double value, Quantity quantity, const char* unit, double from, double to);

/// Index of a word in a list. @throws InputError that names them all
std::size_t word_index(const char* name, const std::string& word, std::initializer_list<const char*> words);

/// The object of Python as one of C++ that owns what arrays show. @throws TypeError of Python  it was made by __new__
/// only
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

template <>
struct type_caster<abbe::python::PointsArgument> {
  NB_TYPE_CASTER(abbe::python::PointsArgument, const_name("str | os.PathLike | numpy.typing.ArrayLike | PointCloud"))
  bool from_python(handle source, std::uint32_t, cleanup_list*) noexcept {
    value.source = source;
    return !source.is_none();
  }
};

}  // namespace nanobind::detail
