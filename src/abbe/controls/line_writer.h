#pragma once

#include "abbe/compensate/tables/line_tables.h"
#include "abbe/controls/table_format.h"

namespace abbe {

/// What a request means for tables over lines.
LineTableOptions line_options(const WriterRequest& request, const TableFormat& format);
/// Tables of one axis's command that are wanted, and what is said of them in `made`.
std::vector<AxisTable> wanted_tables(const Machine& machine, const ErrorSet& errors, const WriterRequest& request,
                                     const LineTableOptions& options, WrittenTables& made);
/// The tables with all values' signs turned if `negate`.
std::vector<AxisTable> with_sign(std::vector<AxisTable> tables, bool negate);

}  // namespace abbe
