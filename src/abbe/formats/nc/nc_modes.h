#pragma once

// Internal to formats: what is in force in an NC program.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "abbe/compensate/program/program_move.h"
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

/// The codes of one block, sorted.
struct NcCodes {
  std::array<NcCode, kNcGroups> code{};            ///< by group; kNoCode
  std::array<std::uint8_t, kNcGroups> place{};     ///< the word
  std::uint32_t axes = 0;                          ///< bits of the axis words
  std::array<std::uint8_t, kNcMGroups> m_place{};  ///< the word of an M code of each group, or kNoWord
  std::size_t m_count = 0;
  std::uint8_t cancel_place = NcBlock::kNoWord;  ///< the word G80 beside another code of the motion

  NcCode operator[](NcGroup group) const { return code[static_cast<std::size_t>(group)]; }
  bool has(NcGroup group) const { return (*this)[group] != kNoCode; }
  const NcWord& word(const NcBlock& block, NcGroup group) const {
    return block.words[place[static_cast<std::size_t>(group)]];
  }
  bool has(NcMGroup group) const { return m_place[static_cast<std::size_t>(group)] != NcBlock::kNoWord; }
  const NcWord& word(const NcBlock& block, NcMGroup group) const {
    return block.words[m_place[static_cast<std::size_t>(group)]];
  }
  bool is_m(const NcBlock& block, NcMGroup group, int number) const {
    return has(group) && std::lround(word(block, group).value) == number;
  }
};

/// Sorts the codes of a block by their groups.
/// @throws InputError for a code that is not handled, and for two of one group
void sort_nc_codes(const NcBlock& block, NcCodes& codes);

/// Axis word of a letter in lower case, or kAxisWords.
std::size_t nc_axis(char letter);

/// What is in force between blocks: LinuxCNC's state when a program begins.
struct NcModes {
  NcCode motion = 800;
  ArcPlane plane = ArcPlane::XY;
  bool absolute = true;
  bool arc_absolute = false;
  bool inches = false;
  bool retract_to_r = true;  ///< G99
  FeedMode feed_mode = FeedMode::per_minute;
  double feed = 0;                ///< F as it was written
  bool feed_inches = false;       ///< the unit in which it was
  bool tool_centre = false;       ///< G43.4
  std::size_t system = 0;         ///< G54 is 0
  bool stops_in_corners = false;  ///< G61.1
  bool exact_path = false;        ///< G61
};

}  // namespace abbe
