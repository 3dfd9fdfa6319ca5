#include "abbe/formats/nc/fanuc_blocks.h"

#include <fmt/format.h>

#include "abbe/formats/text/text_cursor.h"

namespace abbe {

bool next_fanuc_block(TableLines& lines, std::vector<FanucWord>& words) {
  words.clear();
  while (lines.next()) {
    const std::string_view block = without_blanks(lines.line().substr(0, lines.line().find(';')));
    if (block.empty() || block == "%") continue;
    for (std::size_t at = 0; at < block.size();) {
      std::size_t end = at + 1;
      while (end < block.size() && !(block[end] >= 'A' && block[end] <= 'Z')) ++end;
      words.push_back({block[at], without_blanks(block.substr(at + 1, end - at - 1))});
      at = end;
    }
    if (words[0].letter != 'N') lines.fail("", fmt::format("'{}' is not a block", shown_word(block)), "N12345...");
    return true;
  }
  return false;
}

std::string fanuc_real(double value) {
  const std::string number = trimmed_decimals(value, 6);
  return number.find('.') == std::string::npos ? number + ".0" : number;
}

}  // namespace abbe
