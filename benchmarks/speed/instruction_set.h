#pragma once

#include <hwy/highway.h>

#include <cstdio>
#include <cstring>

namespace abbe::benchmarks {

/// Takes `--avx2` from the arguments: vectors are then no wider than on a processor without AVX-512.
///
/// Only kernels that choose their instructions at run time are restricted; the baselines are compiled for every
/// processor, and do not change. @returns whether it was there
inline bool take_avx2(int& argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--avx2") != 0) continue;
    for (int k = i; k < argc; ++k) argv[k] = argv[k + 1];
    --argc;
    // Better targets have smaller numbers.
    hwy::SetSupportedTargetsForTest(hwy::SupportedTargets() & ~(HWY_AVX2 - 1));
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    std::printf("instructions: %s\n", hwy::TargetName(hwy::SupportedTargets() & -hwy::SupportedTargets()));
    return true;
  }
  return false;
}

}  // namespace abbe::benchmarks
