#include "evaluate/number_option.h"

#include <fmt/format.h>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "options.h"

namespace abbe {

Option* add_number(Subcommand* command, const std::string& name, Quantity quantity, const std::string& unit,
                   NumberRange range, double& value, const std::string& description) {
  const auto read = [name, quantity, unit, range, &value](const std::string& text) {
    double number = 0, inside = 0;
    // Compared as written, so that the limits are those that the message names.
    if (parse_number(text, 0, number) != NumberProblem::none || number < range.from || number > range.to ||
        parse_quantity(text, unit_named(quantity, unit), inside) != NumberProblem::none) {
      throw InputError({.field = name}, fmt::format("'{}' is not a valid number", text.substr(0, 40)),
                       fmt::format("{} in {} from {:g} to {:g}", quantity_words(quantity), unit, range.from, range.to));
    }
    value = inside;
  };
  return command->add_option_function(name, read, description)->type_name("NUMBER");
}

}  // namespace abbe
