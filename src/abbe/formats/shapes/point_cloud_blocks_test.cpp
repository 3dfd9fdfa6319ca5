#include "abbe/formats/shapes/point_cloud_blocks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::HasSubstr;

Eigen::Matrix3Xd all_points(const std::string& contents, const std::string& name, std::size_t block) {
  const PointCloudBlocks blocks(contents, name);
  Eigen::Matrix3Xd all(3, 0);
  for (std::size_t at = blocks.begin(); at < blocks.end();) {
    const std::size_t end = blocks.block_end(at, block);
    EXPECT_GT(end, at);
    const CloudBlock found = blocks.read(at, end);
    EXPECT_EQ(blocks.count(at, end), static_cast<std::size_t>(found.points.cols()));
    all.conservativeResize(3, all.cols() + found.points.cols());
    all.rightCols(found.points.cols()) = found.points;
    at = end;
  }
  return all;
}

TEST(PointCloudBlocksOfAFile, HaveThePointsOfTheWhole) {
  std::string big(
      "ply\nformat binary_big_endian 1.0\ncomment unit m\nelement camera 2\nproperty uchar a\n"
      "element vertex 5\nproperty uchar red\nproperty short y\nproperty float x\nproperty int z\n"
      "end_header\nab");
  for (int i = 0; i < 5; ++i) {
    big += 'r';
    big += std::string{'\xff', static_cast<char>(0xf0 + i)};
    big += std::string{'\x3f', '\x80', '\x00', static_cast<char>(i)};
    big += std::string{'\x00', '\x00', '\x01', static_cast<char>(i)};
  }
  const std::string csv = "# c\nx_mm,z_um,y_mm,point\n1,2,3,a\n\n4,5,6,b\n7,8,9,c\n-1,0,2,d\n";
  const std::string xyz = "\xEF\xBB\xBF# c\n1 2 3 1 0 0\n4 5 6 0 0 1\n// d\n\n7 8 9 0 1 0";
  for (const auto& [text, name] : {std::pair{big, "a.ply"}, std::pair{csv, "a.csv"}, std::pair{xyz, "a.asc"}}) {
    ASSERT_TRUE(point_cloud_kind(text, name).in_blocks);
    const Eigen::Matrix3Xd whole = parse_point_cloud(text, name).cloud.points;
    for (const std::size_t block : {1U, 2U, 1000U}) EXPECT_EQ(all_points(text, name, block), whole) << name;
  }
  EXPECT_EQ(point_cloud_kind(big, "a.ply").points, 5U);
}

TEST(PointCloudBlocksOfAFile, RefuseWhatIsNoPoint) {
  EXPECT_THAT(message_of([] { all_points("1 2 3\n4 5\n", "a.xyz", 1); }), HasSubstr("a.xyz:2"));
  EXPECT_THAT(message_of([] { all_points("x_mm,y_mm\n1,2\n", "a.csv", 1); }), HasSubstr("z"));
  EXPECT_FALSE(point_cloud_kind("o part\nv 1 2 3\n", "a.obj").in_blocks);
}

}  // namespace
}  // namespace abbe
