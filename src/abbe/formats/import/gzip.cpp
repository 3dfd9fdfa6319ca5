#include "abbe/formats/import/gzip.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr std::size_t kUnpackedPiece = std::size_t{1} << 20;
constexpr int kGzipOnly = 15 + 16;  // inflateInit2: the largest window, with the header of gzip

/// zlib's state, freed on every path.
class Inflater {
 public:
  Inflater() { started_ = inflateInit2(&stream, kGzipOnly) == Z_OK; }
  ~Inflater() {
    if (started_) inflateEnd(&stream);
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  bool is_started() const { return started_; }

  z_stream stream{};

 private:
  bool started_ = false;
};

}  // namespace

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

std::string unpacked_gzip(std::string_view bytes, const std::string& file, std::size_t largest) {
  Inflater inflater;
  z_stream& stream = inflater.stream;
  if (!inflater.is_started()) throw InputError({.file = file}, "there is no memory to unpack it");
  std::string text;
  std::vector<char> piece(kUnpackedPiece);
  std::string_view rest = bytes;
  for (;;) {
    const std::size_t given = std::min<std::size_t>(rest.size(), std::numeric_limits<uInt>::max());
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(rest.data()));
    stream.avail_in = static_cast<uInt>(given);
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    const int code = inflate(&stream, Z_NO_FLUSH);
    rest.remove_prefix(given - stream.avail_in);
    text.append(piece.data(), piece.size() - stream.avail_out);
    if (text.size() > largest) {
      throw InputError({.file = file}, fmt::format("unpacks to more than {} bytes", largest),
                       "a smaller file, or one that is not compressed");
    }
    if (code == Z_STREAM_END) {
      if (rest.empty()) return text;
      if (!is_gzip(rest) || inflateReset(&stream) != Z_OK) {
        throw InputError({.file = file}, "there are other bytes behind the compressed data", "a whole gzip file");
      }
      continue;
    }
    if (code == Z_BUF_ERROR || (code == Z_OK && rest.empty() && stream.avail_out > 0)) {
      throw InputError({.file = file}, "the compressed data are cut short", "a whole gzip file");
    }
    if (code != Z_OK) {
      throw InputError(
          {.file = file},
          fmt::format("the compressed data are damaged: {}", stream.msg == nullptr ? "not gzip" : stream.msg),
          "a whole gzip file");
    }
  }
}

}  // namespace abbe
