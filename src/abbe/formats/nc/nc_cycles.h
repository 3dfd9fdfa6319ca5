#pragma once

// Internal to formats: canned cycles of an NC program.
#include <cstddef>

#include "abbe/formats/nc/nc_codes.h"
#include "abbe/formats/nc/nc_moves.h"
#include "abbe/formats/nc/nc_state.h"
#include "abbe/formats/nc/nc_writer.h"

namespace abbe {

/// Canned cycles, expanded into moves and the blocks between them. Remembers the words of the last one, which the next
/// block of the same code need not say again.
class NcCycles {
 public:
  NcCycles(const NcState& state, NcMoves& moves, NcWriter& writer) : state_(state), moves_(moves), writer_(writer) {}

  /// @throws InputError
  void run(const NcCodedBlock& block, NcCode motion);

 private:
  /// Where the holes of one block begin and end along the axis of the tool, mm, of the control.
  struct Heights {
    std::size_t axis;
    double r, bottom;
    double clear;  ///< to which the cycle returns
  };

  void check(const NcCodedBlock& block) const;
  void take_words(const NcCodedBlock& block, NcCode motion, std::size_t depth);
  Heights heights(const NcCodedBlock& block, std::size_t depth) const;
  NcPlace above_next_hole(const NcCodedBlock& block, const Heights& heights) const;
  void drill(const NcCodedBlock& block, NcCode motion, const Heights& heights);
  void tap(const NcCodedBlock& block, NcCode motion, const Heights& heights);
  void peck(const NcCodedBlock& block, NcCode motion, const Heights& heights);
  void rapid_to(const NcCodedBlock& block, const Heights& heights, double height);
  void straight_to(const NcCodedBlock& block, const Heights& heights, double height,
                   SpindleMove spindle = SpindleMove::none);

  const NcState& state_;
  NcMoves& moves_;
  NcWriter& writer_;

  NcCode code_ = kNoCode;                             ///< of the last cycle
  double bottom_ = 0, r_ = 0, dwell_ = 0, step_ = 0;  ///< as written
  double level_ = 0;                                  ///< before the first of several cycles; mm, of the control
};

}  // namespace abbe
