#pragma once

#include "abbe/verify/error_map.h"
#include "abbe/verify/left_out_poses.h"
#include "abbe/verify/volumetric_figures.h"
#include "bindings/use/arguments.h"

namespace abbe::python {

/// Errors of two machines must not be compared: they name axes by their places in the chain.
/// @throws InputError
void require_same_machine(const Machine& machine, const Machine& other, const char* argument);

/// @throws InputError for more poses than memory
void check_grid(const std::vector<AxisRange>& ranges);

/// Maps, statistics of poses, shares.
void bind_map_parts(nb::module_& module);

}  // namespace abbe::python
