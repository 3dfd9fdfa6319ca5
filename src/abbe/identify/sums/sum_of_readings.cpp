#include "abbe/identify/sums/sum_of_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "abbe/geometry/cross_products.h"
#include "abbe/identify/sums/byte_stream.h"

namespace abbe {
namespace {

const std::string kSumFormat = "sum of readings";
constexpr std::uint64_t kSumVersion = 1;

std::string words_of(PieceRange range) {
  return range.count() == 1 ? fmt::format("piece {}", range.first)
                            : fmt::format("pieces {} to {}", range.first, range.last - 1);
}

void refuse_if_of_others(const SumOfReadings& first, const SumOfReadings& second) {
  const auto refuse = [&](const std::string& what) {
    throw SumError(fmt::format("the sums of {} and of {} {}", words_of(first.range), words_of(second.range), what));
  };
  if (first.kind != second.kind)
    refuse(fmt::format("do not go together: {} and {}", kind_words(first.kind), kind_words(second.kind)));
  if (first.point != second.point) refuse("are of different parameters");
  if (first.selection != second.selection) refuse("are of different selections of parameters or readings, or losses");
  if (first.pieces != second.pieces)
    refuse(fmt::format("are of different problems: of {} and of {} pieces", first.pieces, second.pieces));
  if (first.processor != second.processor)
    refuse(
        fmt::format("were made with different vector instructions, {} and {}: the last bits would depend on which "
                    "process sums what",
                    first.processor, second.processor));
}

}  // namespace

SumOfReadings begin_sum(const SumRequest& request) {
  SumOfReadings sum;
  sum.kind = request.kind;
  sum.point = point_fingerprint(request);
  sum.selection = selection_fingerprint(request);
  sum.processor = vector_instructions();
  sum.pieces = request.pieces;
  return sum;
}

SumOfReadings merge(SumOfReadings first, SumOfReadings second) {
  if (second.range.count() == 0) return first;
  if (first.range.count() == 0) return second;
  refuse_if_of_others(first, second);
  if (second.range.first != first.range.last)
    throw SumError(fmt::format("after the sum of {} that of piece {} was expected, not of {}", words_of(first.range),
                               first.range.last, words_of(second.range)));
  first.range.last = second.range.last;
  first.readings.insert(first.readings.end(), second.readings.begin(), second.readings.end());
  first.values.insert(first.values.end(), std::make_move_iterator(second.values.begin()),
                      std::make_move_iterator(second.values.end()));
  return first;
}

SumOfReadings merge_all(std::vector<SumOfReadings> parts) {
  std::erase_if(parts, [](const SumOfReadings& part) { return part.range.count() == 0; });
  if (parts.empty()) throw SumError("no pieces have been summed");
  std::sort(parts.begin(), parts.end(),
            [](const SumOfReadings& a, const SumOfReadings& b) { return a.range.first < b.range.first; });
  const std::size_t pieces = parts.front().pieces;
  std::size_t next = 0;
  for (const SumOfReadings& part : parts) {
    refuse_if_of_others(parts.front(), part);
    if (part.range.first > next)
      throw SumError(fmt::format("the sum of {} is missing", words_of({next, part.range.first})));
    if (part.range.first < next) {
      const PieceRange twice{part.range.first, std::min(next, part.range.last)};
      throw SumError(fmt::format("{} {} summed twice", words_of(twice), twice.count() == 1 ? "was" : "were"));
    }
    next = part.range.last;
  }
  if (next < pieces) throw SumError(fmt::format("the sum of {} is missing", words_of({next, pieces})));
  SumOfReadings whole = std::move(parts.front());
  whole.readings.reserve(pieces);
  whole.values.reserve(pieces);
  for (std::size_t i = 1; i < parts.size(); ++i) whole = merge(std::move(whole), std::move(parts[i]));
  return whole;
}

std::vector<std::byte> to_bytes(const SumOfReadings& sum) {
  ByteWriter out;
  out.put(kSumFormat);
  out.put(kSumVersion);
  out.put(static_cast<std::uint64_t>(sum.kind));
  out.put(sum.point);
  out.put(sum.selection);
  out.put(sum.processor);
  out.put(std::uint64_t{sum.pieces});
  out.put(std::uint64_t{sum.range.first});
  out.put(std::uint64_t{sum.range.last});
  out.put(sum.readings);
  for (const std::vector<double>& values : sum.values) out.put(values);
  return out.finish();
}

SumOfReadings sum_from_bytes(std::span<const std::byte> bytes) {
  ByteReader in(bytes, kSumFormat, kSumVersion);
  SumOfReadings sum;
  sum.kind = static_cast<SumKind>(in.number_up_to(static_cast<std::uint64_t>(SumKind::poses)));
  sum.point = in.number();
  sum.selection = in.number();
  sum.processor = in.text();
  sum.pieces = in.number();
  sum.range.first = in.number();
  sum.range.last = in.number_up_to(sum.pieces);
  sum.readings = in.numbers();
  if (sum.range.first > sum.range.last || sum.readings.size() != sum.range.count())
    in.fail("holds other pieces than it says");
  sum.values.resize(sum.range.count());
  for (std::vector<double>& values : sum.values) values = in.reals();
  in.end();
  return sum;
}

}  // namespace abbe
