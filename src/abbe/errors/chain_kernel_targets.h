#pragma once

// Vectors are kept in structures here, which the sizeless vectors of SVE and RISC-V do not allow; processors with SVE
// have NEON too. SSSE3 without SSE4 is too rare to compile for: such processors take the scalar target.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
