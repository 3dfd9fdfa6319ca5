// Damaged and hostile E57 files: an InputError that names the place, never a crash, a large allocation or points lost.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "abbe/formats/shapes/e57_file.h"
#include "abbe/formats/shapes/e57_for_test.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::HasSubstr;

std::string e57_message(const std::string& contents) {
  return message_of([&] { parse_point_cloud(contents, "a.e57"); });
}

E57ScanForTest small_scan(std::size_t points) {
  E57ScanForTest scan;
  scan.points = points;
  scan.packets = 2;
  for (const char* const name : {"cartesianX", "cartesianY", "cartesianZ"}) {
    std::vector<double> values;
    for (std::size_t i = 0; i < points; ++i) values.push_back(0.5 + static_cast<double>(i * i % 17));
    scan.fields.push_back(e57_float_for_test(name, true, values));
  }
  return scan;
}

/// A file in which a text was replaced by one of the same length.
std::string replaced(std::string contents, const std::string& from, const std::string& to) {
  const std::size_t at = contents.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  contents.replace(at, from.size(), to);
  return e57_repaired_for_test(contents);
}

std::string with_number(std::string contents, std::size_t at, std::uint64_t value, std::size_t bytes = 8) {
  std::memcpy(contents.data() + at, &value, bytes);
  return e57_repaired_for_test(contents);
}

TEST(DamagedE57, TheHeaderSaysWhatIsWrong) {
  const std::string good = e57_for_test({small_scan(50)});
  ASSERT_EQ(good.size(), 2048U);
  EXPECT_EQ(e57_message("hello"), "a.e57: this is not an E57 file; expected 'ASTM-E57' at its beginning");
  EXPECT_EQ(e57_message("ASTM-E57"), "a.e57: the file ends at byte 8; expected a page of 1024 bytes at least");
  EXPECT_EQ(e57_message(with_number(good, 8, 2, 4)), "a.e57: version: at byte 8: 2; expected 1");
  EXPECT_EQ(e57_message(with_number(good, 40, 2048)), "a.e57: page size: at byte 40: 2048; expected 1024 bytes");
  EXPECT_EQ(e57_message(good.substr(0, 1024)),
            "a.e57: file length: at byte 16: 2048 bytes are stated in a file of 1024; expected the length of the file, "
            "in whole pages of 1024 bytes");
  EXPECT_EQ(e57_message(with_number(good, 32, 99999)),
            "a.e57: XML section: at byte 24: 99999 bytes from byte 704 on; expected a section in the file");
  EXPECT_THAT(e57_message(with_number(good, 24, 1021)), HasSubstr("bytes from byte 1021 on"));
  EXPECT_THAT(e57_message(with_number(good, 24, 1U << 30U)), HasSubstr("expected a section in the file"));
  std::string damaged = good;
  damaged[1500] ^= 1;
  EXPECT_THAT(e57_message(damaged), HasSubstr("a.e57: checksum: at byte 2044: the file is damaged: "));
  EXPECT_THAT(e57_message(damaged), HasSubstr(" is stored for page 1; expected "));
}

TEST(DamagedE57, TheXmlSectionSaysWhatIsWrong) {
  const std::string good = e57_for_test({small_scan(5)});
  EXPECT_THAT(e57_message(replaced(good, "</data3D>", "</data4D>")),
              HasSubstr("a.e57: XML section: in its line 16, column 3: mismatched tag; expected XML as ASTM E2807"));
  EXPECT_THAT(e57_message(replaced(good, "</e57Root>", "          ")),
              HasSubstr("the document ends within e57Root, so it is incomplete"));
  EXPECT_EQ(e57_message(replaced(good, "cartesianY", "cartesianQ")),
            "a.e57: scan 1: prototype: in line 5 of the XML section: it has 2 of three fields; expected cartesianX, "
            "cartesianY and cartesianZ, or none of them");
  EXPECT_EQ(e57_message(replaced(good, "type=\"Float\" precision=\"single\"", "type=\"Blobb\" precision=\"single\"")),
            "a.e57: scan 1: cartesianX: in line 8 of the XML section: type 'Blobb'; expected Integer, ScaledInteger, "
            "Float, String or Structure");
  EXPECT_THAT(e57_message(replaced(good, "recordCount", "recordsount")),
              HasSubstr("scan 1: recordCount: in line 6 of the XML section: missing; expected a whole number"));
  E57ScanForTest scan = small_scan(5);
  scan.count = "-5";
  EXPECT_THAT(e57_message(e57_for_test({scan})), HasSubstr("recordCount: in line 6 of the XML section: '-5'"));
  scan.count = "0";
  EXPECT_EQ(e57_message(e57_for_test({scan})), "a.e57: there are no points in the file; expected at least one point");
  EXPECT_EQ(e57_message(e57_for_test({})), "a.e57: there are no points in the file; expected at least one point");
  scan.count.clear();
  scan.pose = "<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">2</w></rotation></pose>";
  EXPECT_THAT(e57_message(e57_for_test({scan})),
              HasSubstr("scan 1: pose/rotation: in line 6 of the XML section: the quaternion has the length 2; "
                        "expected 1"));
  scan.pose = "<pose type=\"Structure\"><translation type=\"Structure\"><y type=\"Float\">nan</y></translation></pose>";
  EXPECT_THAT(e57_message(e57_for_test({scan})), HasSubstr("pose/translation/y: in line 6 of the XML section: 'nan'"));
  scan.pose = "<pose type=\"Structure\"><translation type=\"Structure\"><y type=\"Float\">1e7</y></translation></pose>";
  EXPECT_EQ(e57_message(e57_for_test({scan})),
            "a.e57: scan 1: y: point 0: 1e+10 mm is too large; expected at most 1e+09 mm");
}

TEST(DamagedE57, EntitiesAndDeepElementsAreRefused) {
  const std::string good = e57_for_test({small_scan(5)});
  const std::string start = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  std::string doctype = "<!DOCTYPE a [<!ENTITY b 'c'>]>";
  doctype.resize(start.size(), ' ');
  EXPECT_THAT(e57_message(replaced(good, start, doctype)), HasSubstr(": a DOCTYPE; expected XML"));
  E57ScanForTest deep = small_scan(5);
  for (int i = 0; i < 200; ++i) deep.pose += "<a>";
  for (int i = 0; i < 200; ++i) deep.pose += "</a>";
  EXPECT_THAT(e57_message(e57_for_test({deep})), HasSubstr("elements within more than 100 others"));
}

TEST(DamagedE57, SectionsSayWhatIsWrong) {
  // The section of the only scan begins at byte 48, its packets at byte 80.
  const std::string good = e57_for_test({small_scan(5)});
  EXPECT_THAT(e57_message(replaced(good, "fileOffset=\"48\"", "fileOffset=\"99\"")),
              HasSubstr("scan 1: points: at byte 99"));
  EXPECT_THAT(e57_message(replaced(good, "fileOffset=\"48\"", "fileOffset=\"9\" ")),
              HasSubstr("scan 1: fileOffset: byte 9 is not the start of a section"));
  EXPECT_EQ(e57_message(with_number(good, 48, 2, 1)),
            "a.e57: scan 1: points: at byte 48: a section of kind 2; expected 1, compressed vector");
  EXPECT_EQ(e57_message(with_number(good, 56, 1U << 20U)),
            "a.e57: scan 1: points: at byte 56: a section of 1048576 bytes; expected one that ends in the file");
  EXPECT_EQ(e57_message(with_number(good, 64, 48)),
            "a.e57: scan 1: points: at byte 64: packets from byte 48 on; expected a place in the section");
  EXPECT_EQ(e57_message(with_number(good, 80, 7, 1)),
            "a.e57: scan 1: points: at byte 80: a packet of kind 7; expected 0, 1 or 2");
  EXPECT_EQ(e57_message(with_number(good, 82, 1023, 2)),
            "a.e57: scan 1: points: at byte 82: a packet of 1024 bytes; expected a multiple of 4 of at most 88");
  EXPECT_EQ(e57_message(with_number(good, 84, 4, 2)),
            "a.e57: scan 1: points: at byte 84: 4 byte streams; expected 3, one for each field");
  EXPECT_EQ(e57_message(with_number(good, 86, 60, 2)),
            "a.e57: scan 1: points: at byte 80: 92 bytes of streams in a packet of 44; expected not more");
  EXPECT_THAT(e57_message(with_number(good, 86, 9, 2)),
              HasSubstr("scan 1: recordCount: 5 points are stated, but cartesianX has 19 bytes for them; expected 32 "
                        "bits for each"));
  EXPECT_EQ(e57_message(with_number(good, 80 + 44 + 1, 1, 1)),
            "a.e57: scan 1: points: at byte 125: the streams begin anew; expected streams that continue through all "
            "packets, as known programs write them");
}

TEST(DamagedE57, NumbersOfPointsAreThoseOfTheSection) {
  for (const char* const count : {"4", "6", "1000000000", "9223372036854775807"}) {
    E57ScanForTest scan = small_scan(5);
    scan.count = count;
    EXPECT_EQ(e57_message(e57_for_test({scan})), "a.e57: scan 1: recordCount: " + std::string(count) +
                                                     " points are stated, but cartesianX has 20 bytes for them; "
                                                     "expected 32 bits for each");
  }
  // Constants take no bytes.
  E57ScanForTest scan;
  for (const char* const name : {"cartesianX", "cartesianY", "cartesianZ"}) {
    scan.fields.push_back(e57_integer_for_test(name, 3, 3, "", {}));
  }
  scan.points = 100;
  EXPECT_EQ(parse_point_cloud(e57_for_test({scan}), "a.e57").cloud.size(), 100);
  scan.count = "1000000000000";
  EXPECT_THAT(e57_message(e57_for_test({scan})),
              HasSubstr("recordCount: 1000000000000 points are stated, all of which are the same"));
  scan.count = "9000";
  EXPECT_THAT(e57_message(e57_for_test({scan, scan, scan})), HasSubstr("all of which are the same"));
}

TEST(DamagedE57, ScansDoNotShareASection) {
  const std::string good = e57_for_test({small_scan(5), small_scan(5)});
  const std::size_t first = good.find("fileOffset=\"48\"");
  const std::size_t second = good.find("fileOffset=\"", first + 1);
  std::string shared = good;
  shared.replace(second, std::string("fileOffset=\"164\"").size(), "fileOffset=\"48\" ");
  EXPECT_EQ(e57_message(e57_repaired_for_test(shared)),
            "a.e57: scan 2: points: at byte 48: the section overlaps that of another scan; expected a section of its "
            "own");
}

TEST(DamagedE57, ValuesBeyondTheirMaximumAreRefused) {
  E57ScanForTest scan = small_scan(5);
  scan.fields[1] = e57_integer_for_test("cartesianY", 10, 15, "scale=\"1\"", {10, 11, 17, 12, 10});
  EXPECT_EQ(e57_message(e57_for_test({scan})),
            "a.e57: scan 1: points: at byte 116: a value of cartesianY in this packet is beyond its maximum; expected "
            "at most 5 above the minimum");
}

TEST(DamagedE57, EveryTruncationAndEveryFlippedBitIsSeen) {
  const std::string good = e57_for_test({small_scan(9)});
  const auto is_refused = [](const std::string& contents) {
    try {
      parse_e57(contents, "a.e57", {}, 1);
    } catch (const InputError&) {
      return true;
    }
    return false;
  };
  ASSERT_FALSE(is_refused(good));
  for (std::size_t length = 0; length < good.size(); ++length) ASSERT_TRUE(is_refused(good.substr(0, length)));
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::string damaged = good;
    damaged[bit / 8] = static_cast<char>(static_cast<unsigned char>(damaged[bit / 8]) ^ 1U << (bit % 8));
    ASSERT_TRUE(is_refused(damaged)) << bit;
  }
}

TEST(DamagedE57, ChangedFilesWithRightChecksumsAreRefusedOrHaveAllPoints) {
  E57ScanForTest second = small_scan(6);
  second.fields.push_back(e57_integer_for_test("cartesianInvalidState", 0, 2, "", {0, 1, 0, 2, 0, 0}));
  second.pose = "<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">1</w></rotation></pose>";
  const std::string good = e57_for_test({small_scan(9), second});
  std::mt19937_64 random(6);
  for (int i = 0; i < 20000; ++i) {
    std::string damaged = good;
    for (int k = 0; k < 1 + i % 3; ++k) damaged[random() % damaged.size()] = static_cast<char>(random() & 0xffU);
    try {
      const PointCloudFile file = parse_e57(e57_repaired_for_test(damaged), "a.e57", {}, 1);
      ASSERT_TRUE(file.cloud.points.allFinite());
      ASSERT_EQ(static_cast<std::size_t>(file.cloud.size()) + file.left_out, 15U);
    } catch (const InputError&) {
    }
  }
}

}  // namespace
}  // namespace abbe
