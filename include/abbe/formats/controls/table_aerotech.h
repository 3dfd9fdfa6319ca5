#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "abbe/compensate/tables/axis_table.h"
#include "abbe/compensate/tables/correction_lattice.h"
#include "abbe/formats/controls/table_axis_names.h"

namespace abbe {

/// Axis calibration of Aerotech controls (A3200, Automation1), 1-D tables:
///     :START axis [MASTER=axis] POSUNIT=PRIMARY CORUNIT=PRIMARY SAMPLEDIST=step OFFSET=offset
///     correction correction ...
///     :END
/// The number behind :START is the axis that is corrected, MASTER the one whose position is looked up (without it, the
/// same), both counted from 1. The first correction belongs to the position -OFFSET, and the others follow at
/// SAMPLEDIST. Between them straight lines, outside the end values; all tables add up. Corrections are added to the
/// position: nominal minus actual. Lines may be divided: more lines with :START continue the first; ; and ' begin a
/// comment. mm with 7 decimals, degrees with 9.
/// Source: docs/controller-tables.md.
/// @param tables  evenly spaced, both directions the same
std::string aerotech_1d_text(const std::vector<AxisTable>& tables, const std::vector<TableAxisName>& axes);
/// @throws InputError for what it does not know of a file, for missing and repeated values, and for keywords that
///         change the meaning of a table and are not read (NEGPOS, EXPANDCOEFF, HOMEDIRECTION and others)
std::vector<AxisTable> parse_aerotech_1d(std::string_view text, const std::string& file,
                                         const std::vector<TableAxisName>& axes);

/// Tables of the same control over the positions of two axes:
///     :START2D RowAxis ColumnAxis OutputAxis1 OutputAxis2 SampDistRow SampDistCol NumCols
///     :START2D [OUTAXIS3=axis] POSUNIT=PRIMARY CORUNIT=PRIMARY OFFSETROW=offset OFFSETCOL=offset
///     a row of NumCols pairs (with OUTAXIS3, of triplets) of corrections per step of the row axis
///     :END
/// The first row belongs to the position -OFFSETROW of the row axis, the first column to -OFFSETCOL of the column axis.
/// @param tables  two evenly spaced inputs, the first of which is the column axis, and two or three outputs
std::string aerotech_2d_text(const std::vector<CorrectionLattice>& tables, const std::vector<TableAxisName>& axes);
/// @throws InputError as above
std::vector<CorrectionLattice> parse_aerotech_2d(std::string_view text, const std::string& file,
                                                 const std::vector<TableAxisName>& axes);

}  // namespace abbe
