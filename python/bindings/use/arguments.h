#pragma once

// What the functions that use errors take and give back in the same way.
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "abbe/compensate/left_out_errors.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/machine/inverse_plan.h"
#include "abbe/machine/machine.h"
#include "abbe/verify/evaluations/statistics.h"
#include "bindings/arrays.h"
#include "bindings/machine_errors.h"

namespace abbe::python {

/// A position of every axis that is named, with its unit: {"X_mm": 100, "C_deg": 30}.
using AxisPositions = std::map<std::string, double>;
/// The same with a position, (from, to) or (from, to, count).
using AxisRanges = std::map<std::string, std::variant<double, std::vector<double>>>;

/// @throws InputError for a name that is no axis with a unit of its kind, numbers that are not finite, an axis given
///   twice. @param argument  for messages
std::vector<HeldAxis> axis_positions(const Machine& machine, const char* argument, const AxisPositions& positions);

/// [axes], empty where an axis is not named. @param with_count  (from, to, count), else (from, to)
std::vector<std::optional<AxisRange>> axis_ranges(const Machine& machine, const char* argument,
                                                  const AxisRanges& ranges, bool with_count);

/// A number from low to high, both included. @throws InputError
double number_within(const char* name, double value, double low, double high);

/// mm/s; 0 if none is given. @throws InputError for a feed that is not above zero
double feed_of(const std::optional<double>& feed_mm_per_min);

/// Words of axes in a program, {"C1": "C"}, as axis_words() checks them. @throws InputError
std::map<std::string, std::string> program_words(const Machine& machine,
                                                 const std::map<std::string, std::string>& words);

/// Index of an axis. @throws KeyError of Python
std::size_t axis_index(const Machine& machine, const std::string& name);
std::vector<std::size_t> axis_indices(const Machine& machine, const std::vector<std::string>& names);

/// Errors that are going to correct something: those that are marked as not to be trusted are refused, or warned of.
/// @throws InputError
void require_trusted(const MachineErrors& errors, bool accept_misfit, const std::string& file);

/// A text of the library with arguments of Python instead of options of the command: "--limit-um 5" -> "limit_um 5".
std::string argument_words(const std::string& text);
InputError with_argument_names(const InputError& error);

/// work(), whose messages name arguments of Python instead of options of the command.
template <class Work>
auto naming_arguments(const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    throw with_argument_names(error);
  }
}

/// The same without the GIL.
template <class Work>
auto computed(const Work& work) {
  const nb::gil_scoped_release release;
  return naming_arguments(work);
}

/// @throws InputError if there is a reason not to write a result
void refuse_to_write(const std::string& refused);

/// What Python makes of JSON of the library: dictionaries, lists, numbers.
nb::object python_value(const nlohmann::ordered_json& json);

/// Text that may have been read from a file in any encoding.
nb::object text_of_bytes(std::string_view bytes);
/// Bytes, or text in UTF-8. @throws InputError @param argument  for messages
std::string bytes_of_text(const nb::object& text, const char* argument);

nb::object array_of_ints(std::vector<int>&& values);
/// A copy of numbers as [n].
nb::object copied_array(const std::vector<double>& values);
/// [n, parts] of parts that are [n] each.
template <std::size_t N>
nb::object copied_columns(const std::array<std::vector<double>, N>& parts) {
  Columns<double> columns(N, parts[0].size());
  for (std::size_t p = 0; p < N; ++p) std::copy(parts[p].begin(), parts[p].end(), columns[p]);
  return columns.release({N}, false);
}
/// [poses, axes] of a list.
nb::object copied_poses(const PoseList& poses);

/// Numbers of an argument as rows, finite.
class Rows {
 public:
  /// @param name  of the argument  @param words  what each number is, for messages
  Rows(const ArrayLike& argument, const char* name, std::size_t width, const char* words);
  std::size_t count() const { return count_; }
  bool single() const { return array_.ndim() == 1; }
  /// Of a single row, for every k.
  double at(std::size_t k, std::size_t i) const {
    return array_.data()[static_cast<std::int64_t>(k) * row_step_ + static_cast<std::int64_t>(i) * step_];
  }

 private:
  Numbers array_;
  std::size_t count_ = 0;
  std::int64_t row_step_ = 0, step_ = 0;
};

/// A list of finite numbers. @throws InputError @param words  what they are, for messages
std::vector<double> number_list(const ArrayLike& argument, const char* name, const char* words);

}  // namespace abbe::python
