#include "abbe/formats/shapes/pcd_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "abbe/formats/shapes/lzf.h"
#include "abbe/formats/shapes/pcd_for_test.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::ElementsAre;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Coordinates that a float has exactly, among fields of other kinds.
std::vector<PcdFieldForTest> many_fields(std::size_t points, int size) {
  std::mt19937_64 random(3);
  const auto values = [&](std::size_t count, double step) {
    std::vector<double> list;
    for (std::size_t i = 0; i < count; ++i) list.push_back(step * (static_cast<double>(random() % 4001) - 2000));
    return list;
  };
  std::vector<double> colours;
  for (std::size_t i = 0; i < points; ++i) colours.push_back(static_cast<double>(random() % 0xffffffU));
  return {{"rgb", 'U', 4, 1, colours},
          {"z", 'F', size, 1, values(points, 0.125)},
          {"_", 'U', 1, 3, std::vector<double>(3 * points, 0)},
          {"x", 'F', size, 1, values(points, 0.125)},
          {"histogram", 'F', 4, 5, values(5 * points, 0.5)},
          {"y", 'F', size, 1, values(points, 0.25)},
          {"_", 'U', 1, 1, std::vector<double>(points, 0)},
          {"ring", 'I', 2, 1, values(points, 1)}};
}

TEST(PcdFile, AllFormsHoldTheSamePointsAmongOtherFields) {
  constexpr std::size_t kPoints = 2500;
  for (const int size : {4, 8}) {
    const std::vector<PcdFieldForTest> fields = many_fields(kPoints, size);
    for (const auto& [form, name] : std::vector<std::pair<std::string, std::string>>{
             {"ascii", "PCD, ascii"}, {"binary", "PCD, binary"}, {"binary_compressed", "PCD, compressed"}}) {
      const PointCloudFile file = parse_point_cloud(pcd_for_test(fields, kPoints, form), "scan.pcd");
      EXPECT_EQ(file.format, name);
      EXPECT_EQ(unit_words(file.unit), "mm (assumed: the file states no unit)");
      ASSERT_EQ(file.cloud.size(), static_cast<Eigen::Index>(kPoints));
      EXPECT_FALSE(file.cloud.has_normals());
      EXPECT_THAT(file.notes, ElementsAre());
      for (std::size_t i = 0; i < kPoints; ++i) {
        ASSERT_EQ(file.cloud.points.col(static_cast<Eigen::Index>(i)),
                  Eigen::Vector3d(fields[3].values[i], fields[5].values[i], fields[1].values[i]))
            << form << " " << i;
      }
    }
  }
}

TEST(PcdFile, IntegersOfAllSizes) {
  for (const char type : {'I', 'U'}) {
    for (const int size : {1, 2, 4, 8}) {
      const double low = type == 'I' ? -100 : 100, high = type == 'I' ? 100 : 200;
      const std::vector<PcdFieldForTest> fields = {
          {"x", type, size, 1, {low, 1}}, {"y", type, size, 1, {high, 2}}, {"z", type, size, 1, {0, 3}}};
      for (const char* const form : {"ascii", "binary", "binary_compressed"}) {
        const PointCloudFile file = parse_point_cloud(pcd_for_test(fields, 2, form), "scan.pcd");
        EXPECT_EQ(file.cloud.points.col(0), Eigen::Vector3d(low, high, 0)) << type << size << form;
        EXPECT_EQ(file.cloud.points.col(1), Eigen::Vector3d(1, 2, 3));
      }
    }
  }
}

TEST(PcdFile, PointsThatWereNotMeasuredAreLeftOutAndCounted) {
  const double infinite = std::numeric_limits<double>::infinity();
  const std::vector<PcdFieldForTest> fields = {
      {"x", 'F', 4, 1, {1, kNan, 4, 7}}, {"y", 'F', 4, 1, {2, kNan, 5, 8}}, {"z", 'F', 4, 1, {3, kNan, -infinite, 9}}};
  for (const char* const form : {"ascii", "binary", "binary_compressed"}) {
    const PointCloudFile file = parse_point_cloud(pcd_for_test(fields, 4, form), "scan.pcd");
    ASSERT_EQ(file.cloud.size(), 2) << form;
    EXPECT_EQ(file.cloud.points.col(1), Eigen::Vector3d(7, 8, 9));
    EXPECT_EQ(file.left_out, 2U);
    EXPECT_THAT(file.notes, ElementsAre("2 points are left out: not all of their coordinates are finite numbers"));
    EXPECT_EQ(cloud_words(file), file.format + ", mm (assumed: the file states no unit); " + file.notes[0]);
  }
  EXPECT_EQ(message_of([] {
              parse_point_cloud(
                  "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
                  "POINTS 1\nDATA ascii\nnan nan nan\n",
                  "a.pcd");
            }),
            "a.pcd: none of the 1 points has coordinates; expected at least one point");
}

TEST(PcdFile, NormalsAreReadIfAllPointsHaveThem) {
  std::vector<PcdFieldForTest> fields = {{"x", 'F', 8, 1, {1, 4}},        {"y", 'F', 8, 1, {2, 5}},
                                         {"z", 'F', 8, 1, {3, 6}},        {"normal_x", 'F', 4, 1, {0, 3}},
                                         {"normal_y", 'F', 4, 1, {0, 0}}, {"normal_z", 'F', 4, 1, {-1, 4}},
                                         {"curvature", 'F', 4, 1, {0, 0}}};
  for (const char* const form : {"ascii", "binary", "binary_compressed"}) {
    const PointCloudFile file = parse_point_cloud(pcd_for_test(fields, 2, form), "scan.pcd");
    ASSERT_TRUE(file.cloud.has_normals()) << form;
    EXPECT_EQ(file.cloud.normals.col(0), Eigen::Vector3d(0, 0, -1));
    EXPECT_LT((file.cloud.normals.col(1) - Eigen::Vector3d(0.6, 0, 0.8)).norm(), 1e-15);
  }
  fields[5].values[1] = kNan;
  const PointCloudFile without = parse_point_cloud(pcd_for_test(fields, 2, "binary"), "scan.pcd");
  EXPECT_EQ(without.cloud.size(), 2);
  EXPECT_FALSE(without.cloud.has_normals());
  EXPECT_EQ(without.left_out, 0U);
  EXPECT_THAT(without.notes, ElementsAre("the normals of the file are not used: 1 point has none"));
  fields.erase(fields.begin() + 4);
  EXPECT_EQ(message_of([&] { parse_point_cloud(pcd_for_test(fields, 2, "ascii"), "a.pcd"); }),
            "a.pcd: FIELDS: there is only a part of a normal; expected normal_x normal_y normal_z or none of them");
}

TEST(PcdFile, TheUnitIsGivenAndTheViewpointIsNotApplied) {
  PointCloudOptions options;
  options.unit = FileLength::metre;
  const PointCloudFile file = parse_point_cloud(
      "VERSION .7\r\nFIELDS x y z\r\nSIZE 4 4 4\r\nTYPE F F F\r\nCOUNT 1 1 1\r\nWIDTH 2\r\nHEIGHT 1\r\n"
      "VIEWPOINT 10 20 30 0 1 0 0\r\nPOINTS 2\r\nDATA ascii\r\n1 2 3\r\n\r\n0.5\t-1e-1 +7 \r\n\r\n",
      "scan.PCD", options);
  EXPECT_EQ(unit_words(file.unit), "m (as given)");
  EXPECT_EQ(file.cloud.points.col(0), Eigen::Vector3d(1000, 2000, 3000));
  EXPECT_EQ(file.cloud.points.col(1), Eigen::Vector3d(500, -100, 7000));
}

TEST(PcdFile, OlderHeadersHaveFewerEntries) {
  const PointCloudFile file =
      parse_point_cloud("# .PCD v.5\nVERSION .5\nCOLUMNS x y z\nPOINTS 1\nDATA ascii\n1 2 3", "scan.pcd");
  EXPECT_EQ(file.cloud.points.col(0), Eigen::Vector3d(1, 2, 3));
  // Its contents tell what it is.
  EXPECT_EQ(parse_point_cloud("FIELDS x y z\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2 3", "scan.xyz").format, "PCD, ascii");
}

std::string decompressed(const std::string& compressed, std::size_t size) {
  std::string out(size, '?');
  return lzf_decompress(compressed, out) ? out : "refused";
}

TEST(Lzf, CopiesAreTakenFromWhatWasWritten) {
  EXPECT_EQ(decompressed({"\x00"
                          "a"
                          "\xe0\x00\x00",
                          5},
                         10),
            "aaaaaaaaaa");
  EXPECT_EQ(decompressed({"\x02"
                          "abc"
                          "\x20\x02",
                          6},
                         6),
            "abcabc");
  // As LibLZF writes it.
  const std::string_view hex = "17636f6f7264696e61746573206f662061207363616e2c2063e02216023b2030e0ff00e01a0002656e64";
  std::string bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
  }
  EXPECT_EQ(decompressed(bytes, 372),
            "coordinates of a scan, coordinates of a scan, coordinates of a scan; " + std::string(300, '0') + "end");
  EXPECT_EQ(decompressed("", 0), "");
}

TEST(Lzf, DamagedDataAreRefused) {
  EXPECT_EQ(decompressed({"\x00"
                          "a"
                          "\xe0\x00\x00",
                          5},
                         9),
            "refused");
  EXPECT_EQ(decompressed({"\x00"
                          "a"
                          "\xe0\x00\x00",
                          5},
                         11),
            "refused");
  EXPECT_EQ(decompressed({"\x00"
                          "a"
                          "\xe0\x00\x01",
                          5},
                         10),
            "refused");  // from before the beginning
  EXPECT_EQ(decompressed({"\x00"
                          "a"
                          "\xe0\x00",
                          4},
                         10),
            "refused");
  EXPECT_EQ(decompressed({"\x00"
                          "a"
                          "\xe0",
                          3},
                         10),
            "refused");
  EXPECT_EQ(decompressed({"\x05"
                          "abc",
                          4},
                         6),
            "refused");
}

TEST(Lzf, WhatWasCompressedForTestsComesBack) {
  std::mt19937_64 random(8);
  for (const unsigned kinds : {1U, 2U, 5U, 256U}) {
    for (const std::size_t size : {std::size_t{1}, std::size_t{33}, std::size_t{5000}, std::size_t{70000}}) {
      std::string data;
      for (std::size_t i = 0; i < size; ++i) data += static_cast<char>(random() % kinds);
      ASSERT_EQ(decompressed(lzf_for_test(data), size), data);
    }
  }
}

}  // namespace
}  // namespace abbe
