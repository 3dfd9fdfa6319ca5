#include "abbe/formats/shapes/e57_pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <vector>

#include "abbe/formats/files/crc32c.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

static_assert(std::endian::native == std::endian::little, "E57 files are little-endian, but for their checksums");

constexpr std::string_view kE57Signature = "ASTM-E57";
/// Pages that are checked together.
constexpr std::size_t kPagesTogether = 1024;

std::uint32_t stored_checksum(const char* at) {
  std::uint32_t value = 0;
  for (int k = 0; k < 4; ++k) value = value << 8U | static_cast<unsigned char>(at[k]);
  return value;
}

std::uint32_t checksum_of_page(const char* page) { return crc32c({page, kE57PageData}); }

}  // namespace

E57Pages::E57Pages(std::string_view contents, const std::string& file, int threads) : contents_(contents) {
  const auto refuse = [&](const char* field, const std::string& problem, const std::string& expected) {
    throw InputError({.file = file, .field = field}, problem, expected);
  };
  if (!contents.starts_with(kE57Signature)) refuse("", "this is not an E57 file", "'ASTM-E57' at its beginning");
  if (contents.size() < kE57PageBytes) {
    refuse("", fmt::format("the file ends at byte {}", contents.size()), "a page of 1024 bytes at least");
  }
  const auto header = [&](std::size_t at) {
    std::uint64_t value = 0;
    std::memcpy(&value, contents.data() + at, 8);
    return value;
  };
  const auto version = static_cast<std::uint32_t>(header(8) & 0xffffffffU);
  if (version != 1) refuse("version", fmt::format("at byte 8: {}", version), "1");
  if (header(40) != kE57PageBytes) refuse("page size", fmt::format("at byte 40: {}", header(40)), "1024 bytes");
  if (header(16) != contents.size() || contents.size() % kE57PageBytes != 0) {
    refuse("file length", fmt::format("at byte 16: {} bytes are stated in a file of {}", header(16), contents.size()),
           "the length of the file, in whole pages of 1024 bytes");
  }
  const std::size_t pages = contents.size() / kE57PageBytes;
  const std::size_t blocks = (pages + kPagesTogether - 1) / kPagesTogether;
  std::vector<std::size_t> damaged(blocks, pages);
  for_each_block(blocks, threads, [&](std::size_t block) {
    const std::size_t end = std::min(pages, (block + 1) * kPagesTogether);
    for (std::size_t i = block * kPagesTogether; i < end; ++i) {
      const char* const page = contents.data() + i * kE57PageBytes;
      if (checksum_of_page(page) == stored_checksum(page + kE57PageData)) continue;
      damaged[block] = i;
      return;
    }
  });
  if (const std::size_t first = *std::min_element(damaged.begin(), damaged.end()); first < pages) {
    const char* const page = contents.data() + first * kE57PageBytes;
    refuse("checksum",
           fmt::format("at byte {}: the file is damaged: {:08x} is stored for page {}",
                       first * kE57PageBytes + kE57PageData, stored_checksum(page + kE57PageData), first),
           fmt::format("{:08x}, the CRC-32C of its contents", checksum_of_page(page)));
  }
  const std::optional<std::uint64_t> begin = logical(header(24));
  if (!begin || *begin < kE57HeaderBytes || header(32) > size() - *begin || header(32) == 0) {
    refuse("XML section", fmt::format("at byte 24: {} bytes from byte {} on", header(32), header(24)),
           "a section in the file");
  }
  xml_begin_ = *begin;
  xml_size_ = header(32);
}

std::optional<std::uint64_t> E57Pages::logical(std::uint64_t physical) const {
  if (physical >= contents_.size() || physical % kE57PageBytes >= kE57PageData) return std::nullopt;
  return physical / kE57PageBytes * kE57PageData + physical % kE57PageBytes;
}

void E57Pages::copy(std::uint64_t begin, std::size_t count, char* out) const {
  assert(begin <= size() && count <= size() - begin);
  while (count > 0) {
    const std::size_t part = std::min<std::size_t>(count, kE57PageData - begin % kE57PageData);
    std::memcpy(out, contents_.data() + physical(begin), part);
    begin += part;
    out += part;
    count -= part;
  }
}

std::string E57Pages::xml() const {
  std::string text(static_cast<std::size_t>(xml_size_), '\0');
  copy(xml_begin_, text.size(), text.data());
  return text;
}

}  // namespace abbe
