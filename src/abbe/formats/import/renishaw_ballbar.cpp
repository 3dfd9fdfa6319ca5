// Result files of a Renishaw ball bar (.b5r) are recognised, and refused with what can be done instead: their public
// description has the figures that the program of the maker computed, and not the readings. See docs/import.md.
#include "abbe/formats/import/instrument_readers.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/text_blocks.h"

namespace abbe {
namespace {

constexpr std::size_t kLookedAtOfBallbar = std::size_t{1} << 20U;

/// Byte of the first <FEATURE NAME="..." DT="UT_...">, or npos.
std::size_t ballbar_feature(std::string_view text) {
  text = text.substr(0, kLookedAtOfBallbar);
  for (std::size_t at = text.find("<FEATURE "); at != std::string_view::npos; at = text.find("<FEATURE ", at + 1)) {
    const std::string_view tag = text.substr(at, text.find('>', at) - at);
    if (tag.find("NAME=") != std::string_view::npos && tag.find("DT=\"UT_") != std::string_view::npos) return at;
  }
  return std::string_view::npos;
}

}  // namespace

std::optional<Recognition> recognise_renishaw_ballbar(std::string_view text) {
  if (!csv_trimmed(text.substr(0, 100)).starts_with('<')) return std::nullopt;
  const std::size_t at = ballbar_feature(text);
  if (at == std::string_view::npos) return std::nullopt;
  return Recognition{"XML with elements FEATURE"};
}

InstrumentTable read_renishaw_ballbar(std::string_view text, const std::string& file, const ImportHints&) {
  const std::size_t at = ballbar_feature(text);
  throw InputError({.file = file, .line = at == std::string_view::npos ? 0 : text_line(text, at), .field = "FEATURE"},
                   "results of a Renishaw ball bar: where such a file has its readings is not publicly described",
                   "the readings as a table with direction, angle and deviation or radius (--as circular)");
}

}  // namespace abbe
