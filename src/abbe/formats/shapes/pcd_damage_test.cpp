// Damaged and hostile PCD files: an InputError that names the place, never a crash, a large allocation or points lost.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "abbe/formats/shapes/pcd_file.h"
#include "abbe/formats/shapes/pcd_for_test.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const std::string kPcdHead = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";

std::string pcd_message(const std::string& contents) {
  return message_of([&] { parse_point_cloud(contents, "a.pcd"); });
}

TEST(DamagedPcd, HeadersSayWhatIsWrong) {
  EXPECT_EQ(pcd_message("hello\n"),
            "a.pcd:1:1: 'hello' in the header; expected VERSION, FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, "
            "POINTS or DATA");
  EXPECT_EQ(pcd_message("VERSION .8\n"), "a.pcd:1:1: VERSION: '.8'; expected .5, .6 or .7");
  EXPECT_EQ(pcd_message("VERSION .7\n"),
            "a.pcd:1:1: the header does not end; expected a line 'DATA ascii' or 'DATA binary'");
  EXPECT_EQ(pcd_message("SIZE 4 4 4\n"), "a.pcd:1:1: SIZE: stands before FIELDS");
  EXPECT_EQ(pcd_message("FIELDS x y z\nSIZE 4 4\n"),
            "a.pcd:2:1: SIZE: the line ends; expected 3 values, one for each field");
  EXPECT_EQ(pcd_message("FIELDS x y z\nSIZE 4 4 4 4\n"), "a.pcd:2:1: SIZE: '4' at the end of the line");
  EXPECT_EQ(pcd_message("FIELDS x y z\nSIZE 4 3 4\n"), "a.pcd:2:1: SIZE: '3'; expected 1, 2, 4 or 8 bytes");
  EXPECT_EQ(pcd_message("FIELDS x y z\nTYPE F f F\n"), "a.pcd:2:1: TYPE: 'f'; expected F, I or U");
  EXPECT_EQ(pcd_message("FIELDS x y z\nFIELDS x y z\n"), "a.pcd:2:1: FIELDS: is given twice");
  EXPECT_EQ(pcd_message("FIELDS x y z\nCOUNT 1 0 1\n"), "a.pcd:2:1: COUNT: 0 values; expected at least 1");
  EXPECT_EQ(pcd_message("FIELDS x y z\nSIZE 2 4 4\nPOINTS 1\nDATA binary\n1"),
            "a.pcd:4:1: SIZE: 2 bytes of a floating-point field x; expected 4 or 8");
  EXPECT_EQ(pcd_message(kPcdHead + "DATA ascii\n1 2 3\n"),
            "a.pcd:6:1: POINTS: missing in the header; expected a line 'POINTS NUMBER'");
  EXPECT_EQ(pcd_message(kPcdHead + "WIDTH 3\nHEIGHT 2\nPOINTS 7\nDATA ascii\n1 2 3\n"),
            "a.pcd:8: POINTS: 7 points, but 3 in each of 2 rows; expected WIDTH times HEIGHT");
  EXPECT_EQ(pcd_message(kPcdHead + "POINTS 0\nDATA ascii\n1 2 3\n"),
            "a.pcd:6: POINTS: there are no points; expected at least one");
  EXPECT_EQ(pcd_message(kPcdHead + "POINTS -1\n"),
            "a.pcd:6:1: POINTS: '-1'; expected a whole number of at most 1000000000000000");
  EXPECT_EQ(pcd_message(kPcdHead + "POINTS 1\nDATA text\n1 2 3\n"),
            "a.pcd:7:1: DATA: 'text'; expected ascii, binary or binary_compressed");
  EXPECT_EQ(pcd_message("FIELDS x y\nPOINTS 1\nDATA ascii\n1 2\n"),
            "a.pcd: FIELDS: there is no field z; expected x y z");
  EXPECT_EQ(pcd_message("FIELDS x y z z\nPOINTS 1\nDATA ascii\n1 2 3 4\n"), "a.pcd: FIELDS: z is given twice");
  EXPECT_EQ(pcd_message("FIELDS x y z\nCOUNT 1 1 2\nPOINTS 1\nDATA ascii\n1 2 3 4\n"),
            "a.pcd: COUNT: z has 2 values; expected 1");
}

TEST(DamagedPcd, LinesSayWhatIsWrong) {
  const std::string head = kPcdHead + "POINTS 2\nDATA ascii\n";
  EXPECT_EQ(pcd_message(head + "1 2 3\n"),
            "a.pcd:6: POINTS: 2 are stated, but only 6 bytes are left for them; expected at least 6 bytes for each");
  EXPECT_EQ(pcd_message(head + "1.5 2.5 3.5\n"),
            "a.pcd: POINTS: 2 are stated, but the file ends after 1; expected a line for each");
  EXPECT_EQ(pcd_message(head + "1 2 3\n1 2 3\n1 2 3\n"),
            "a.pcd: POINTS: at byte 90: the file continues after its 2 points; expected the end of the file");
  EXPECT_EQ(pcd_message(head + "1 2 3\n1 2\n3\n"),
            "a.pcd:9:1: the line has 2 values; expected 3, as FIELDS and COUNT say");
  EXPECT_EQ(pcd_message(head + "1 2 3 4\n1 2 3\n"),
            "a.pcd:8:1: the line has more than 3 values; expected 3, as FIELDS and COUNT say");
  EXPECT_EQ(pcd_message(head + "1 2 3\n1 2,5 3\n"),
            "a.pcd:9:3: y: '2,5' is not a number; expected a number of at most 1e+09, or nan");
  EXPECT_EQ(pcd_message(head + "1 2 3\n1 2 3e9\n"),
            "a.pcd:9:5: z: 3e+09 is too large; expected a number of at most 1e+09");
  EXPECT_EQ(pcd_message(head + "1 2 3\n1 2 3e999\n"),
            "a.pcd:9:5: z: '3e999' is too large; expected a number of at most 1e+09, or nan");
}

TEST(DamagedPcd, NumbersThatPromiseTooMuchAreRefusedBeforeMemoryIsTaken) {
  for (const char* const points : {"3", "4000000000", "999999999999999"}) {
    EXPECT_THAT(pcd_message(kPcdHead + "POINTS " + points + "\nDATA binary\n" + std::string(35, 'x')),
                HasSubstr("POINTS: " + std::string(points) +
                          " are stated, but only 35 bytes are left for them; expected at least 12 bytes for each"));
    EXPECT_THAT(pcd_message(kPcdHead + "POINTS " + points + "\nDATA ascii\n1 2 3\n"),
                HasSubstr("are stated, but only 6 bytes are left for them"));
  }
  EXPECT_THAT(pcd_message(kPcdHead + "POINTS 999999999999999\nDATA binary_compressed\n" + std::string(35, 'x')),
              HasSubstr("are stated, but only 35 bytes are left for them; expected data that decompress to more"));
  EXPECT_THAT(pcd_message("FIELDS x y z a b\nSIZE 4 4 4 8 8\nCOUNT 1 1 1 1000000 1000000\nPOINTS 999999999999999\n"
                          "DATA binary\n" +
                          std::string(35, 'x')),
              HasSubstr("expected at least 16000012 bytes for each"));
}

TEST(DamagedPcd, BinaryFilesNameTheByte) {
  const std::vector<PcdFieldForTest> fields = {
      {"x", 'F', 8, 1, {1, 4}}, {"y", 'F', 8, 1, {2, 5e9}}, {"z", 'F', 8, 1, {3, 6}}};
  const std::size_t header = pcd_header_for_test(fields, 2, "binary").size();
  EXPECT_EQ(pcd_message(pcd_for_test(fields, 2, "binary")),
            "a.pcd: y: at byte " + std::to_string(header + 32) +
                ": point 1: 5e+09 is too large; expected a number of at most 1e+09");
  EXPECT_EQ(pcd_message(pcd_for_test(fields, 2, "binary_compressed")),
            "a.pcd: y: point 1: 5e+09 is too large; expected a number of at most 1e+09");
  std::string more = pcd_for_test({{"x", 'F', 4, 1, {1}}, {"y", 'F', 4, 1, {2}}, {"z", 'F', 4, 1, {3}}}, 1, "binary");
  EXPECT_EQ(parse_point_cloud(more + std::string("\0\0\n", 3), "a.pcd").cloud.size(), 1);
  EXPECT_THAT(pcd_message(more + "x"), HasSubstr("the file continues after its 1 points"));
  std::string sizes = pcd_header_for_test(fields, 2, "binary_compressed");
  EXPECT_THAT(pcd_message(sizes + "\x05"),
              HasSubstr("DATA: at byte 176: the file ends; expected two sizes of 4 bytes"));
  EXPECT_THAT(pcd_message(sizes + std::string("\x05\0\0\0\x30\0\0\0abcd", 12)),
              HasSubstr("5 bytes of compressed data are stated, but only 4 are left"));
  EXPECT_THAT(pcd_message(sizes + std::string("\x04\0\0\0\x31\0\0\0abcd", 12)),
              HasSubstr("the data decompress to 49 bytes; expected 48: 2 points of 24 bytes"));
  EXPECT_THAT(pcd_message(sizes + std::string("\x04\0\0\0\x30\0\0\0abcd", 12)),
              HasSubstr("the compressed data are damaged"));
}

TEST(DamagedPcd, CutOffAndChangedFilesAreRefusedOrHaveAllPoints) {
  constexpr std::size_t kPoints = 12;
  std::vector<double> numbers;
  for (std::size_t i = 0; i < kPoints; ++i) numbers.push_back(1.25 * static_cast<double>(i) - 3.1);
  const std::vector<PcdFieldForTest> fields = {{"x", 'F', 4, 1, numbers},
                                               {"rgb", 'U', 4, 1, std::vector<double>(kPoints, 255)},
                                               {"y", 'F', 8, 1, numbers},
                                               {"z", 'F', 4, 1, numbers}};
  for (const char* const form : {"ascii", "binary", "binary_compressed"}) {
    const std::string good = pcd_for_test(fields, kPoints, form);
    const auto read = [&](const std::string& contents) {
      try {
        const PointCloudFile file = parse_point_cloud(contents, "a.pcd");
        ASSERT_TRUE(file.cloud.points.allFinite());
        ASSERT_EQ(static_cast<std::size_t>(file.cloud.size()) + file.left_out, kPoints) << contents;
      } catch (const InputError&) {
      }
    };
    read(good);
    for (std::size_t length = 1; length < good.size(); ++length) read(good.substr(0, length));
    for (std::size_t i = 0; i < good.size(); ++i) {
      for (unsigned bit = 0; bit < 8; ++bit) {
        std::string damaged = good;
        damaged[i] = static_cast<char>(static_cast<unsigned char>(damaged[i]) ^ 1U << bit);
        read(damaged);
      }
    }
    std::mt19937_64 random(12);
    for (int i = 0; i < 3000; ++i) {
      std::string damaged = good;
      for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = static_cast<char>(random() & 0xffU);
      read(damaged);
    }
  }
}

}  // namespace
}  // namespace abbe
