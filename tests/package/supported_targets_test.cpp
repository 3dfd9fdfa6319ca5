// The static programs choose the code for the processor as those with Highway's own library do.
#include "supported_targets.h"

#include <gtest/gtest.h>

namespace abbe {
namespace {

TEST(SupportedTargets, AreThoseOfHighwaysLibrary) {
  const std::int64_t compiled = HWY_SSSE3 | HWY_SSE4 | HWY_AVX2 | HWY_AVX3;
  EXPECT_EQ(supported_targets() & compiled, hwy::SupportedTargets() & compiled);
  EXPECT_NE(supported_targets(), 0);
}

}  // namespace
}  // namespace abbe
