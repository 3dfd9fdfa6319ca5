#pragma once

#include "abbe/compensate/line_tables.h"
#include "compensate/table_formats.h"

namespace abbe {

/// Controls with tables of one axis's command.
TableFormat linuxcnc_format();
TableFormat siemens_cec_format();
TableFormat siemens_eec_format();

/// What a request means for tables over lines.
LineTableOptions line_options(const TableRequest& request, const TableFormat& format);
/// Tables of one axis's command that are wanted, and what is said of them in `made`.
std::vector<AxisTable> wanted_tables(const Machine& machine, const ErrorSet& errors, const TableRequest& request,
                                     const LineTableOptions& options, ControllerTables& made);
/// The tables with all values' signs turned if `negate`.
std::vector<AxisTable> with_sign(std::vector<AxisTable> tables, bool negate);

}  // namespace abbe
