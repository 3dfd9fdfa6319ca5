#pragma once

// Vectors are kept in structures here, which the sizeless vectors of SVE and RISC-V do not allow; processors with SVE
// have NEON too. SSSE3 without SSE4 is too rare to compile for: such processors take the scalar target.
#define ABBE_TARGETS_WITHOUT_USE (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#if defined(ABBE_SANITIZED)
// Instrumented vector code compiles very slowly: one vector target and the scalar one have all paths.
#define HWY_DISABLED_TARGETS (ABBE_TARGETS_WITHOUT_USE | HWY_SSE4 | HWY_AVX3)
#else
#define HWY_DISABLED_TARGETS ABBE_TARGETS_WITHOUT_USE
#endif
