#pragma once

// Internal to formats: the tools of an NC program and their lengths.
#include <map>
#include <optional>

#include "abbe/formats/nc/nc_codes.h"
#include "abbe/formats/nc/nc_modes.h"
#include "abbe/formats/nc/nc_program.h"
#include "abbe/formats/nc/nc_units.h"

namespace abbe {

/// The tool table, the tool in the spindle and the one that T has asked for.
class NcTools {
 public:
  /// @param table     mm, rad
  /// @param in_spindle  if known
  NcTools(const std::optional<NcToolTable>& table, std::optional<int> in_spindle);

  /// Takes T, M6 and M61.
  void take(const NcCodedBlock& block);
  /// G10 L1: sets the axis words of the block in the table. @throws InputError
  void set_offset(const NcCodedBlock& block, int number, const NcModes& modes);
  /// The tool offset by G43, G43.1, G43.2, G43.4 or G49 of a block, mm and degrees.
  /// @param before  that in force
  /// @throws InputError
  NcAxisValues offset(const NcCodedBlock& block, const NcModes& modes, const NcAxisValues& before) const;

  std::optional<int> in_spindle() const { return in_spindle_; }
  std::optional<int> selected() const { return selected_; }

 private:
  const NcAxisValues& from_table(const NcCodedBlock& block) const;

  bool has_table_;
  std::map<int, NcAxisValues> table_;
  std::optional<int> in_spindle_, selected_;
};

}  // namespace abbe
