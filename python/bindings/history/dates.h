#pragma once

// Days as Python and NumPy have them: datetime.date, datetime64[D].
#include <nanobind/stl/vector.h>

#include <utility>
#include <vector>

#include "abbe/history/machine_history.h"
#include "bindings/bindings.h"

namespace abbe::python {

/// A datetime.date, a numpy.datetime64 or a text such as "2026-03-02". Of a time, its day is taken.
struct DayArgument {
  nb::object source;
};

/// A list or an array of them.
struct DaysArgument {
  std::vector<DayArgument> days;
};

/// @throws InputError for a text that is no date, for NaT, and for a month or a year, whose day is not known
/// @param name  of the argument, for messages
Date day_of(const DayArgument& argument, const char* name);
std::vector<Date> days_of(const DaysArgument& arguments, const char* name);

/// A datetime.date.
nb::object python_date(Date date);
/// [n] datetime64[D].
nb::object array_of_days(const std::vector<Date>& dates);

}  // namespace abbe::python

namespace nanobind::detail {

template <>
struct type_caster<abbe::python::DayArgument> {
  NB_TYPE_CASTER(abbe::python::DayArgument, const_name("datetime.date | numpy.datetime64 | str"))
  bool from_python(handle source, std::uint32_t, cleanup_list*) noexcept {
    // Items of an array are made one by one, and nobody else holds them.
    value.source = borrow(source);
    return PyUnicode_Check(source.ptr()) != 0 || PyObject_HasAttrString(source.ptr(), "year") != 0 ||
           PyObject_HasAttrString(source.ptr(), "astype") != 0;
  }
};

template <>
struct type_caster<abbe::python::DaysArgument> {
  NB_TYPE_CASTER(abbe::python::DaysArgument,
                 const_name("collections.abc.Sequence[datetime.date | numpy.datetime64 | str] | numpy.ndarray"))
  bool from_python(handle source, std::uint32_t flags, cleanup_list* cleanup) noexcept {
    make_caster<std::vector<abbe::python::DayArgument>> items;
    if (!items.from_python(source, flags, cleanup)) return false;
    value.days = std::move(items.value);
    return true;
  }
};

}  // namespace nanobind::detail
