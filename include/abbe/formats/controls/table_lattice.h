#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "abbe/compensate/tables/correction_lattice.h"
#include "abbe/formats/controls/table_axis_names.h"

namespace abbe {

/// Corrections over a grid of axis positions as CSV: a column per input axis (X_mm, C_deg) and one per corrected axis
/// (correction_X_um, correction_A_urad), one row per node, the first input fastest, corrections with 4 decimals (0.1
/// nm, 0.1 nrad). Lines that begin with # are comments.
/// @param axes  names of the machine's axes as they are
std::string lattice_csv_text(const CorrectionLattice& lattice, const std::vector<TableAxisName>& axes);

/// Rows in any order. A grid that lacks a node, or has one twice, is refused; `modulo` is not in the file and false.
/// @throws InputError
CorrectionLattice parse_lattice_csv(std::string_view text, const std::string& file,
                                    const std::vector<TableAxisName>& axes);

/// The same for one to three inputs as a rectilinear grid of legacy VTK, ASCII, version 3.0 (ParaView): coordinates in
/// mm and degrees, one field of scalars per corrected axis. The title names the inputs.
/// Source: The VTK User's Guide, "VTK File Formats", simple legacy formats.
std::string lattice_vtk_text(const CorrectionLattice& lattice, const std::vector<TableAxisName>& axes);
CorrectionLattice parse_lattice_vtk(std::string_view text, const std::string& file,
                                    const std::vector<TableAxisName>& axes);

}  // namespace abbe
