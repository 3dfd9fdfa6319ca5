#pragma once

// Internal to formats: moves of an NC program.
#include <cstddef>
#include <string>

#include "abbe/compensate/program/program_move.h"
#include "abbe/formats/nc/nc_codes.h"
#include "abbe/formats/nc/nc_flow.h"
#include "abbe/formats/nc/nc_program.h"
#include "abbe/formats/nc/nc_state.h"
#include "abbe/formats/nc/nc_writer.h"

namespace abbe {

/// Sends the axes where a block says, and gives the moves to the writer. Changes the position, no other state.
class NcMoves {
 public:
  NcMoves(NcState& state, NcFlow& flow, NcWriter& writer, const std::string& file, const NcProgramOptions& options);

  /// Where the axis words of the block lead. @throws InputError where they do not
  NcPlace target(const NcCodedBlock& block) const;
  void rapid(const NcCodedBlock& block, const NcPlace& target);
  void straight(const NcCodedBlock& block, const NcPlace& target, SpindleMove spindle = SpindleMove::none);

  /// G0 and G1, also with G53.
  void line(const NcCodedBlock& block, NcCode motion);
  /// G2 and G3
  void arc(const NcCodedBlock& block, NcCode motion);
  /// G33 and G33.1
  void thread(const NcCodedBlock& block, NcCode motion);
  /// G28 and G30
  void reference(const NcCodedBlock& block);

  /// @throws InputError if a move at work has no feed
  void check_feed(const NcCodedBlock& block, const char* what) const;

  /// Has X, Y, Z count in the tilted plane that has been said, with the rotary axes as they stand.
  void enter_plane(const NcCodedBlock& block);
  /// G53.1: turns the tool square to the plane.
  void turn_to_plane(const NcCodedBlock& block);

  /// First line with a move in a work offset that was taken for zero; 0: none.
  std::size_t first_assumed_offset_line() const { return first_assumed_offset_line_; }

 private:
  void emit(const NcCodedBlock& block, ProgramMove& move, const NcPlace& target);
  bool words_are_points() const { return state_.offsets.tool_centre() || options_.tool_centre; }

  NcState& state_;
  NcPosition& position_;  ///< of the state
  NcFlow& flow_;
  NcWriter& writer_;
  const std::string& file_;
  const NcProgramOptions& options_;
  std::size_t first_assumed_offset_line_ = 0;
};

}  // namespace abbe
