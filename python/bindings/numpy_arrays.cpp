#include "bindings/numpy_arrays.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace abbe::python {
namespace {

/// The first members of every array; NumPy keeps them for compiled modules (PyArrayObject_fields in ndarraytypes.h).
struct ArrayFields {
  PyObject_HEAD char* data;
  int dimensions;
  Py_ssize_t *sizes, *steps;  ///< steps in bytes
  PyObject *base, *type;
  int flags;
};
constexpr int kAligned = 0x0100, kWriteable = 0x0400;

/// Places in NumPy's table, which are never given to another function (numpy_api.py).
struct Places {
  static constexpr std::size_t array = 2, type_from_number = 45, new_from_type = 94, set_base = 282;
};
using TypeFromNumber = PyObject* (*)(int);
using NewFromType = PyObject* (*)(PyTypeObject*, PyObject*, int, const Py_ssize_t*, const Py_ssize_t*, void*, int,
                                  PyObject*);
using SetBase = int (*)(PyObject*, PyObject*);

constexpr std::size_t kTypes = 3, kLargestDimension = 4;
constexpr std::array<int, kTypes> kTypeNumbers{12, 0, 2};      // NPY_DOUBLE, NPY_BOOL, NPY_UBYTE
constexpr std::array<Py_ssize_t, kTypes> kTypeSizes{8, 1, 1};  // bytes

/// References in it are kept until the process ends.
struct Numpy {
  PyTypeObject* array = nullptr;
  std::array<PyObject*, kTypes> types{};
  NewFromType new_from_type = nullptr;
  SetBase set_base = nullptr;
};
Numpy api;

const ArrayFields& fields(nb::handle array) { return *reinterpret_cast<const ArrayFields*>(array.ptr()); }

template <class Function>
Function function(void* const* table, std::size_t place) {
  return reinterpret_cast<Function>(table[place]);
}

nb::object numpy_core() {
  try {
    return nb::module_::import_("numpy._core._multiarray_umath");
  } catch (nb::python_error& error) {
    if (!error.matches(PyExc_ImportError)) throw;
    return nb::module_::import_("numpy.core._multiarray_umath");  // before NumPy 2
  }
}

/// Whether an array that NumPy has made from a list looks here as it should.
bool layout_is_known() {
  const nb::object made = nb::module_::import_("numpy").attr("array")(
      nb::make_tuple(nb::make_tuple(1.0, 2.0, 3.0), nb::make_tuple(4.0, 5.0, 6.0)));
  Numbers numbers;
  return Py_TYPE(made.ptr()) == api.array && numbers.take(made) && numbers.ndim() == 2 && numbers.shape(0) == 2 &&
         numbers.shape(1) == 3 && numbers.stride(0) == 3 && numbers.stride(1) == 1 && numbers.data()[5] == 6.0;
}

}  // namespace

void load_numpy() {
  const nb::object capsule = numpy_core().attr("_ARRAY_API");
  void* const* table = static_cast<void* const*>(PyCapsule_GetPointer(capsule.ptr(), nullptr));
  if (!table) throw nb::python_error();
  api.array = static_cast<PyTypeObject*>(table[Places::array]);
  const auto type = function<TypeFromNumber>(table, Places::type_from_number);
  for (std::size_t i = 0; i < kTypes; ++i) api.types[i] = type(kTypeNumbers[i]);
  api.new_from_type = function<NewFromType>(table, Places::new_from_type);
  api.set_base = function<SetBase>(table, Places::set_base);
  if (!layout_is_known()) {
    throw nb::import_error("this version of NumPy keeps arrays in a way that abbe does not know");
  }
}

nb::object new_array(NumberType type, std::span<const std::size_t> sizes, std::span<const std::int64_t> steps,
                     void* data, nb::handle owner) {
  if (sizes.size() > kLargestDimension) throw std::invalid_argument("an array of too many dimensions");
  std::array<Py_ssize_t, kLargestDimension> size{}, step{};
  const auto index = static_cast<std::size_t>(type);
  std::transform(sizes.begin(), sizes.end(), size.begin(), [](std::size_t n) { return static_cast<Py_ssize_t>(n); });
  std::transform(steps.begin(), steps.end(), step.begin(),
                 [&](std::int64_t n) { return static_cast<Py_ssize_t>(n) * kTypeSizes[index]; });
  Py_INCREF(api.types[index]);  // is taken over
  const nb::object array =
      nb::steal(api.new_from_type(api.array, api.types[index], static_cast<int>(sizes.size()), size.data(),
                                  steps.empty() ? nullptr : step.data(), data, data ? kWriteable : 0, nullptr));
  if (!array.is_valid()) throw nb::python_error();
  if (data && api.set_base(array.ptr(), owner.inc_ref().ptr()) != 0) throw nb::python_error();
  return array;
}

void* array_data(nb::handle array) { return fields(array).data; }

void* memory_of(nb::handle source, NumberType type, std::span<const std::size_t> sizes,
                std::span<const std::int64_t> steps) {
  if (Py_TYPE(source.ptr()) != api.array) return nullptr;
  const ArrayFields& array = fields(source);
  const auto index = static_cast<std::size_t>(type);
  constexpr int kNeeded = kAligned | kWriteable;
  if (array.type != api.types[index] || (array.flags & kNeeded) != kNeeded ||
      static_cast<std::size_t>(array.dimensions) != sizes.size()) {
    return nullptr;
  }
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (static_cast<std::size_t>(array.sizes[i]) != sizes[i]) return nullptr;
    if (sizes[i] > 1 && array.steps[i] != static_cast<Py_ssize_t>(steps[i]) * kTypeSizes[index]) return nullptr;
  }
  return array.data;
}

bool Numbers::take(nb::handle source) {
  if (Py_TYPE(source.ptr()) != api.array) return false;
  const ArrayFields& array = fields(source);
  if (array.type != api.types[0] || (array.flags & kAligned) == 0) return false;
  for (int i = 0; i < array.dimensions; ++i) {
    if (array.steps[i] % static_cast<Py_ssize_t>(sizeof(double)) != 0) return false;
  }
  array_ = nb::borrow(source);
  dimensions_ = static_cast<std::size_t>(array.dimensions);
  sizes_ = array.sizes;
  steps_ = array.steps;
  data_ = reinterpret_cast<const double*>(array.data);
  return true;
}

}  // namespace abbe::python
