#pragma once

#include <hwy/targets.h>

#include <cstdint>

namespace abbe {

/// The bits of hwy::SupportedTargets() for which this project compiles code. The conditions are those that Highway's
/// detect_targets.h states for each.
inline std::int64_t supported_targets() {
  std::int64_t targets = HWY_ENABLED_BASELINE;
#if HWY_ARCH_X86
  const auto all = [](auto... has) { return ((has != 0) && ...); };
  if (!all(__builtin_cpu_supports("ssse3"))) return targets;
  targets |= HWY_SSSE3;
  if (!all(__builtin_cpu_supports("sse4.1"), __builtin_cpu_supports("sse4.2"), __builtin_cpu_supports("aes"),
           __builtin_cpu_supports("pclmul"))) {
    return targets;
  }
  targets |= HWY_SSE4;
  if (!all(__builtin_cpu_supports("avx2"), __builtin_cpu_supports("fma"), __builtin_cpu_supports("bmi"),
           __builtin_cpu_supports("bmi2"))) {
    return targets;
  }
#if !defined(__clang__)  // clang 14 does not know these names
  if (!all(__builtin_cpu_supports("lzcnt"), __builtin_cpu_supports("f16c"))) return targets;
#endif
  targets |= HWY_AVX2;
  if (!all(__builtin_cpu_supports("avx512f"), __builtin_cpu_supports("avx512bw"), __builtin_cpu_supports("avx512dq"),
           __builtin_cpu_supports("avx512vl"), __builtin_cpu_supports("avx512cd"))) {
    return targets;
  }
  targets |= HWY_AVX3;
#endif
  return targets;
}

}  // namespace abbe
