#pragma once

#include <cstddef>
#include <string_view>

#include "abbe/runtime/frozen_machine.h"

namespace abbe {

/// What became of a file; `field` names what is not usable, empty where the result says all.
struct FrozenFile {
  int result = 0;  ///< ABBE_OK or ABBE_FILE_...
  std::string_view field;
};

/// Checks every value of a file and prepares it in one allocation (std::malloc; to be freed by abbe_runtime_free).
FrozenFile read_frozen(const unsigned char* bytes, std::size_t size, abbe_runtime*& runtime) noexcept;

}  // namespace abbe
