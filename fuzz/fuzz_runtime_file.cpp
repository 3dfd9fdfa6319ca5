// Frozen compensations: any bytes are refused, or give a handle whose calls stay finite and bounded. A fuzzer guesses
// no checksum, so the same bytes are tried once more with a header and a checksum that are right.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "abbe/runtime/abbe_runtime_states.h"
#include "abbe/runtime/frozen_layout.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

void check(const std::array<double, ABBE_RUNTIME_AXES>& values, int axes) {
  for (int i = 0; i < axes; ++i) require(std::abs(values[static_cast<std::size_t>(i)]) < 1e30);
}

/// The compensation at some states, all of which it takes.
void use(const abbe_runtime* runtime);

void use_states(const abbe_runtime* runtime) {
  abbe_runtime_states* states = nullptr;
  require(abbe_runtime_states_make(runtime, nullptr, &states) == ABBE_OK);
  std::array<double, ABBE_RUNTIME_STATES> channels{}, lags{};
  for (const double value : {20.0, -1e6, 1e300}) {
    channels.fill(value);
    require(abbe_runtime_states_advance(states, channels.data(), 1e4) == ABBE_OK);
    double behind = 0;
    require(abbe_runtime_states_get(states, channels.data(), lags.data(), nullptr, &behind) == ABBE_OK);
    require(behind >= 0);
    use(abbe_runtime_at_states(states));
  }
  abbe_runtime_states_free(states);
}

void use(const abbe_runtime* runtime) {
  abbe_runtime_information about;
  abbe_runtime_describe(runtime, &about);
  require(about.axes > 0 && about.axes <= ABBE_RUNTIME_AXES);
  abbe_runtime_state state;
  abbe_runtime_start(&state);
  for (const double at : {0.0, 0.4, -50.0, 300.0, 1e6}) {
    for (const double enable : {1.0, 0.3}) {
      std::array<double, ABBE_RUNTIME_AXES> nominal{}, joints{}, back{}, words{};
      std::array<double, 3> point{};
      for (int i = 0; i < about.axes; ++i) {
        abbe_runtime_axis axis;
        require(abbe_runtime_describe_axis(runtime, i, &axis) == ABBE_OK);
        nominal[static_cast<std::size_t>(i)] = axis.rotary != 0 ? 0.3 + at / 1000 : at;
      }
      double uncertainty = 0;
      require((abbe_runtime_uncertainty(runtime, nominal.data(), nullptr, &uncertainty) >= 0) ==
              (about.has_uncertainty != 0));
      require(uncertainty >= 0 && uncertainty <= 1.1e6);
      abbe_runtime_correct(runtime, &state, nominal.data(), nullptr, enable, joints.data());
      require(state.iterations <= ABBE_RUNTIME_ITERATIONS);
      check(joints, about.axes);
      abbe_runtime_uncorrect(runtime, &state, joints.data(), nullptr, enable, back.data());
      check(back, about.axes);
      if (abbe_runtime_forward(runtime, nullptr, joints.data(), nullptr, enable, point.data(), words.data()) < 0)
        continue;
      for (const double value : point) require(std::abs(value) < 1e30);
      check(words, about.axes);
      abbe_runtime_inverse(runtime, nullptr, point.data(), words.data(), nullptr, enable, joints.data());
      check(joints, about.axes);
    }
  }
}

/// @return ABBE_OK if the bytes were taken
int load(const std::vector<unsigned char>& bytes) {
  abbe_runtime* runtime = nullptr;
  char text[80];
  const int result = abbe_runtime_load(bytes.data(), bytes.size(), text, sizeof text, &runtime);
  require((runtime != nullptr) == (result == ABBE_OK));
  require(std::memchr(text, 0, sizeof text) != nullptr);
  if (runtime != nullptr) use(runtime);
  if (runtime != nullptr && abbe_runtime_channels(runtime) > 0) use_states(runtime);
  abbe_runtime_free(runtime);
  return result;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace abbe::frozen;
  std::vector<unsigned char> bytes(data, data + size);
  if (!bytes.empty() && load(bytes) == ABBE_OK) {
    // Every changed byte is refused.
    const std::size_t place = bytes[kChecksumAt] * bytes.size() / 256;
    bytes[place] = static_cast<unsigned char>(bytes[place] + 1);
    require(load(bytes) != ABBE_OK);
    return 0;
  }
  if (size < kHeaderBytes) return 0;
  bytes.resize(size - size % 8);
  std::memcpy(bytes.data(), kMagic, sizeof kMagic);
  std::memcpy(bytes.data() + kByteOrderAt, &kByteOrder, sizeof kByteOrder);
  const std::uint32_t format = bytes[kChecksumAt] % 2 == 0 ? kFormatWithStates : kFormatWithoutStates;
  std::memcpy(bytes.data() + kFormatAt, &format, sizeof format);
  const std::uint64_t count = (bytes.size() - kHeaderBytes) / 8;
  std::memcpy(bytes.data() + kCountAt, &count, sizeof count);
  const std::uint64_t sum = checksum(bytes.data(), bytes.size());
  std::memcpy(bytes.data() + kChecksumAt, &sum, sizeof sum);
  load(bytes);
  return 0;
}
