#pragma once

// Internal to formats: the state of an NC program between its blocks.
#include <array>
#include <cstdint>

#include "abbe/formats/nc/nc_modes.h"
#include "abbe/formats/nc/nc_offsets.h"
#include "abbe/formats/nc/nc_position.h"
#include "abbe/formats/nc/nc_tools.h"

namespace abbe {

/// What a program has in force; parameters, and which line comes next, are in NcParameters and NcFlow.
struct NcState {
  NcModes modes;
  NcPathMode path;
  NcSpindle spindle;
  NcTools tools;
  NcOffsets offsets;
  NcPosition position;
  std::array<NcPlace, 2> references{};  ///< of G28, G30: positions of the axes

  /// As it is when the program begins.
  explicit NcState(const NcProgramOptions& options);
};

}  // namespace abbe
