#pragma once

#include <functional>
#include <memory>
#include <string>

#include "abbe/compensate/tables/correction_lattice.h"
#include "abbe/controls/table_format.h"

namespace abbe {

/// What a request asks of a lattice: a grid over the axes wanted that move, corrections of all linear axes and of the
/// rotary ones in the grid.
/// @param linear_only  where no axes are chosen, those of the grid are the linear ones
/// @throws InputError for more than `most_inputs` axes, or none
LatticeOptions lattice_options(const Machine& machine, const ErrorSet& errors, const WriterRequest& request,
                               const TableFormat& format, std::size_t most_inputs, bool linear_only);

/// What a lattice would say for other errors.
using LatticeOfErrors = std::function<std::unique_ptr<CommandCorrection>(const ErrorSet&)>;
/// What is said of one corrected axis of a lattice.
/// @param output  index into CorrectionLattice::outputs
WrittenTable lattice_summary(const Machine& machine, const BuiltLattice& built, const LatticeOptions& options,
                             std::size_t output, const std::string& name, LatticeOfErrors function);

/// A summary per corrected axis, and the grid as a remark.
void add_lattice_summaries(const Machine& machine, const BuiltLattice& built, const LatticeOptions& options,
                           WrittenTables& made);

}  // namespace abbe
