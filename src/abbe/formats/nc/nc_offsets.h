#pragma once

// Internal to formats: what a control adds to the values of an NC program.
#include <array>
#include <cstddef>
#include <cstdint>

#include "abbe/formats/nc/nc_units.h"

namespace abbe {

/// Work offsets (G54 to G59.3), the offset of the axes (G92, G52) and that of the tool (G43); mm, degrees.
///
/// Position of the control = program value + sum(). While tool centre control is on the kinematics of the control have
/// the tool, and the sum leaves it out.
class NcOffsets {
 public:
  static constexpr std::size_t kSystems = 9;

  /// Work offset in force: 0 is G54, 8 is G59.3.
  std::size_t system() const { return system_; }
  void use_system(std::size_t system) { system_ = system; }
  const NcAxisValues& system_offset(std::size_t system) const { return systems_[system]; }
  /// Sets `words` of a work offset, which counts as said even if there are none.
  void set_system(std::size_t system, std::uint32_t words, const NcAxisValues& values);
  /// Whether parameters or program have said the work offset in force; one that they have not is taken for zero.
  bool is_system_said() const { return is_said_[system_]; }
  /// What a work offset has to be for `words` of a position to have these values in the program (G10 L20).
  NcAxisValues system_at(std::uint32_t words, const NcAxisValues& position, const NcAxisValues& values) const;

  /// G52
  void set_axis_offset(std::uint32_t words, const NcAxisValues& values);
  /// G92: what stands at `shown` of the program now has other values in it.
  void shift_axis_offset(std::uint32_t words, const NcAxisValues& shown, const NcAxisValues& values);
  /// G92.1
  void clear_axis_offset() { axis_offset_ = stored_axis_offset_ = {}; }
  /// G92.2: what is stored stays.
  void suspend_axis_offset() { axis_offset_ = {}; }
  /// G92.3
  void restore_axis_offset() { axis_offset_ = stored_axis_offset_; }
  /// 5211 and the following
  const NcAxisValues& stored_axis_offset() const { return stored_axis_offset_; }
  void store_axis_offset(std::size_t axis, double value) { stored_axis_offset_[axis] = value; }

  const NcAxisValues& tool() const { return tool_; }
  void set_tool(const NcAxisValues& offset) { tool_ = offset; }
  bool tool_centre() const { return tool_centre_; }
  void set_tool_centre(bool on) { tool_centre_ = on; }

  NcAxisValues sum() const;
  /// The value of a word by which G92 says that the axis stands at `position`, with the sum as it is.
  double value_for_axis_offset(std::size_t axis, double position) const;

 private:
  double counted_tool(std::size_t axis) const { return tool_centre_ ? 0 : tool_[axis]; }

  std::size_t system_ = 0;
  std::array<NcAxisValues, kSystems> systems_{};
  std::array<bool, kSystems> is_said_{};
  NcAxisValues axis_offset_{};         ///< in force
  NcAxisValues stored_axis_offset_{};  ///< for G92.3
  NcAxisValues tool_{};
  bool tool_centre_ = false;  ///< G43.4
};

}  // namespace abbe
