#pragma once

// For tests: readers of forms of instruments by their names.
#include <string>
#include <string_view>

#include "abbe/formats/import/instrument_format.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {

inline InstrumentTable read_as(std::string_view format, const std::string& text, const ImportHints& hints = {}) {
  const std::string file = "t";
  return instrument_format_named(format)->read(text, file, hints);
}

inline std::string refusal_of(std::string_view format, const std::string& text, const ImportHints& hints = {}) {
  return message_of([&] { read_as(format, text, hints); });
}

}  // namespace abbe
