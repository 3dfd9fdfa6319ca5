#pragma once

#include <vector>

#include "abbe/compensate/tables/axis_table.h"
#include "abbe/compensate/tables/table_nodes.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Which tables a control has and how finely they follow.
struct LineTableOptions {
  std::vector<double> reference;  ///< [axes] where the other axes stand while one moves; mm or rad
  std::vector<bool> axes;         ///< [axes] whose commands are looked up; empty: all
  bool own = true;                ///< tables of an axis for itself
  bool cross = false;             ///< tables of an axis for the linear axes other than itself
  bool directions = false;        ///< own tables differ by the axis's reversal value; else they are the mean
  double tolerance_mm = 1e-4;     ///< between straight lines and the function
  double tolerance_rad = 1e-7;
  std::size_t most_nodes = 10000;
  std::size_t nodes = 0;  ///< if not 0: exactly so many, whatever the tolerance
  /// [axes] where a node has to be, mm or rad (NodeSpacing::anchor); empty: anywhere. Axes with a whole turn have one
  /// at zero in any case.
  std::vector<double> anchors;
  double step_multiple_mm = 0;  ///< see NodeSpacing::step_multiple
  double step_multiple_rad = 0;
  double negligible_mm = 0;  ///< tables that nowhere correct by more are left out
  double negligible_rad = 0;
};

struct LineTables {
  std::vector<AxisTable> tables;
  std::vector<double> interpolation_error;  ///< [tables] mm or rad, of the output
  std::vector<bool> within;                 ///< [tables] the tolerance is kept
};

/// Middle of the known travel of every axis; mm or rad.
std::vector<double> middle_of_travel(const Machine& machine, const ErrorSet& errors);

/// Tables from the corrections that hold exactly on the lines through a reference pose along which one axis moves.
///
/// With c(q) the correction of PointCorrection (linear axes) and own_correction() (rotary axes):
///     own table of axis i:          c_i at q_i, all others at the reference (with `cross`)
///     table of axis i for axis j:   c_j at q_i, all others at the reference, minus c_j at the reference
/// so that the sum of all tables is c to first order in the errors wherever c_j is a sum of functions of one axis each
/// (an expansion about lines through one point, "cut-HDMR", Rabitz and Alis, J. Math. Chem. 25 (1999) 197). What
/// depends on two axes together, such as an angle times a lever that another axis changes, is right on the lines only.
/// With a reversal value B an own table gets -B / 2 forward and +B / 2 in reverse (errors/reversal.h).
/// Without `cross` an own table is lowered to own_correction() at the reference: the remaining constant comes from
/// other axes' positions and would be wrong at all others.
LineTables line_tables(const Machine& machine, const ErrorSet& errors, const LineTableOptions& options);

/// Values of one such table at any positions of its input axis; mm or rad.
/// @param reference  [axes]
/// @param cross      as LineTableOptions::cross
std::vector<double> line_correction(const Machine& machine, const ErrorSet& errors,
                                    const std::vector<double>& reference, std::size_t input, std::size_t output,
                                    const std::vector<double>& positions, bool cross);

}  // namespace abbe
