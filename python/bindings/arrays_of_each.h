#pragma once

// Arrays with one row per item of a list: numbers, vectors and flags that its items hold.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "bindings/arrays.h"
#include "bindings/use/arguments.h"

namespace abbe::python {

/// get(item) of each. @param get  a function, or a pointer to a member
template <class Value, class Items, class Get>
std::vector<Value> values_of_each(const Items& items, const Get& get) {
  std::vector<Value> values;
  values.reserve(items.size());
  for (const auto& item : items) values.push_back(static_cast<Value>(std::invoke(get, item)));
  return values;
}

/// [n] float64.
template <class Items, class Get>
nb::object numbers_of_each(const Items& items, const Get& get) {
  return array_of(values_of_each<double>(items, get), {items.size()});
}

/// [n] int.
template <class Items, class Get>
nb::object ints_of_each(const Items& items, const Get& get) {
  return array_of_ints(values_of_each<int>(items, get));
}

/// [n] bool.
template <class Items, class Get>
nb::object flags_of_each(const Items& items, const Get& get) {
  return array_of_bools(values_of_each<std::uint8_t>(items, get));
}

/// [n, 3] float64, of a vector of each.
template <class Items, class Get>
nb::object vectors_of_each(const Items& items, const Get& get) {
  std::vector<double> values;
  values.reserve(3 * items.size());
  for (const auto& item : items) {
    for (const double value : std::invoke(get, item)) values.push_back(value);
  }
  return array_of(std::move(values), {items.size(), 3});
}

}  // namespace abbe::python
