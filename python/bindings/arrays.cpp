#include "bindings/arrays.h"

#include <fmt/format.h>
#include <sys/mman.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe::python {
namespace {

[[noreturn]] void refuse(const char* name, const std::string& problem, const std::string& expected) {
  throw InputError({.field = name}, problem, expected);
}

/// Whether all numbers are finite: x - x is zero unless x is infinite or NaN.
bool all_finite(const double* values, std::size_t count) {
  const Eigen::Map<const Eigen::ArrayXd> x(values, static_cast<Eigen::Index>(count));
  return (x - x).sum() == 0;
}

std::string shape_words(const Numbers& array) {
  std::string words = "(";
  for (std::size_t i = 0; i < array.ndim(); ++i) words += fmt::format("{}{}", i == 0 ? "" : ", ", array.shape(i));
  return words + (array.ndim() == 1 ? ",)" : ")");
}

}  // namespace

Numbers ArrayLike::numbers(const char* name) const {
  Numbers array;
  if (array.take(source)) return array;
  try {
    // Lists, other types of numbers, data frames. What is not safe, such as texts and complex numbers, is refused.
    const nb::object given = nb::module_::import_("numpy").attr("asarray")(source);
    const nb::object converted = given.attr("astype")("float64", nb::arg("casting") = "same_kind");
    if (array.take(converted)) return array;
  } catch (nb::python_error& error) {
    if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError)) throw;
    const nb::str words(error.value());
    refuse(name, fmt::format("is no array of numbers ({})", words.c_str()), "numbers that float64 can hold");
  }
  refuse(name, "is no array of numbers", "numbers that float64 can hold");
}

Positions::Positions(const ArrayLike& argument, const Machine& machine, const char* name)
    : array_(argument.numbers(name)), machine_(machine), name_(name), axes_(machine.axes.size()) {
  if ((array_.ndim() != 1 && array_.ndim() != 2) || array_.shape(array_.ndim() - 1) != axes_) {
    refuse(name, "has the shape " + shape_words(array_), expected());
  }
  count_ = single() ? 1 : array_.shape(0);
  axis_step_ = array_.stride(array_.ndim() - 1);
  pose_step_ = single() ? 1 : array_.stride(0);
  if (count_ > kBlock) return;
  for (std::size_t i = 0; i < axes_; ++i) {
    for (std::size_t k = 0; k < count_; ++k) {
      if (!std::isfinite(*column(i, k))) refuse_what_is_not_finite();
    }
  }
}

std::string Positions::expected() const {
  return fmt::format("shape ({},) or (n, {}): a command for each axis of {}, in mm or rad", axes_, axes_,
                     machine_.chain());
}

void Positions::refuse_what_is_not_finite() const {
  for (std::size_t i = 0; i < axes_; ++i) {
    for (std::size_t k = 0; k < count_; ++k) {
      const double value = *column(i, k);
      if (!std::isfinite(value)) {
        refuse(name_, fmt::format("pose {}, axis {}: {}", k, machine_.axes[i].name, value), "finite numbers");
      }
    }
  }
  refuse(name_, "was changed during the call", "an array that is not written to meanwhile");
}

PositionArrays Positions::block(std::size_t first, std::size_t count, Block& memory) const {
  // The columns are not a power of two apart, so that they do not compete for the same cache lines.
  const std::size_t column_step = std::min(count_, kBlock) + 8;
  if (!columns_are_contiguous()) memory.values.resize(axes_ * column_step);
  for (std::size_t i = 0; i < axes_; ++i) {
    const double* from = column(i, first);
    memory.axis[i] = from;
    if (columns_are_contiguous()) continue;
    double* to = memory.values.data() + i * column_step;
    memory.axis[i] = to;
    for (std::size_t k = 0; k < count; ++k, from += pose_step_) to[k] = *from;
  }
  for (std::size_t i = 0; i < axes_ && count_ > kBlock; ++i) {
    if (!all_finite(memory.axis[i], count)) refuse_what_is_not_finite();
  }
  return {{memory.axis.data(), axes_}, count};
}

bool Positions::overlaps(const double* memory, std::size_t size) const {
  if (count_ == 0) return false;
  const double *first = array_.data(), *last = first;
  const auto widen = [&](std::int64_t step, std::size_t count) {
    (step < 0 ? first : last) += step * static_cast<std::int64_t>(count - 1);
  };
  widen(axis_step_, axes_);
  widen(pose_step_, count_);
  return memory <= last && first < memory + size;
}

PoseList Positions::list() const {
  PoseList list;
  list.axis.assign(axes_, std::vector<double>(count_));
  for (std::size_t i = 0; i < axes_; ++i) {
    for (std::size_t k = 0; k < count_; ++k) list.axis[i][k] = *column(i, k);
    if (!all_finite(list.axis[i].data(), count_)) refuse_what_is_not_finite();
  }
  return list;
}

void for_each_block_of(std::size_t count, const std::function<void(std::size_t first, std::size_t count)>& work) {
  // Blocks of several thousand poses share a task, so that handing them out costs nothing.
  constexpr std::size_t kTask = 16 * Positions::kBlock;
  const auto task = [&](std::size_t index) {
    const std::size_t end = std::min(count, (index + 1) * kTask);
    for (std::size_t first = index * kTask; first < end; first += Positions::kBlock) {
      work(first, std::min(Positions::kBlock, end - first));
    }
  };
  const std::size_t tasks = (count + kTask - 1) / kTask;
  if (tasks == 1) {
    task(0);
  } else {
    for_each_block(tasks, 0, task);
  }
}

template <class Number>
Columns<Number>::Columns(std::size_t parts, std::size_t count) : parts_(parts), count_(count), few_{} {
  if (parts * count <= kFew) {
    data_ = few_.data();
    return;
  }
  // Large arrays are fresh memory each time. In pages of 4 KiB, making them takes as long as computing what goes in.
  constexpr std::size_t kHugePage = std::size_t{1} << 21, kLine = 64;
  const std::size_t bytes = parts * count * sizeof(Number);
  const std::size_t alignment = bytes >= kHugePage / 4 ? kHugePage : kLine;
  const std::size_t whole = (bytes + alignment - 1) / alignment * alignment;
  data_ = static_cast<Number*>(std::aligned_alloc(alignment, whole));
  if (!data_) throw std::bad_alloc();
  // To its end: a large page that is not wholly advised would become 512 small ones.
  if (alignment == kHugePage) madvise(data_, whole, MADV_HUGEPAGE);
}

template <class Number>
Columns<Number>::~Columns() {
  if (!few()) std::free(data_);
}

template <class Number>
nb::object Columns<Number>::release(std::initializer_list<std::size_t> shape, bool single) {
  return release_as(std::is_same_v<Number, double> ? NumberType::float64 : NumberType::uint8, shape, single);
}

template <class Number>
nb::object Columns<Number>::release_bools() {
  static_assert(sizeof(bool) == 1);
  return release_as(NumberType::bool8, {}, false);
}

template <class Number>
nb::object Columns<Number>::release_as(NumberType type, std::initializer_list<std::size_t> shape, bool single) {
  std::array<std::size_t, 4> sizes{};
  std::array<std::int64_t, 4> steps{};
  std::size_t dimensions = 0;
  if (!single) {
    sizes[dimensions] = count_;
    steps[dimensions++] = 1;
  }
  std::size_t step = parts_;
  for (const std::size_t size : shape) {
    step /= size;
    sizes[dimensions] = size;
    steps[dimensions++] = static_cast<std::int64_t>(step * count_);
  }
  const std::span<const std::size_t> all_sizes(sizes.data(), dimensions);
  const std::span<const std::int64_t> all_steps(steps.data(), dimensions);
  if (few()) {
    nb::object array = new_array(type, all_sizes, all_steps);
    std::copy_n(data_, parts_ * count_, static_cast<Number*>(array_data(array)));
    return array;
  }
  const nb::capsule owner(data_, [](void* memory) noexcept { std::free(memory); });
  return new_array(type, all_sizes, all_steps, std::exchange(data_, nullptr), owner);
}

template class Columns<double>;
template class Columns<std::uint8_t>;

namespace {

template <class Number>
nb::object array_of_vector(NumberType type, std::vector<Number>&& values, std::span<const std::size_t> shape) {
  constexpr std::size_t kCopied = 1024;  // bytes, up to which a copy costs less than memory of its own
  if (values.size() * sizeof(Number) <= kCopied) {
    nb::object array = new_array(type, shape, {});
    std::copy(values.begin(), values.end(), static_cast<Number*>(array_data(array)));
    return array;
  }
  auto kept = std::make_unique<std::vector<Number>>(std::move(values));
  const nb::capsule owner(kept.get(), [](void* memory) noexcept { delete static_cast<std::vector<Number>*>(memory); });
  return new_array(type, shape, {}, kept.release()->data(), owner);
}

}  // namespace

nb::object array_of(std::vector<double>&& values, std::initializer_list<std::size_t> shape) {
  return array_of_vector(NumberType::float64, std::move(values), {shape.begin(), shape.size()});
}

nb::object array_of(std::vector<std::uint8_t>&& values) {
  const std::size_t count = values.size();
  return array_of_vector(NumberType::uint8, std::move(values), {&count, 1});
}

nb::object array_of_bools(std::vector<std::uint8_t>&& values) {
  const std::size_t count = values.size();
  return array_of_vector(NumberType::bool8, std::move(values), {&count, 1});
}

}  // namespace abbe::python
