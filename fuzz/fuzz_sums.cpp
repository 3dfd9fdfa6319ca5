// Requests for sums and sums of readings from other processes: any bytes, with the check sum that belongs to them, give
// a value that is written as the same bytes, or a SumError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "abbe/identify/sums/byte_stream.h"
#include "abbe/identify/sums/sum_of_readings.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> bytes(size);
  for (std::size_t k = 0; k < size; ++k) bytes[k] = static_cast<std::byte>(data[k]);
  abbe::Digest digest;
  digest.add_bytes(bytes);
  for (std::size_t i = 0; i < 8; ++i) bytes.push_back(static_cast<std::byte>(digest.value() >> (8 * i)));
  try {
    if (abbe::to_bytes(abbe::request_from_bytes(bytes)) != bytes) std::abort();
  } catch (const abbe::SumError&) {
  }
  try {
    if (abbe::to_bytes(abbe::sum_from_bytes(bytes)) != bytes) std::abort();
  } catch (const abbe::SumError&) {
  }
  return 0;
}
