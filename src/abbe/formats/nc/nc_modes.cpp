#include "abbe/formats/nc/nc_modes.h"

#include "abbe/formats/nc/nc_word_text.h"

namespace abbe {

void NcModes::take_feed(const NcCodedBlock& block) {
  if (block.has(NcGroup::feed_mode)) {
    const NcCode code = block.code(NcGroup::feed_mode);
    const FeedMode mode = code == 930   ? FeedMode::inverse_time
                          : code == 940 ? FeedMode::per_minute
                                        : FeedMode::per_revolution;
    // A feed of another kind is none.
    if (mode != feed_mode) feed = 0;
    feed_mode = mode;
  }
  if (block.has('f')) {
    feed = block.value('f');
    // As LinuxCNC does: F comes before G20 and G21 of the same block.
    feed_inches = inches;
  }
}

void NcModes::take(const NcCodedBlock& block) {
  if (block.has(NcGroup::plane)) {
    const NcCode code = block.code(NcGroup::plane);
    plane = code == 170 ? ArcPlane::XY : code == 180 ? ArcPlane::ZX : ArcPlane::YZ;
  }
  if (block.has(NcGroup::units)) inches = block.code(NcGroup::units) == 200;
  if (block.has(NcGroup::distance)) absolute = block.code(NcGroup::distance) == 900;
  if (block.has(NcGroup::arc_centre)) arc_absolute = block.code(NcGroup::arc_centre) == 901;
  if (block.has(NcGroup::retract)) retract_to_r = block.code(NcGroup::retract) == 990;
}

void NcPathMode::take(const NcCodedBlock& block) {
  const NcCode code = block.code(NcGroup::path);
  if (code == kNoCode) return;
  is_exact_ = code == 610;
  stops_in_corners_ = code == 611;
  words_.clear();
  append_nc_word(words_, block, block.word(NcGroup::path));
  for (const char letter : {'p', 'q'}) {
    if (code == 640 && block.has(letter)) append_nc_word(words_, block, block.word(letter));
  }
}

void NcSpindle::take(const NcCodedBlock& block) {
  if (block.has('s')) speed_ = block.value('s');
  // LinuxCNC 2.9 stops it for the change.
  if (block.has(NcMGroup::tool) && block.word(NcMGroup::tool).value == 6) direction_ = 0;
  if (block.has(NcMGroup::spindle)) {
    const double code = block.word(NcMGroup::spindle).value;
    direction_ = code == 3 || code == 4 ? static_cast<int>(code) : 0;
  }
  if (block.has(NcMGroup::overrides)) {
    const double code = block.word(NcMGroup::overrides).value;
    if (code == 48 || code == 49) overrides_ = code == 48;
  }
}

}  // namespace abbe
