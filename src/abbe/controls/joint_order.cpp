#include "abbe/controls/joint_order.h"

#include <algorithm>
#include <string>
#include <string_view>

namespace abbe {

std::vector<std::size_t> joint_order(const Machine& machine) {
  std::vector<std::size_t> order;
  for (const char letter : std::string_view("XYZABCUVW")) {
    const std::size_t axis = machine.find_axis(std::string(1, letter));
    if (axis != Machine::npos) order.push_back(axis);
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (std::find(order.begin(), order.end(), i) == order.end()) order.push_back(i);
  }
  return order;
}

}  // namespace abbe
