#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>
#include <string_view>

#include "abbe/runtime/frozen_layout.h"
#include "abbe/runtime/frozen_machine.h"

namespace abbe {

template <typename T>
T read_at(const unsigned char* bytes, std::size_t place) {
  T value;
  std::memcpy(&value, bytes + place, sizeof value);
  return value;
}

/// Values of a file in order. The first one that is not usable ends it; what follows reads as zero.
class Values {
 public:
  Values(const unsigned char* bytes, std::size_t count) : bytes_(bytes), count_(count) {}

  double number(double least, double most, std::string_view field) {
    if (next_ >= count_) fail(field);
    if (!ok()) return 0;
    const double value = read_at<double>(bytes_, 8 * next_++);
    if (value >= least && value <= most) return value;  // false for what is no number
    fail(field);
    return 0;
  }
  std::size_t whole(std::size_t most, std::string_view field) {
    const double value = number(0, static_cast<double>(most), field);
    if (value != std::floor(value)) fail(field);
    return ok() ? static_cast<std::size_t>(value) : 0;
  }
  bool flag(std::string_view field) { return whole(1, field) != 0; }
  double length(std::string_view field) { return number(-frozen::kLongest, frozen::kLongest, field); }
  Triple triple(std::string_view field) {
    const double x = length(field), y = length(field), z = length(field);
    return {x, y, z};
  }
  Triple unit(std::string_view field) {
    const Triple u = triple(field);
    require(std::abs(dot(u, u) - 1) < 1e-9, field);
    return u;
  }
  void require(bool condition, std::string_view field) {
    if (!condition) fail(field);
  }
  void fail(std::string_view field) {
    if (ok()) field_ = field;
  }
  bool ok() const { return field_.empty(); }
  std::string_view field() const { return field_; }
  bool at_end() const { return next_ == count_; }
  void skip(std::size_t values) { next_ += values; }
  std::size_t left() const { return next_ < count_ ? count_ - next_ : 0; }

 private:
  const unsigned char* bytes_;
  std::size_t count_, next_ = 0;
  std::string_view field_;
};

/// A group of functions with its coefficients.
/// @param room  out: where nodes and coefficients go; moved on
void read_group(Values& values, const abbe_runtime& m, FrozenGroup& group, std::size_t& axis, double*& room);

/// Coefficients of a group in the file and in memory: this many rows of six.
inline std::size_t group_rows(const FrozenGroup& group) {
  return group.functions * (group.kind == FrozenGroup::Kind::piecewise_cubic ? 4 : 1);
}

/// States and what depends on them, behind the groups of a file of format 3.
/// @param group   all groups: those before, to which groups with a factor of the pose are added
/// @param groups  in: those before
void read_states(Values& values, abbe_runtime& m, FrozenStates& states, FrozenGroup* group, std::size_t groups,
                 double*& room);

}  // namespace abbe
