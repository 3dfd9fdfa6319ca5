#pragma once

// Internal to formats: texts of many lines, read by several threads.
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// Where and why a line was refused.
struct TextRefusal {
  std::size_t offset = 0;  ///< byte in the text
  std::string field;
  std::string problem;
  std::string expected;
};

/// A run of whole lines and what went wrong in it first.
struct TextBlock {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::optional<TextRefusal> refusal;
};

/// End of a block of about 1 MiB that begins at `begin`: the end of a line, or of the text.
std::size_t text_block_end(std::string_view text, std::size_t begin);

/// Blocks from `begin` to the end of the text; they do not depend on the number of threads.
template <typename Block>
std::vector<Block> split_into_blocks(std::string_view text, std::size_t begin) {
  std::vector<Block> blocks;
  while (begin < text.size()) {
    Block& block = blocks.emplace_back();
    block.begin = begin;
    block.end = begin = text_block_end(text, begin);
  }
  return blocks;
}

/// Line of a byte, from 1.
std::size_t text_line(std::string_view text, std::size_t offset);

/// The refusal as InputError with line and column. @throws InputError
[[noreturn]] void throw_refusal(std::string_view text, const std::string& file, const TextRefusal& refusal);

}  // namespace abbe
