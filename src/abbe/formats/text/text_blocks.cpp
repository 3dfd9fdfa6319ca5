#include "abbe/formats/text/text_blocks.h"

#include <algorithm>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 20;

}  // namespace

std::size_t text_block_end(std::string_view text, std::size_t begin) {
  const std::size_t end = std::min(begin + kBlockBytes, text.size());
  return end < text.size() ? std::min(text.find('\n', end), text.size() - 1) + 1 : end;
}

std::size_t text_line(std::string_view text, std::size_t offset) {
  return 1 +
         static_cast<std::size_t>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(offset), '\n'));
}

void throw_refusal(std::string_view text, const std::string& file, const TextRefusal& refusal) {
  const std::size_t line_end = refusal.offset == 0 ? std::string_view::npos : text.rfind('\n', refusal.offset - 1);
  const std::size_t column = refusal.offset - (line_end == std::string_view::npos ? 0 : line_end + 1) + 1;
  throw InputError({file, text_line(text, refusal.offset), column, refusal.field}, refusal.problem, refusal.expected);
}

}  // namespace abbe
