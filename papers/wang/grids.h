#pragma once

#include "papers.h"

namespace abbe {

/// `abbe reproduce wang --grids FOLDER`: decouples the readings of every CSV in the folder, one axis of the grinder a
/// file. @returns an ExitCode, kNegative if an axis cannot be decoupled @throws InputError
int decouple_wang_grids(const ReproduceOptions& options);

}  // namespace abbe
