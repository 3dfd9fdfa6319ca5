#pragma once

// Internal to formats: what of an NC program passes to the control.
#include <cstdint>
#include <string>
#include <string_view>

#include "abbe/formats/nc/nc_codes.h"
#include "abbe/formats/nc/nc_modes.h"
#include "abbe/formats/nc/nc_parameters.h"
#include "abbe/formats/nc/nc_writer.h"

namespace abbe {

/// Passes blocks to the control as they stand, or as what they result in: without the words of the moves, which are
/// written again, and with values for what was computed.
class NcPassThrough {
 public:
  NcPassThrough(NcWriter& writer, const NcParameters& parameters) : writer_(writer), parameters_(parameters) {}

  /// @param has_motion    the block moves the axes: what else it says goes before its first piece
  /// @param unit_changes  by a word of this block
  void block(const NcCodedBlock& block, const NcModes& modes, bool has_motion, bool unit_changes = false);
  /// The block with its code of offsets and axis words said in another way.
  /// @param replaced  letters of further words that belong to the code
  void block_with(const NcCodedBlock& block, const NcModes& modes, const std::string& code, std::string_view replaced);
  /// The comments of a block, each a line, or on the line of the next move.
  void comments(const NcBlock& block, bool as_lines);
  /// Parameters that the block has set and a later program may read.
  void assignments(const NcBlock& block);
  /// The stop of a block that moves: it holds when the motion is done, behind its last piece.
  void stop(const NcCodedBlock& block);

 private:
  void note_what_was_said(const NcCodedBlock& block, const NcModes& modes, bool has_motion);
  /// @param consumed  bits of the words that do not pass
  void append_words(const NcBlock& block, std::uint64_t consumed);
  std::string resolved(const NcBlock& block, std::string_view comment) const;

  NcWriter& writer_;
  const NcParameters& parameters_;
};

}  // namespace abbe
