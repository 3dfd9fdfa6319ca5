#include "compensate/table_options.h"

#include "abbe/formats/text/input_error.h"
#include "axis_option.h"

namespace abbe {

std::vector<HeldAxis> held_axes_option(const Machine& machine, const std::string& option,
                                       const std::vector<std::string>& texts) {
  std::vector<HeldAxis> held;
  for (const std::string& text : texts) {
    held.push_back(axis_option(machine, option, text));
    const Axis& axis = machine.axes[held.back().axis];
    const double position = held.back().position;
    if (!axis.endless && (position < axis.travel_min || position > axis.travel_max)) {
      throw InputError({.field = option + " " + text}, "outside the axis's travel", "a position within it");
    }
  }
  return held;
}

std::vector<ControlAxisName> axis_names_option(const TableFormat& format, const std::vector<std::string>& texts) {
  std::vector<ControlAxisName> names;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      throw InputError({.field = "--name " + text}, "not understood", axis_names_expected(format));
    }
    names.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  return names;
}

}  // namespace abbe
