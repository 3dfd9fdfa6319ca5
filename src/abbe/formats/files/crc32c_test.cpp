#include "abbe/formats/files/crc32c.h"

#include <gtest/gtest.h>

#include <string>

namespace abbe {
namespace {

TEST(Crc32c, HasThePublishedValues) {
  // The check value of the catalogue of CRC algorithms; RFC 3720, B.4: 32 zeros.
  EXPECT_EQ(crc32c("123456789"), 0xe3069283U);
  EXPECT_EQ(crc32c(std::string(32, '\0')), 0x8a9136aaU);
}

}  // namespace
}  // namespace abbe
