#include "abbe/formats/readings/checked_parts.h"

#include "abbe/formats/readings/packed_lists.h"
#include "abbe/formats/readings/readings_bytes.h"

namespace abbe {

void CheckedParts::keep(const InstrumentReadings& part, std::size_t first, const std::vector<std::size_t>& at) {
  if (at.empty()) return;
  if (kept.count() == 0) {
    kept = part.subset(at);
  } else {
    kept.append(part.subset(at), true);
  }
  for (const std::size_t k : at) numbers.push_back(first + k);
}

void CheckedParts::pack(std::vector<std::byte>& bytes) const {
  pack_list(fingerprints, bytes);
  pack_list(numbers, bytes);
  outermost.pack(bytes);
  pack_readings(kept, bytes);
}

CheckedParts CheckedParts::unpack(std::span<const std::byte> bytes, std::size_t count) {
  CheckedParts parts;
  unpack_list(bytes, parts.fingerprints);
  unpack_list(bytes, parts.numbers);
  parts.outermost = OutermostReadings::unpack(bytes);
  parts.kept = unpack_readings(bytes);
  require_unpacked(bytes);
  if (parts.fingerprints.size() != count || parts.kept.count() != parts.numbers.size()) {
    throw WorkError("what was found in some parts of the files is of others");
  }
  return parts;
}

}  // namespace abbe
