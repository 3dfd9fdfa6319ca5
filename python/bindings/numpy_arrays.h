#pragma once

// Arrays of NumPy through NumPy's own C interface: making an array this way takes a tenth of the time of the buffer
// protocol, which decides what a call with a single pose costs.
#include <cstddef>
#include <cstdint>
#include <span>

#include "bindings/bindings.h"

namespace abbe::python {

enum class NumberType { float64, bool8, uint8 };

/// Finds NumPy. @throws nb::python_error (ImportError) where it is missing or older than 1.23
void load_numpy();

/// A new array. GIL needed.
/// @param sizes  of each dimension
/// @param steps  from one element of a dimension to the next, in numbers; empty: C order
/// @param data   null: memory from NumPy, not initialized; otherwise `owner` keeps it alive as long as the array
nb::object new_array(NumberType type, std::span<const std::size_t> sizes, std::span<const std::int64_t> steps,
                     void* data = nullptr, nb::handle owner = {});

/// Memory of an array made by new_array().
void* array_data(nb::handle array);

/// Memory of an array to be written to; null if it is not an array of this type, these sizes and steps, or is
/// read-only.
/// @param steps  in numbers; that of a dimension with one element does not matter
void* memory_of(nb::handle array, NumberType type, std::span<const std::size_t> sizes,
                std::span<const std::int64_t> steps);

/// float64 in the processor's byte order, of any shape; strides are multiples of 8 bytes. Not to be written to.
class Numbers {
 public:
  Numbers() = default;
  /// Refers to an array as it is. @return false if it is not an array, or has another type or layout
  bool take(nb::handle source);

  std::size_t ndim() const { return dimensions_; }
  std::size_t shape(std::size_t dimension) const { return static_cast<std::size_t>(sizes_[dimension]); }
  /// In numbers, not in bytes.
  std::int64_t stride(std::size_t dimension) const {
    return static_cast<std::int64_t>(steps_[dimension]) / static_cast<std::int64_t>(sizeof(double));
  }
  const double* data() const { return data_; }

 private:
  nb::object array_;
  std::size_t dimensions_ = 0;
  const Py_ssize_t *sizes_ = nullptr, *steps_ = nullptr;  ///< of the array, which owns them
  const double* data_ = nullptr;
};

}  // namespace abbe::python
