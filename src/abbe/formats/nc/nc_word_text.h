#pragma once

// Internal to formats: words of a block as they are written again.
#include <string>

#include "abbe/formats/nc/nc_block.h"

namespace abbe {

/// A value with at most 10 decimals and no exponent, which NC programs do not have.
std::string plain_nc_number(double value);

/// The word as it stands in the block, or with its value where that was computed; a blank before it if `text` has one
/// already.
void append_nc_word(std::string& text, const NcBlock& block, const NcWord& word);

}  // namespace abbe
