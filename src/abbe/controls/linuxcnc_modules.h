#pragma once

// Internal to controls: kinematics modules of LinuxCNC and the geometry that their pins state.
#include <functional>
#include <string>
#include <vector>

#include "abbe/controls/kinematic_format.h"
#include "abbe/controls/rotary_pair.h"

namespace abbe {

constexpr double kModuleDirection = 1e-9;  ///< how far directions may be from those that a module has fixed

/// One kinematics module, for one machine.
struct LinuxcncModule {
  std::string name;   ///< "xyzac-trt-kins", as it is loaded
  std::string lines;  ///< of the HAL file, before those of the values
  /// Lengths in mm, angles in rad, of a geometry: each is a pin of that name.
  std::function<std::vector<PlainValue>(const Machine& geometry)> values;
  /// Puts pins into the nominal machine.
  std::function<void(const NamedNumbers& pins, Machine& believed)> believe;
  std::vector<std::string> settings;  ///< what has to be set besides
};

/// xyzac-trt-kins, xyzbc-trt-kins: a table C in a cradle A or B. Source: LinuxCNC, trtfuncs.c.
LinuxcncModule trunnion_module(const Machine& nominal, const RotaryPair& pair);
/// xyzab_tdr_kins: a table A on a table B. Source: LinuxCNC, xyzab_tdr_kins.comp.
LinuxcncModule dual_table_module(const Machine& nominal, const RotaryPair& pair);
/// 5axiskins: a head of C and B that meet in the line of the spindle. Source: LinuxCNC, 5axiskins.c.
LinuxcncModule meeting_head_module(const Machine& nominal, const RotaryPair& pair);
/// xyzacb_trsrn, xyzbca_trsrn: a table, and a head of C and a nutating axis. Source: LinuxCNC, *_trsrn.comp.
LinuxcncModule nutating_head_module(const Machine& nominal);

/// Bad input: no module of LinuxCNC has this chain, and why.
[[noreturn]] void refuse_chain_of_modules(const std::string& why);

/// Says where the tool has offsets that a module does not know.
void add_offsets_left_out(const Machine& nominal, LinuxcncModule& module);

}  // namespace abbe
