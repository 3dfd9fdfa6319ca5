#include "bindings/history/dates.h"

#include <fmt/format.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "abbe/formats/text/input_error.h"

namespace abbe::python {
namespace {

constexpr const char* kADay = "a datetime.date, a datetime64[D] or a text such as '2026-03-02'";

[[noreturn]] void refuse_day(const char* name, const nb::object& given, const char* problem) {
  throw InputError({.field = name}, fmt::format("{} {}", nb::str(given).c_str(), problem), kADay);
}

/// "2026-03-02" of a numpy.datetime64.
std::string numpy_day_text(const nb::object& given, const char* name) {
  const nb::object numpy = nb::module_::import_("numpy");
  const nb::object type = numpy.attr("datetime64");
  const auto is_missing = [&] { return PyObject_IsTrue(nb::object(numpy.attr("isnat")(given)).ptr()) != 0; };
  if (!nb::isinstance(given, type) || is_missing()) refuse_day(name, given, "is not a date");
  const nb::object unit = nb::object(numpy.attr("datetime_data")(given.attr("dtype")))[0];
  const auto unit_name = nb::cast<std::string>(unit);
  if (unit_name == "Y" || unit_name == "M" || unit_name == "W") refuse_day(name, given, "does not say which day");
  const nb::object day = given.attr("astype")("datetime64[D]");
  return nb::str(day).c_str();
}

}  // namespace

Date day_of(const DayArgument& argument, const char* name) {
  const nb::object& given = argument.source;
  if (PyUnicode_Check(given.ptr())) {
    std::string text;
    // Half a character, which is no UTF-8, cannot be shown either.
    if (!nb::try_cast(given, text)) throw InputError({.field = name}, "has a text that is not a date", kADay);
    return date_of(text, name);
  }
  if (!nb::hasattr(given, "year")) return date_of(numpy_day_text(given, name), name);
  // A datetime.date, and what derives from it. Pandas' missing time is one whose year is NaN.
  std::array<int, 3> numbers{};
  constexpr std::array<const char*, 3> kNames = {"year", "month", "day"};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!nb::hasattr(given, kNames[i]) || !nb::try_cast(nb::object(given.attr(kNames[i])), numbers[i])) {
      refuse_day(name, given, "is not a date");
    }
  }
  return date_of(fmt::format("{:04}-{:02}-{:02}", numbers[0], numbers[1], numbers[2]), name);
}

std::vector<Date> days_of(const DaysArgument& arguments, const char* name) {
  std::vector<Date> dates;
  dates.reserve(arguments.days.size());
  for (const DayArgument& argument : arguments.days) dates.push_back(day_of(argument, name));
  return dates;
}

nb::object python_date(Date date) {
  const std::chrono::year_month_day day(date);
  return nb::module_::import_("datetime")
      .attr("date")(static_cast<int>(day.year()), static_cast<unsigned>(day.month()), static_cast<unsigned>(day.day()));
}

nb::object array_of_days(const std::vector<Date>& dates) {
  auto kept = std::make_unique<std::vector<std::int64_t>>();
  for (const Date date : dates) kept->push_back(date.time_since_epoch().count());  // since 1970-01-01, as NumPy counts
  std::vector<std::int64_t>& days = *kept;
  const nb::capsule owner(kept.release(),
                          [](void* memory) noexcept { delete static_cast<std::vector<std::int64_t>*>(memory); });
  const nb::object numbers =
      nb::cast(nb::ndarray<nb::numpy, std::int64_t>(days.data(), {days.size()}, owner), nb::rv_policy::reference);
  return numbers.attr("view")("datetime64[D]");
}

}  // namespace abbe::python
