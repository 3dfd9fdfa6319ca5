#include "abbe/errors/random_stream.h"

#include <bit>
#include <cmath>

#include "abbe/geometry/mixed_bits.h"

namespace abbe {
namespace {

std::uint64_t splitmix(std::uint64_t& state) {
  const std::uint64_t number = mixed_bits(state);
  state += 0x9e3779b97f4a7c15U;
  return number;
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t stream) {
  std::uint64_t state = seed;
  // Mix before adding the stream, so that neighbouring seeds and streams do not meet.
  state = splitmix(state) ^ (stream * 0xd1342543de82ef95ULL);
  for (std::uint64_t& word : state_) word = splitmix(state);
}

std::uint64_t RandomStream::bits() {
  const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
  const std::uint64_t t = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= t;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double RandomStream::uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }

double RandomStream::normal() {
  if (has_kept_) {
    has_kept_ = false;
    return kept_;
  }
  double u, v, square;
  do {
    u = 2.0 * uniform() - 1.0;
    v = 2.0 * uniform() - 1.0;
    square = u * u + v * v;
  } while (square >= 1.0 || square == 0.0);
  const double factor = std::sqrt(-2.0 * std::log(square) / square);
  kept_ = v * factor;
  has_kept_ = true;
  return u * factor;
}

}  // namespace abbe
