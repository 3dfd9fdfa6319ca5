#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// How a control calls an axis of the machine.
struct TableAxisName {
  std::size_t axis = 0;  ///< index into Machine::axes
  std::string name;      ///< "X1", "AX2", "1"
  bool rotary = false;   ///< positions and corrections in degrees instead of mm
};

/// The axis of that name in any case, or null.
const TableAxisName* find_table_axis(const std::vector<TableAxisName>& axes, std::string_view name);
/// The name of an axis of the machine; asserts that there is one.
const TableAxisName& table_axis(const std::vector<TableAxisName>& axes, std::size_t axis);

/// "X1, Y1 or Z1", for messages.
std::string table_axis_words(const std::vector<TableAxisName>& axes);

}  // namespace abbe
