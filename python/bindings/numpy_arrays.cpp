#include "bindings/numpy_arrays.h"

#define NPY_NO_DEPRECATED_API NPY_1_23_API_VERSION
#define NPY_TARGET_VERSION NPY_1_23_API_VERSION
#include <numpy/arrayobject.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <type_traits>

namespace abbe::python {
namespace {

constexpr std::size_t kMostDimensions = 4;

int number_of(NumberType type) {
  switch (type) {
    case NumberType::bool8:
      return NPY_BOOL;
    case NumberType::uint8:
      return NPY_UBYTE;
    case NumberType::float64:
      break;
  }
  return NPY_DOUBLE;
}

PyArrayObject* numpy_array(nb::handle source) { return reinterpret_cast<PyArrayObject*>(source.ptr()); }

/// Whether it is an array of that type in the processor's byte order, at aligned addresses.
bool is_array_of(nb::handle source, NumberType type) {
  return PyArray_CheckExact(source.ptr()) && PyArray_TYPE(numpy_array(source)) == number_of(type) &&
         PyArray_ISALIGNED(numpy_array(source)) && PyArray_ISNOTSWAPPED(numpy_array(source));
}

}  // namespace

void load_numpy() {
  if (PyArray_ImportNumPyAPI() < 0) throw nb::python_error();
}

nb::object new_array(NumberType type, std::span<const std::size_t> sizes, std::span<const std::int64_t> steps,
                     void* data, nb::handle owner) {
  if (sizes.size() > kMostDimensions) throw std::invalid_argument("an array with too many dimensions");
  PyArray_Descr* const numbers = PyArray_DescrFromType(number_of(type));  // is taken over by the array
  std::array<npy_intp, kMostDimensions> size{}, step{};
  std::transform(sizes.begin(), sizes.end(), size.begin(), [](std::size_t n) { return static_cast<npy_intp>(n); });
  std::transform(steps.begin(), steps.end(), step.begin(), [&](std::int64_t n) {
    return static_cast<npy_intp>(n) * static_cast<npy_intp>(PyDataType_ELSIZE(numbers));
  });
  const nb::object array = nb::steal(PyArray_NewFromDescr(&PyArray_Type, numbers, static_cast<int>(sizes.size()),
                                                          size.data(), steps.empty() ? nullptr : step.data(), data,
                                                          data ? NPY_ARRAY_WRITEABLE : 0, nullptr));
  if (!array.is_valid()) throw nb::python_error();
  if (data && PyArray_SetBaseObject(numpy_array(array), owner.inc_ref().ptr()) != 0) throw nb::python_error();
  return array;
}

void* array_data(nb::handle array) { return PyArray_DATA(numpy_array(array)); }

void* memory_of(nb::handle source, NumberType type, std::span<const std::size_t> sizes,
                std::span<const std::int64_t> steps) {
  if (!is_array_of(source, type)) return nullptr;
  PyArrayObject* const array = numpy_array(source);
  if (!PyArray_ISWRITEABLE(array) || static_cast<std::size_t>(PyArray_NDIM(array)) != sizes.size()) return nullptr;
  for (int i = 0; i < PyArray_NDIM(array); ++i) {
    const std::size_t size = sizes[static_cast<std::size_t>(i)];
    if (static_cast<std::size_t>(PyArray_DIM(array, i)) != size) return nullptr;
    const auto step = static_cast<npy_intp>(steps[static_cast<std::size_t>(i)]) * PyArray_ITEMSIZE(array);
    if (size > 1 && PyArray_STRIDE(array, i) != step) return nullptr;
  }
  return PyArray_DATA(array);
}

bool Numbers::take(nb::handle source) {
  if (!is_array_of(source, NumberType::float64)) return false;
  PyArrayObject* const array = numpy_array(source);
  for (int i = 0; i < PyArray_NDIM(array); ++i) {
    if (PyArray_STRIDE(array, i) % static_cast<npy_intp>(sizeof(double)) != 0) return false;
  }
  static_assert(std::is_same_v<npy_intp, Py_ssize_t>);
  array_ = nb::borrow(source);
  dimensions_ = static_cast<std::size_t>(PyArray_NDIM(array));
  sizes_ = PyArray_DIMS(array);
  steps_ = PyArray_STRIDES(array);
  data_ = static_cast<const double*>(PyArray_DATA(array));
  return true;
}

}  // namespace abbe::python
