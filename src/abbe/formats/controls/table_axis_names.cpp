#include "abbe/formats/controls/table_axis_names.h"

#include <algorithm>
#include <cassert>

#include "abbe/formats/text/ascii_letters.h"

namespace abbe {

const TableAxisName* find_table_axis(const std::vector<TableAxisName>& axes, std::string_view name) {
  for (const TableAxisName& axis : axes) {
    if (std::equal(axis.name.begin(), axis.name.end(), name.begin(), name.end(),
                   [](char a, char b) { return upper_case(a) == upper_case(b); })) {
      return &axis;
    }
  }
  return nullptr;
}

const TableAxisName& table_axis(const std::vector<TableAxisName>& axes, std::size_t axis) {
  const auto found = std::find_if(axes.begin(), axes.end(), [&](const TableAxisName& one) { return one.axis == axis; });
  assert(found != axes.end());
  return *found;
}

std::string table_axis_words(const std::vector<TableAxisName>& axes) {
  std::string words;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    words += (i == 0 ? "" : i + 1 == axes.size() ? " or " : ", ") + axes[i].name;
  }
  return words;
}

}  // namespace abbe
