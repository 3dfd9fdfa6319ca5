#include "abbe/study/results_of_items.h"

namespace abbe {

std::vector<ItemResult> results_of_items(const WorkDriver& driver, const NumberedItems& items) {
  std::vector<ItemResult> results(items.count);
  NumberedWork work{.name = items.name, .blocks = items.count, .threads = items.threads};
  work.in_parallel = items.in_parallel;
  work.for_all = items.for_all;
  work.is_kept = false;
  work.fingerprint = items.fingerprint;
  work.compute = [&](std::size_t item) { results[item] = items.compute(item); };
  work.pack = [&](std::size_t item, std::vector<std::byte>& bytes) {
    const ItemResult& result = results[item];
    const auto size = static_cast<double>(result.numbers.size());
    pack_numbers({&size, 1}, bytes);
    pack_numbers(result.numbers, bytes);
    const auto text = std::as_bytes(std::span(result.text));
    bytes.insert(bytes.end(), text.begin(), text.end());
  };
  work.unpack = [&](std::size_t item, std::span<const std::byte> bytes) {
    double size = 0;
    unpack_numbers(bytes, {&size, 1});
    if (!(size >= 0 && size <= static_cast<double>(bytes.size()))) throw WorkError("results of a block are cut off");
    results[item].numbers.resize(static_cast<std::size_t>(size));
    unpack_numbers(bytes, results[item].numbers);
    results[item].text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  do_work(driver, work);
  return results;
}

}  // namespace abbe
