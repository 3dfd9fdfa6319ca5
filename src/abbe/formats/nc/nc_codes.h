#pragma once

// Internal to formats: the G and M codes of a block by their modal groups.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "abbe/formats/nc/nc_block.h"

namespace abbe {

/// G codes in tenths: G53 is 530, G59.3 is 593.
using NcCode = int;
inline constexpr NcCode kNoCode = -1;

/// Groups of G codes of which a block may have one each. Source: NIST RS274/NGC version 3, table 4; LinuxCNC, G-code,
/// "Modal groups".
enum class NcGroup : std::uint8_t {
  none,         ///< not a code that is handled
  non_modal,    ///< G4 G10 G28 G30 G52 G53 G53.1 G92
  motion,       ///< G0 G1 G2 G3 G33 G33.1 G73 G74 G80-G86 G89
  plane,        ///< G17 G18 G19
  distance,     ///< G90 G91
  arc_centre,   ///< G90.1 G91.1
  feed_mode,    ///< G93 G94 G95
  units,        ///< G20 G21
  cutter,       ///< G40
  tool_length,  ///< G43 G43.1 G43.2 G43.4 G49
  retract,      ///< G98 G99
  work_offset,  ///< G54-G59.3
  path,         ///< G61 G61.1 G64
  spindle,      ///< G96 G97
  diameter,     ///< G8
  tilt,         ///< G68.2 G69
};
inline constexpr std::size_t kNcGroups = 16;

/// Groups of M codes of which a block may have one each; what stands beside each other has groups of its own.
enum class NcMGroup : std::uint8_t {
  stop,        ///< M0 M1 M2 M30 M60 M98 M99
  tool,        ///< M6 M61
  spindle,     ///< M3 M4 M5 M19
  mist,        ///< M7
  flood,       ///< M8
  no_coolant,  ///< M9
  overrides,   ///< M48-M53
  signals,     ///< M62-M68
  user,        ///< M100-M199
  none,        ///< not a code that is handled
};
inline constexpr std::size_t kNcMGroups = 9;

/// A block with its codes by their groups.
struct NcCodedBlock : NcBlock {
  std::array<NcCode, kNcGroups> codes{};            ///< by group; kNoCode
  std::array<std::uint8_t, kNcGroups> places{};     ///< the word
  std::array<std::uint8_t, kNcMGroups> m_places{};  ///< the word of an M code of each group, or kNoWord
  std::size_t m_count = 0;
  std::uint8_t cancel_place = kNoWord;  ///< the word G80 beside another code of the motion
  std::uint32_t axes = 0;               ///< bits of the axis words

  using NcBlock::has;
  using NcBlock::word;
  NcCode code(NcGroup group) const { return codes[static_cast<std::size_t>(group)]; }
  bool has(NcGroup group) const { return code(group) != kNoCode; }
  const NcWord& word(NcGroup group) const { return words[places[static_cast<std::size_t>(group)]]; }
  bool has(NcMGroup group) const { return m_places[static_cast<std::size_t>(group)] != kNoWord; }
  const NcWord& word(NcMGroup group) const { return words[m_places[static_cast<std::size_t>(group)]]; }
  bool is_m(NcMGroup group, int m_code) const { return has(group) && std::lround(word(group).value) == m_code; }
  bool has_axis(std::size_t axis) const { return (axes >> axis & 1) != 0; }
  /// The word of the motion, or the first one where it goes on without.
  const NcWord& motion_word() const { return has(NcGroup::motion) ? word(NcGroup::motion) : words[0]; }

  bool has_centre() const { return has('i') || has('j') || has('k'); }

  // What takes the axis words, if not a motion.
  bool sets_plane() const { return code(NcGroup::tilt) == 682; }
  /// G10, G52, G92
  bool sets_offset() const {
    const NcCode other = code(NcGroup::non_modal);
    return other == 100 || other == 520 || other == 920;
  }
  /// G28, G30
  bool goes_to_reference() const {
    const NcCode other = code(NcGroup::non_modal);
    return other == 280 || other == 300;
  }
  /// G43.1, G43.2 without H
  bool says_tool_length() const {
    const NcCode length = code(NcGroup::tool_length);
    return length == 431 || (length == 432 && !has('h'));
  }
  bool has_free_axes() const {
    return axes != 0 && !sets_plane() && !sets_offset() && !goes_to_reference() && !says_tool_length();
  }
};

/// Sorts the codes of a block by their groups.
/// @throws InputError for a code that is not handled, and for two of one group
void sort_nc_codes(NcCodedBlock& block);

/// Axis word of a letter in lower case, or kAxisWords.
std::size_t nc_axis(char letter);

}  // namespace abbe
