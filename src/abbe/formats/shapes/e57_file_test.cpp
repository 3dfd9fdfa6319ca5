#include "abbe/formats/shapes/e57_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "abbe/formats/shapes/e57_for_test.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<double> random_numbers(std::size_t count, double most, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-most, most);
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) numbers.push_back(uniform(random));
  return numbers;
}

E57ScanForTest float_scan(std::size_t points, bool is_single, unsigned seed) {
  E57ScanForTest scan;
  scan.points = points;
  for (const char* const name : {"cartesianX", "cartesianY", "cartesianZ"}) {
    scan.fields.push_back(e57_float_for_test(name, is_single, random_numbers(points, 20, seed++)));
  }
  return scan;
}

Eigen::Vector3d stored_point(const E57ScanForTest& scan, std::size_t i) {
  return {scan.fields[0].numbers[i], scan.fields[1].numbers[i], scan.fields[2].numbers[i]};
}

PointCloudFile read_e57(const std::vector<E57ScanForTest>& scans) {
  return parse_point_cloud(e57_for_test(scans), "scan.e57");
}

TEST(E57File, FloatsOfBothSizesInMetres) {
  for (const bool is_single : {true, false}) {
    E57ScanForTest scan = float_scan(3000, is_single, 1);
    scan.packets = 7;
    for (const bool with_others : {false, true}) {
      scan.with_other_packets = with_others;
      const PointCloudFile file = read_e57({scan});
      EXPECT_EQ(file.format, "E57, 1 scan");
      EXPECT_EQ(unit_words(file.unit), "m (stated by the file)");
      EXPECT_THAT(file.notes, ElementsAre());
      ASSERT_EQ(file.cloud.size(), 3000);
      for (std::size_t i = 0; i < 3000; ++i) {
        Eigen::Vector3d expected = stored_point(scan, i);
        if (is_single) expected = expected.cast<float>().cast<double>();
        ASSERT_EQ(file.cloud.points.col(static_cast<Eigen::Index>(i)), Eigen::Vector3d(1000 * expected));
      }
    }
  }
}

TEST(E57File, ScansAreJoinedByTheirPoses) {
  const E57ScanForTest first = float_scan(5, false, 1);
  E57ScanForTest second = float_scan(4, false, 10);
  second.pose =
      "<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">0.5</w><x type=\"Float\">-5e-01</x>"
      "<y type=\"Float\">5.0E-1</y><z type=\"Float\">\n0.5 </z></rotation><translation type=\"Structure\">"
      "<x type=\"Float\">1</x><y type=\"Float\"/><z type=\"ScaledInteger\" scale=\"0.5\" offset=\"1\">-8</z>"
      "</translation></pose>\n";
  const PointCloudFile file = read_e57({first, second});
  EXPECT_EQ(file.format, "E57, 2 scans");
  ASSERT_EQ(file.cloud.size(), 9);
  EXPECT_EQ(file.cloud.points.col(4), Eigen::Vector3d(1000 * stored_point(first, 4)));
  const Eigen::Quaterniond turn(0.5, -0.5, 0.5, 0.5);
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d expected = 1000 * (turn * stored_point(second, i) + Eigen::Vector3d(1, 0, -3));
    EXPECT_LT((file.cloud.points.col(static_cast<Eigen::Index>(5 + i)) - expected).norm(), 1e-10);
  }
}

TEST(E57File, IntegersOfAnyNumberOfBits) {
  constexpr std::size_t kPoints = 900;
  std::mt19937_64 random(4);
  for (int bits = 1; bits <= 64; ++bits) {
    const std::int64_t most = bits == 64 ? std::numeric_limits<std::int64_t>::max()
                                         : static_cast<std::int64_t>((std::uint64_t{1} << (bits - 1)) - 1);
    const std::int64_t least = bits == 64 ? std::numeric_limits<std::int64_t>::min() : -most - 1;
    std::vector<std::int64_t> values = {least, most};
    while (values.size() < kPoints) {
      values.push_back(static_cast<std::int64_t>(random() << (64 - bits)) >> (64 - bits));
    }
    const double step = std::ldexp(1.0, -bits);
    char scaling[80];
    std::snprintf(scaling, sizeof scaling, "scale=\"%.17g\" offset=\"2.5\"", step);
    E57ScanForTest scan;
    scan.points = kPoints;
    scan.packets = 5;
    scan.fields = {e57_integer_for_test("cartesianX", least, most, scaling, values),
                   e57_float_for_test("cartesianY", true, std::vector<double>(kPoints, 1)),
                   e57_integer_for_test("colorRed", 0, 255, "", std::vector<std::int64_t>(kPoints, 200)),
                   e57_integer_for_test("cartesianZ", -7, -7, "", std::vector<std::int64_t>(kPoints, -7))};
    const PointCloudFile file = read_e57({scan});
    ASSERT_EQ(file.cloud.size(), static_cast<Eigen::Index>(kPoints));
    for (std::size_t i = 0; i < kPoints; ++i) {
      const Eigen::Vector3d expected(1000 * (static_cast<double>(values[i]) * step + 2.5), 1000, -7000);
      ASSERT_EQ(file.cloud.points.col(static_cast<Eigen::Index>(i)), expected) << bits << " bits, point " << i;
    }
  }
}

TEST(E57File, SphericalCoordinates) {
  E57ScanForTest scan;
  scan.points = 4;
  const double turn = std::acos(-1.0) / 2;
  scan.fields = {e57_float_for_test("sphericalRange", false, {2, 3, 4, 5}),
                 e57_float_for_test("sphericalAzimuth", false, {0, turn, 0.3, 1}),
                 e57_float_for_test("sphericalElevation", false, {0, 0, turn, -0.5}),
                 e57_integer_for_test("sphericalInvalidState", 0, 2, "", {0, 0, 1, 0})};
  const PointCloudFile file = read_e57({scan});
  ASSERT_EQ(file.cloud.size(), 3);
  EXPECT_LT((file.cloud.points.col(0) - Eigen::Vector3d(2000, 0, 0)).norm(), 1e-11);
  EXPECT_LT((file.cloud.points.col(1) - Eigen::Vector3d(0, 3000, 0)).norm(), 1e-11);
  const Eigen::Vector3d last(std::cos(-0.5) * std::cos(1.0), std::cos(-0.5) * std::sin(1.0), std::sin(-0.5));
  EXPECT_LT((file.cloud.points.col(2) - 5000 * last).norm(), 1e-11);
  EXPECT_EQ(file.left_out, 1U);
}

TEST(E57File, PointsWithoutCoordinatesAreLeftOutAndCounted) {
  E57ScanForTest first = float_scan(6, false, 1);
  first.fields.push_back(e57_integer_for_test("cartesianInvalidState", 0, 2, "", {0, 2, 0, 1, 0, 0}));
  first.fields[2].numbers[4] = std::numeric_limits<double>::quiet_NaN();
  const E57ScanForTest second = float_scan(2, false, 5);
  const PointCloudFile file = read_e57({first, second});
  EXPECT_THAT(file.notes, ElementsAre("1 point is left out: not all of their coordinates are finite numbers",
                                      "2 points are left out: the file marks their coordinates as invalid"));
  EXPECT_EQ(file.left_out, 3U);
  ASSERT_EQ(file.cloud.size(), 5);
  EXPECT_EQ(file.cloud.points.col(1), Eigen::Vector3d(1000 * stored_point(first, 2)));
  EXPECT_EQ(file.cloud.points.col(2), Eigen::Vector3d(1000 * stored_point(first, 5)));
  EXPECT_EQ(file.cloud.points.col(3), Eigen::Vector3d(1000 * stored_point(second, 0)));
  first.fields[3].integers.assign(6, 2);
  EXPECT_EQ(message_of([&] { read_e57({first}); }),
            "scan.e57: none of the 6 points has coordinates; expected at least one point");
}

TEST(E57File, NormalsTurnWithTheirScan) {
  E57ScanForTest scan = float_scan(2, false, 1);
  for (const char* const axis : {"X", "Y", "Z"}) {
    const bool z = axis[0] == 'Z';
    scan.fields.push_back(e57_float_for_test(std::string("nor:normal") + axis, true, {z ? 2.0 : 0.0, 1.0}));
  }
  scan.pose =
      "<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">0</w><x type=\"Float\">1</x>"
      "</rotation></pose>\n";
  const PointCloudFile file = read_e57({scan});
  ASSERT_TRUE(file.cloud.has_normals());
  EXPECT_LT((file.cloud.normals.col(0) - Eigen::Vector3d(0, 0, -1)).norm(), 1e-15);
  EXPECT_LT((file.cloud.normals.col(1) - Eigen::Vector3d(1, -1, -1).normalized()).norm(), 1e-7);
  // Another prefix is the same extension, another extension is not.
  const auto renamed = [&](const std::string& uri) {
    E57ScanForTest other = scan;
    for (std::size_t k = 3; k < 6; ++k) other.fields[k].name.replace(0, 3, "n");
    return parse_point_cloud(e57_for_test({other}, " xmlns:n=\"" + uri + "\""), "scan.e57").cloud.has_normals();
  };
  EXPECT_TRUE(renamed("http://www.libe57.org/E57_NOR_surface_normals.txt"));
  EXPECT_FALSE(renamed("http://www.example.org/"));
  const PointCloudFile mixed = read_e57({scan, float_scan(3, false, 9)});
  EXPECT_FALSE(mixed.cloud.has_normals());
  EXPECT_THAT(mixed.notes, ElementsAre("the normals of the file are not used: 3 points have none"));
}

TEST(E57File, OtherFieldsArePassedOver) {
  E57ScanForTest scan = float_scan(40, false, 3);
  scan.packets = 3;
  scan.fields.insert(scan.fields.begin(), e57_text_for_test("label", 40));
  scan.fields.push_back(e57_integer_for_test("intensity", 0, 4095, "", std::vector<std::int64_t>(40, 77)));
  const PointCloudFile file = read_e57({scan});
  ASSERT_EQ(file.cloud.size(), 40);
  EXPECT_EQ(file.cloud.points(0, 39), 1000 * scan.fields[1].numbers[39]);
}

TEST(E57File, TheUnitIsTheMetre) {
  const std::string contents = e57_for_test({float_scan(2, false, 3)});
  PointCloudOptions options;
  options.unit = FileLength::millimetre;
  EXPECT_EQ(message_of([&] { parse_point_cloud(contents, "a.e57", options); }),
            "a.e57: unit: the file states m, but mm was given; expected the unit of the file, or none");
  options.unit = FileLength::metre;
  EXPECT_EQ(parse_point_cloud(contents, "a.e57", options).cloud.size(), 2);
  // The contents tell what it is.
  EXPECT_EQ(parse_point_cloud(contents, "a.xyz").format, "E57, 1 scan");
}

}  // namespace
}  // namespace abbe
