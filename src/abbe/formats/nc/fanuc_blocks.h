#pragma once

// Internal to formats: the blocks of FANUC's parameter files.
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/table_numbers.h"

namespace abbe {

/// A letter and what follows it up to the next one: "N03624A1P50.0" is N 03624, A 1, P 50.0.
struct FanucWord {
  char letter = 0;
  std::string_view text;
};

/// The words of the next block, of which the first is N; "%", empty lines and what follows ";" are passed over.
/// @returns false at the end
/// @throws InputError
bool next_fanuc_block(TableLines& lines, std::vector<FanucWord>& words);

/// A number with a decimal point, which tells it from one in smallest increments; 6 decimals at most.
std::string fanuc_real(double value);

}  // namespace abbe
