#include "compensate/table_options.h"

#include "abbe/formats/text/input_error.h"

namespace abbe {

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
