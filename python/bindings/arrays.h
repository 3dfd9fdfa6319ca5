#pragma once

// Arrays of NumPy in and out of the library.
//
// Axis commands come as [axes] or [n, axes], float64, of any layout. Arrays whose columns are contiguous (Fortran
// order) are used where they lie; of others, blocks of rows are transposed on the way. What comes out is allocated here
// and given to Python without a copy; its first index is the pose, and each number of all poses is contiguous, as the
// library has it.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <vector>

#include "abbe/errors/chain_plan.h"
#include "abbe/errors/poses.h"
#include "abbe/machine/machine.h"
#include "bindings/bindings.h"
#include "bindings/numpy_arrays.h"

namespace abbe::python {

using Triple = std::array<double, 3>;
inline Eigen::Vector3d vector(const Triple& numbers) { return {numbers[0], numbers[1], numbers[2]}; }

/// Anything that numpy.asarray(..., dtype=float64) takes; shown as ArrayLike in signatures.
struct ArrayLike {
  nb::handle source;
  /// Itself where it is float64, else a copy. @throws InputError  it is no array of numbers. @param name  for messages
  Numbers numbers(const char* name) const;
};

/// Axis commands of an argument. The machine and `name` must outlive them.
class Positions {
 public:
  /// @throws InputError for another number of axes, and for numbers that are not finite: up to kBlock poses are checked
  ///         here, more of them where they are used, while they are in the cache
  Positions(const ArrayLike& argument, const Machine& machine, const char* name = "positions_mm_rad");

  std::size_t count() const { return count_; }
  bool single() const { return array_.ndim() == 1; }  ///< one pose without an index

  /// The numbers of commands in a block: what is transposed stays in the first-level cache.
  static constexpr std::size_t kBlock = 512;
  /// Memory for blocks that have to be transposed.
  struct Block {
    std::array<const double*, kMaxAxes> axis;
    std::vector<double> values;
  };
  /// Commands first .. first + count - 1 as the library takes them; count <= kBlock. The GIL need not be held.
  /// @throws InputError for numbers that are not finite
  PositionArrays block(std::size_t first, std::size_t count, Block& memory) const;
  /// All of them, copied. @throws InputError for numbers that are not finite
  PoseList list() const;
  /// Whether memory of `size` numbers lies between the first and the last of these numbers, in whole or in part.
  bool overlaps(const double* memory, std::size_t size) const;

 private:
  bool columns_are_contiguous() const { return pose_step_ == 1 || count_ == 1; }
  const double* column(std::size_t axis, std::size_t first) const {
    return array_.data() + static_cast<std::int64_t>(axis) * axis_step_ + static_cast<std::int64_t>(first) * pose_step_;
  }
  std::string expected() const;
  /// Names the first number that is not finite.
  [[noreturn]] void refuse_what_is_not_finite() const;

  Numbers array_;
  const Machine& machine_;
  const char* name_;
  std::size_t count_ = 0, axes_ = 0;
  std::int64_t pose_step_ = 0, axis_step_ = 0;  ///< in numbers
};

/// Calls work(first, count) for blocks of poses on several threads. The GIL must not be held.
void for_each_block_of(std::size_t count, const std::function<void(std::size_t first, std::size_t count)>& work);

/// An array that is being filled and then given to Python: [n] for each of `parts` numbers, number after number.
template <class Number>
class Columns {
 public:
  Columns(std::size_t parts, std::size_t count);
  ~Columns();
  Columns(const Columns&) = delete;
  Columns& operator=(const Columns&) = delete;

  Number* operator[](std::size_t part) { return data_ + part * count_; }
  std::size_t count() const { return count_; }

  /// As an array [n, shape...] of Python; without its first index if `single`. To be called once.
  nb::object release(std::initializer_list<std::size_t> shape, bool single);
  /// The same as an array of bool, [n]; the numbers are 0 or 1.
  nb::object release_bools();

 private:
  static constexpr std::size_t kFew = 16;  ///< numbers, enough for a pose: they are copied
  bool few() const { return data_ == few_.data(); }
  nb::object release_as(NumberType type, std::initializer_list<std::size_t> shape, bool single);

  Number* data_ = nullptr;
  std::size_t parts_ = 0, count_ = 0;
  alignas(64) std::array<Number, kFew> few_;
};
extern template class Columns<double>;
extern template class Columns<std::uint8_t>;

/// A C-ordered array of Python that takes over these numbers; their number is the product of the shape.
nb::object array_of(std::vector<double>&& values, std::initializer_list<std::size_t> shape);
nb::object array_of(std::vector<std::uint8_t>&& values);
nb::object array_of_bools(std::vector<std::uint8_t>&& values);

}  // namespace abbe::python

namespace nanobind::detail {

template <>
struct type_caster<abbe::python::ArrayLike> {
  NB_TYPE_CASTER(abbe::python::ArrayLike, const_name("numpy.typing.ArrayLike"))
  bool from_python(handle source, std::uint32_t, cleanup_list*) noexcept {
    value.source = source;
    return !source.is_none();
  }
};

}  // namespace nanobind::detail
