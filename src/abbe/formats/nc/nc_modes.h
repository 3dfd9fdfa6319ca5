#pragma once

// Internal to formats: what is in force in an NC program.
#include <cstddef>
#include <string>

#include "abbe/compensate/program/program_move.h"
#include "abbe/formats/nc/nc_codes.h"
#include "abbe/formats/nc/nc_units.h"

namespace abbe {

/// What is in force between blocks, but for offsets: LinuxCNC's state when a program begins.
struct NcModes {
  NcCode motion = 800;
  ArcPlane plane = ArcPlane::XY;
  bool absolute = true;
  bool arc_absolute = false;
  bool inches = false;
  bool retract_to_r = true;  ///< G99
  FeedMode feed_mode = FeedMode::per_minute;
  double feed = 0;           ///< F as it was written
  bool feed_inches = false;  ///< the unit in which it was

  /// Takes feed mode and F, which come before the units of the same block.
  void take_feed(const NcCodedBlock& block);
  /// Takes plane, units, distance mode and retract mode; not the motion, which holds when the block is done.
  void take(const NcCodedBlock& block);

  /// mm or degrees of a unit of the axis word.
  double unit(std::size_t axis) const { return inches && !is_rotary_word(axis) ? kInch : 1; }
  /// An axis word of a block, mm or degrees.
  double length(const NcBlock& block, std::size_t axis) const { return block.value(kAxisLetters[axis]) * unit(axis); }
};

/// How the control goes through the ends of moves: G61, G61.1, G64.
class NcPathMode {
 public:
  void take(const NcCodedBlock& block);

  /// The block that puts it into force; empty if an exact path is.
  std::string block() const { return is_exact_ ? "" : words_.empty() ? "G64" : words_; }
  /// The same if it is one that rounds corners, else empty.
  std::string rounding_block() const { return stops_in_corners_ ? "" : block(); }

 private:
  std::string words_;  ///< "G64 P0.1"
  bool is_exact_ = false;
  bool stops_in_corners_ = false;
};

/// What the spindle does.
class NcSpindle {
 public:
  /// Takes S, M3, M4, M5, M19, a change of the tool, and M48 or M49.
  void take(const NcCodedBlock& block);

  double speed() const { return speed_; }
  /// 3 or 4: it turns by M3 or M4; 0: it is not known to turn.
  int direction() const { return direction_; }
  bool has_overrides() const { return overrides_; }

 private:
  double speed_ = 0;
  int direction_ = 0;
  bool overrides_ = true;
};

}  // namespace abbe
