#include "bindings/arrays.h"

#include <fmt/format.h>
#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe::python {
namespace {

[[noreturn]] void refuse(const char* name, const std::string& problem, const std::string& expected) {
  throw InputError({.field = name}, problem, expected);
}

std::string shape_words(const Numbers& array) {
  std::string words = "(";
  for (std::size_t i = 0; i < array.ndim(); ++i) words += fmt::format("{}{}", i == 0 ? "" : ", ", array.shape(i));
  return words + (array.ndim() == 1 ? ",)" : ")");
}

}  // namespace

Numbers ArrayLike::numbers(const char* name) const {
  Numbers array;
  if (nb::try_cast<Numbers>(source, array, false)) return array;
  try {
    // Lists, other types of numbers, data frames. What is not safe, such as texts and complex numbers, is refused.
    const nb::object given = nb::module_::import_("numpy").attr("asarray")(source);
    const nb::object converted = given.attr("astype")("float64", nb::arg("casting") = "same_kind");
    if (nb::try_cast<Numbers>(converted, array, false)) return array;
  } catch (nb::python_error& error) {
    if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError)) throw;
    const nb::str words(error.value());
    refuse(name, fmt::format("is no array of numbers ({})", words.c_str()), "numbers that float64 can hold");
  }
  refuse(name, "is no array of numbers", "numbers that float64 can hold");
}

Positions::Positions(const ArrayLike& argument, const Machine& machine, const char* name)
    : array_(argument.numbers(name)), axes_(machine.axes.size()) {
  const std::string expected =
      fmt::format("shape ({},) or (n, {}): a command for each axis of {}, in mm or rad", axes_, axes_, machine.chain());
  if (array_.ndim() != 1 && array_.ndim() != 2) refuse(name, "has the shape " + shape_words(array_), expected);
  if (array_.shape(array_.ndim() - 1) != axes_) refuse(name, "has the shape " + shape_words(array_), expected);
  count_ = single() ? 1 : array_.shape(0);
  axis_step_ = array_.stride(array_.ndim() - 1);
  pose_step_ = single() ? 1 : array_.stride(0);
  const double* values = array_.data();
  for (std::size_t i = 0; i < axes_; ++i) {
    const double* column = values + static_cast<std::int64_t>(i) * axis_step_;
    for (std::size_t k = 0; k < count_; ++k) {
      if (std::isfinite(column[static_cast<std::int64_t>(k) * pose_step_])) continue;
      refuse(name,
             fmt::format("pose {}, axis {}: {}", k, machine.axes[i].name,
                         column[static_cast<std::int64_t>(k) * pose_step_]),
             "finite numbers");
    }
  }
}

PositionArrays Positions::block(std::size_t first, std::size_t count, Block& memory) const {
  const double* values = array_.data() + static_cast<std::int64_t>(first) * pose_step_;
  if (columns_are_contiguous()) {
    for (std::size_t i = 0; i < axes_; ++i) memory.axis[i] = values + static_cast<std::int64_t>(i) * axis_step_;
    return {{memory.axis.data(), axes_}, count};
  }
  memory.values.resize(axes_ * kBlock);
  for (std::size_t i = 0; i < axes_; ++i) memory.axis[i] = memory.values.data() + i * kBlock;
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t i = 0; i < axes_; ++i) {
      memory.values[i * kBlock + k] =
          values[static_cast<std::int64_t>(k) * pose_step_ + static_cast<std::int64_t>(i) * axis_step_];
    }
  }
  return {{memory.axis.data(), axes_}, count};
}

PoseList Positions::list() const {
  PoseList list;
  list.axis.assign(axes_, std::vector<double>(count_));
  for (std::size_t i = 0; i < axes_; ++i) {
    for (std::size_t k = 0; k < count_; ++k) {
      list.axis[i][k] =
          array_.data()[static_cast<std::int64_t>(k) * pose_step_ + static_cast<std::int64_t>(i) * axis_step_];
    }
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
Columns<Number>::Columns(std::size_t parts, std::size_t count) : parts_(parts), count_(count) {
  // Large arrays are fresh memory each time. In pages of 4 KiB, making them takes as long as computing what goes in.
  constexpr std::size_t kHugePage = std::size_t{1} << 21, kLine = 64;
  const std::size_t bytes = parts * count * sizeof(Number);
  const std::size_t alignment = bytes >= 2 * kHugePage ? kHugePage : kLine;
  data_ = static_cast<Number*>(
      std::aligned_alloc(alignment, std::max(alignment, (bytes + alignment - 1) / alignment * alignment)));
  if (!data_) throw std::bad_alloc();
  if (alignment == kHugePage) madvise(data_, bytes, MADV_HUGEPAGE);
}

template <class Number>
Columns<Number>::~Columns() {
  std::free(data_);
}

template <class Number>
nb::object Columns<Number>::release(std::initializer_list<std::size_t> shape, bool single) {
  nb::capsule owner(data_, [](void* memory) noexcept { std::free(memory); });
  Number* data = std::exchange(data_, nullptr);
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
  return nb::cast(nb::ndarray<nb::numpy, Number>(data, dimensions, sizes.data(), owner, steps.data()),
                  nb::rv_policy::reference);
}

template class Columns<double>;
template class Columns<std::uint8_t>;

namespace {

template <class Number>
nb::object array_of_vector(std::vector<Number>&& values, std::initializer_list<std::size_t> shape) {
  auto* kept = new std::vector<Number>(std::move(values));
  nb::capsule owner(kept, [](void* memory) noexcept { delete static_cast<std::vector<Number>*>(memory); });
  return nb::cast(nb::ndarray<nb::numpy, Number>(kept->data(), shape, owner), nb::rv_policy::reference);
}

}  // namespace

nb::object array_of(std::vector<double>&& values, std::initializer_list<std::size_t> shape) {
  return array_of_vector(std::move(values), shape);
}

nb::object array_of(std::vector<std::uint8_t>&& values) {
  const std::size_t count = values.size();
  return array_of_vector(std::move(values), {count});
}

nb::object array_of_bools(std::vector<std::uint8_t>&& values) {
  return array_of(std::move(values)).attr("view")("bool");
}

}  // namespace abbe::python
