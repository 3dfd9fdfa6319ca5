#pragma once

// Internal to formats: codes of an NC program that change its offsets.
#include <cstddef>

#include "abbe/formats/nc/nc_codes.h"
#include "abbe/formats/nc/nc_pass_through.h"
#include "abbe/formats/nc/nc_state.h"
#include "abbe/formats/nc/nc_writer.h"

namespace abbe {

/// G10, G52 and G92 to G92.3: changes the offsets, and passes the block so that the control has the same. The position
/// counts from the new offsets once the block is done.
class NcOriginCodes {
 public:
  NcOriginCodes(NcState& state, NcPassThrough& pass, NcWriter& writer) : state_(state), pass_(pass), writer_(writer) {}

  /// @param moves  the block has a motion too
  /// @returns whether the offsets in force change @throws InputError
  bool run(const NcCodedBlock& block, bool moves);

 private:
  bool set_stored(const NcCodedBlock& block);
  void set_system_by_position(const NcCodedBlock& block, std::size_t system);
  void set_axis_offset(const NcCodedBlock& block, bool moves);
  void pass_axis_offset(const NcCodedBlock& block);
  /// The axis words of the block, mm and degrees.
  NcAxisValues axis_words(const NcCodedBlock& block) const;

  NcState& state_;
  NcPassThrough& pass_;
  NcWriter& writer_;
};

}  // namespace abbe
