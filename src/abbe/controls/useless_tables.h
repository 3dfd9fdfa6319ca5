#pragma once

#include <string>

#include "abbe/controls/control_table.h"
#include "abbe/controls/table_format.h"

namespace abbe {

/// Whether tables correct next to nothing of the errors they were made for, and what would correct them.
///
/// Tables are of use if they make the volumetric error, or the error of the tool's direction, smaller by
/// `least_reduction` (root mean square over the grid), or if what they take away of one error alone is that much of the
/// whole: a well corrected scale does not show beside a large squareness error. Nothing is said where there is nothing
/// to correct, where only reversal values are left, which the control takes itself, and where tables were left out on
/// request.
/// @param errors   what the tables were made of
/// @param request  what was asked of the tables
/// @param made     complete but for `refused` and what follows from it
/// @param least_reduction  share, 0 to 1; 0: all tables are of use
/// @returns empty: of use; else why not, a sentence without a full stop
std::string useless_tables(const Machine& machine, const ErrorSet& errors, const WriterRequest& request,
                           const ControlTables& made, double least_reduction);

}  // namespace abbe
