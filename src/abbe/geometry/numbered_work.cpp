#include "abbe/geometry/numbered_work.h"

#include <cstring>
#include <mutex>

#include "abbe/geometry/parallel_blocks.h"

namespace abbe {

void work_in_threads(const NumberedWork& work) {
  std::vector<std::size_t> open;
  for (std::size_t block = 0; block < work.blocks; ++block) {
    if (!work.has(block)) open.push_back(block);
  }
  std::mutex one_at_a_time;
  for_each_block(open.size(), work.in_parallel ? work.threads : 1, [&](std::size_t i) {
    work.compute(open[i]);
    const std::lock_guard lock(one_at_a_time);
    if (work.finished) work.finished(open[i]);
    if (work.reduce) work.reduce(open[i]);
  });
}

void pack_numbers(std::span<const double> numbers, std::vector<std::byte>& bytes) {
  const auto* const first = reinterpret_cast<const std::byte*>(numbers.data());
  bytes.insert(bytes.end(), first, first + numbers.size_bytes());
}

void unpack_numbers(std::span<const std::byte>& bytes, std::span<double> numbers) {
  if (bytes.size() < numbers.size_bytes()) throw WorkError("results of a block are cut off");
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), numbers.size_bytes());
  bytes = bytes.subspan(numbers.size_bytes());
}

void require_unpacked(std::span<const std::byte> bytes) {
  if (!bytes.empty()) throw WorkError("results of a block are longer than the block");
}

}  // namespace abbe
