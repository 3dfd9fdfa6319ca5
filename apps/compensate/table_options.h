#pragma once

#include <string>
#include <vector>

#include "abbe/machine/machine.h"
#include "compensate/table_formats.h"

namespace abbe {

/// Pose from "AXIS_unit=position" options; what is not given stays. @throws InputError
/// @param option  how the user calls them: "--at"
std::vector<double> pose_option(const Machine& machine, const std::string& option, std::vector<double> positions,
                                const std::vector<std::string>& at);

/// The machine's zero, or the end of the travel that is next to it.
std::vector<double> machine_zero(const Machine& machine);

/// [axes] true where named; all without names. @throws InputError
std::vector<bool> chosen_axes(const Machine& machine, const std::vector<std::string>& names);

/// An option that some formats have no use for.
struct FormatOption {
  std::string name;                  ///< "--negate"
  std::vector<std::string> formats;  ///< that have it
};
const std::vector<FormatOption>& format_options();

/// @throws InputError for an option that would change nothing: whoever turns a sign has to know that it did not turn
void refuse_options_of_other_formats(const TableFormat& format, const std::vector<std::string>& given);

/// What the control calls the axes: the format's own names, and "AXIS=NAME" options. @throws InputError also for names
/// given twice, characters that a control's names do not have, and words where it wants numbers
std::vector<TableAxisName> table_axis_names(const Machine& machine, const TableFormat& format,
                                            const std::vector<std::string>& names);

}  // namespace abbe
