#pragma once

#include <vector>

#include "abbe/controls/control_table.h"
#include "abbe/controls/table_format.h"

namespace abbe {

/// What a writer of this format is asked for by a request: names as indices, what is left open filled in.
/// @throws InputError for a setting that the format has no use for, and for values out of range
WriterRequest writer_request(const ControlTableRequest& request, const TableFormat& format);

/// What the control calls the axes, as it counts them: the format's own names, and those given.
/// @throws InputError also for names given twice, characters that a control's names do not have, and words where it
///   wants numbers
std::vector<TableAxisName> control_axis_names(const Machine& machine, const TableFormat& format,
                                              const std::vector<ControlAxisName>& given);

}  // namespace abbe
