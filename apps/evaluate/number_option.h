#pragma once

#include <string>

#include "abbe/formats/text/unit.h"

namespace abbe {

class Option;
class Subcommand;

/// Range of an option's value, in the unit that its name says.
struct NumberRange {
  double from = 0, to = 0;
};

/// An option whose name ends in its unit: "--radius-mm 150".
///
/// @param unit   suffix of the quantity as in files: "mm", "um", "deg"
/// @param value  mm, rad, s; stays as it is if the option is not given
/// The command line is refused (InputError) for what is no finite number within the range.
Option* add_number(Subcommand* command, const std::string& name, Quantity quantity, const std::string& unit,
                   NumberRange range, double& value, const std::string& description);

}  // namespace abbe
