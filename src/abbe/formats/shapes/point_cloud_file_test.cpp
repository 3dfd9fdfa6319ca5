#include "abbe/formats/shapes/point_cloud_file.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {
namespace {

PointCloud cloud_with_normals(Eigen::Index n) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1000, 1000);
  PointCloud cloud{Eigen::Matrix3Xd(3, n), Eigen::Matrix3Xd(3, n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < 3; ++k) cloud.points(k, i) = uniform(random);
    cloud.normals.col(i) = Eigen::Vector3d(uniform(random), uniform(random), uniform(random)).normalized();
  }
  return cloud;
}

TEST(PointCloudFile, NamesOfPointsAreReadAndWrittenAgain) {
  const PointCloudFile read = parse_point_cloud("point,z_mm,x_mm,y_um\n\"a, b\",3,1,2000\n,6,4,5000\n", "names.csv");
  EXPECT_EQ(read.names, (std::vector<std::string>{"a, b", ""}));
  EXPECT_EQ(read.cloud.points.col(1), Eigen::Vector3d(4, 5, 6));
  const std::string text = point_cloud_csv(read.cloud, {0.5, 0.25}, read.names);
  EXPECT_EQ(text, "x_mm,y_mm,z_mm,deviation_mm,point\n1,2,3,0.5,\"a, b\"\n4,5,6,0.25,\"\"\n");
  EXPECT_EQ(parse_point_cloud(text, "names.csv").names, read.names);
  EXPECT_TRUE(parse_point_cloud("x_mm,y_mm,z_mm\n1,2,3\n", "none.csv").names.empty());
}

TEST(PointCloudFile, CsvAndPlyReadBackToTheSameBits) {
  const PointCloud cloud = cloud_with_normals(500);
  std::vector<double> deviation;
  for (int i = 0; i < 500; ++i) deviation.push_back(1e-3 * i / 3);
  const PointCloudFile csv = parse_point_cloud(point_cloud_csv(cloud, deviation), "scan.csv");
  EXPECT_EQ(csv.format, "CSV");
  EXPECT_EQ(unit_words(csv.unit), "mm (stated by the file)");
  EXPECT_EQ(csv.cloud.points, cloud.points);
  EXPECT_EQ(csv.cloud.normals, cloud.normals);
  EXPECT_EQ(csv.deviation_mm, deviation);
  PlyParts parts{cloud.points};
  parts.normals = cloud.normals;
  const PointCloudFile ply = parse_point_cloud(ply_bytes(parts), "scan.ply");
  EXPECT_EQ(ply.cloud.points, cloud.points);
  EXPECT_EQ(ply.cloud.normals, cloud.normals);
}

TEST(PointCloudFile, CsvColumnsHaveTheirOwnUnits) {
  const PointCloudFile file = parse_point_cloud("y_um,z_m,x_mm\n2500,0.001,3\n", "scan.csv");
  EXPECT_EQ(file.cloud.points.col(0), Eigen::Vector3d(3, 2.5, 1));
  EXPECT_FALSE(file.cloud.has_normals());
  PointCloudOptions options;
  options.in_plane = true;
  EXPECT_EQ(parse_point_cloud("y_um,x_mm\n2500,3\n", "scan.csv", options).cloud.points.col(0),
            Eigen::Vector3d(3, 2.5, 0));
  EXPECT_EQ(parse_point_cloud("y_um,x_mm,z_mm\n2500,3,4\n", "scan.csv", options).cloud.points(2, 0), 4);
  EXPECT_EQ(message_of([] { parse_point_cloud("y_um,x_mm\n2500,3\n", "scan.csv"); }),
            "scan.csv:1: z: missing column; expected z_mm, z_um or z_m");
  options.unit = FileLength::inch;
  EXPECT_EQ(message_of([&] { parse_point_cloud("x_mm,y_mm,z_mm\n1,2,3\n", "a.csv", options); }),
            "a.csv: unit: a CSV file states the unit of each column in its header; expected no unit");
  EXPECT_EQ(message_of([&] { parse_point_cloud("x_mm,y_mm,z_mm,nx\n1,2,3,1\n", "a.csv"); }),
            "a.csv: nx: a normal without all of its components; expected columns nx, ny, nz or none of them");
}

TEST(PointCloudFile, XyzTakesAllWaysToWriteADecimalNumber) {
  const PointCloudFile file = parse_point_cloud(
      "# scan\n// X Y Z\n\n1 2 3\r\n  -1.5\t+.25  1e2  \n1.234567890123456789e+02 0 -0\n7 8 9", "scan");
  EXPECT_EQ(file.format, "XYZ");
  EXPECT_EQ(unit_words(file.unit), "mm (assumed: the file states no unit)");
  ASSERT_EQ(file.cloud.size(), 4);
  EXPECT_EQ(file.cloud.points.col(1), Eigen::Vector3d(-1.5, 0.25, 100));
  EXPECT_EQ(file.cloud.points.col(2), Eigen::Vector3d(123.4567890123456789, 0, 0));
  EXPECT_EQ(file.cloud.points.col(3), Eigen::Vector3d(7, 8, 9));
  PointCloudOptions options;
  options.unit = FileLength::inch;
  EXPECT_EQ(parse_point_cloud("1 2 3\n", "scan.xyz", options).cloud.points.col(0), 25.4 * Eigen::Vector3d(1, 2, 3));
}

TEST(PointCloudFile, XyzWithUnitNormals) {
  const PointCloudFile file = parse_point_cloud("1 2 3 0 0 1\n4 5 6 0.6 0 -0.801\n", "scan.asc");
  ASSERT_TRUE(file.cloud.has_normals());
  EXPECT_EQ(file.cloud.normals.col(0), Eigen::Vector3d(0, 0, 1));
  EXPECT_NEAR(file.cloud.normals.col(1).norm(), 1, 1e-15);
  EXPECT_EQ(message_of([] { parse_point_cloud("1 2 3 255 128 0\n", "a.xyz"); }),
            "a.xyz:1:1: nx, ny, nz: the last three numbers have the length 285.323; expected a unit normal; other "
            "columns need a CSV file with a header");
}

TEST(PointCloudFile, XyzDoesNotDependOnTheNumberOfThreads) {
  const PointCloud cloud = cloud_with_normals(60000);
  std::string text;
  for (Eigen::Index i = 0; i < cloud.size(); ++i) {
    for (Eigen::Index k = 0; k < 3; ++k) text += shortest_text(cloud.points(k, i)) + (k < 2 ? " " : "\n");
  }
  ASSERT_GT(text.size(), std::size_t{5} << 19);  // several blocks
  for (const int threads : {1, 3}) {
    PointCloudOptions options;
    options.threads = threads;
    ASSERT_EQ(parse_point_cloud(text, "scan.xyz", options).cloud.points, cloud.points);
  }
  // The first bad line counts, wherever the blocks are.
  text.replace(text.find('\n', text.size() - 200) + 1, 3, "x y");
  const std::string early = text.replace(text.find('\n', 100) + 1, 3, "a b");
  EXPECT_EQ(message_of([&] { parse_point_cloud(early, "scan.xyz"); }).substr(0, 18), "scan.xyz:3:1: x: '");
}

TEST(PointCloudFile, BadLinesAreNamed) {
  EXPECT_EQ(message_of([] { parse_point_cloud("1 2 3\n1 2\n", "a.xyz"); }),
            "a.xyz:2:1: the line has 2 numbers; expected 3 as in the first line");
  EXPECT_EQ(message_of([] { parse_point_cloud("1 2 3\n1 2 3 4\n", "a.xyz"); }),
            "a.xyz:2:1: the line has 4 numbers; expected 3 as in the first line");
  EXPECT_EQ(message_of([] { parse_point_cloud("1 2 3\n1 inf 3\n", "a.xyz"); }),
            "a.xyz:2:3: y: 'inf' is not a finite number; expected a number of at most 1e+09");
  EXPECT_EQ(message_of([] { parse_point_cloud("1 2 3\n1 2e9 3\n", "a.xyz"); }),
            "a.xyz:2:3: y: '2e9' is too large; expected a number of at most 1e+09");
  EXPECT_EQ(message_of([] { parse_point_cloud("1 2 3 4\n", "a.xyz"); }),
            "a.xyz:1:1: the line has 4 numbers; expected 3: x y z, or 6: x y z and a unit normal; other columns need a "
            "CSV file with a header");
  EXPECT_EQ(message_of([] { parse_point_cloud("12,x 3 4\n", "a.xyz"); }),
            "a.xyz:1:1: x: '12,x' is not a number; expected numbers with a point between spaces; comma-separated "
            "values are read from .csv files with a header x_mm,y_mm,z_mm");
  EXPECT_EQ(message_of([] { parse_point_cloud("# nothing\n", "a.xyz"); }),
            "a.xyz: there are no points in the file; expected lines of three numbers");
}

TEST(PointCloudFile, VerticesOfAnObjFileWithTheirNormals) {
  const PointCloudFile file = parse_point_cloud("v 1 2 3\nvn 0 0 2\nv 4 5 6\nvn 0 3 0\n", "scan.obj");
  EXPECT_EQ(file.cloud.normals.col(1), Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(message_of([] { parse_point_cloud("v 1 2 3\nvn 0 0 0\n", "scan.obj"); }),
            "scan.obj: vn: normal 1 has no direction; expected a vector with a length");
}

}  // namespace
}  // namespace abbe
