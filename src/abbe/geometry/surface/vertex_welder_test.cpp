#include "abbe/geometry/surface/vertex_welder.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <random>

namespace abbe {
namespace {

TEST(VertexWelder, NumbersCornersLikeASortedMapDoes) {
  std::mt19937_64 random(7);
  std::uniform_int_distribution<int> lattice(-20, 20);
  std::vector<double> corners;
  for (int i = 0; i < 60000; ++i) corners.push_back(0.1 * lattice(random));
  std::map<std::array<double, 3>, std::uint32_t> known;
  std::vector<std::uint32_t> expected;
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const std::array<double, 3> corner = {corners[i], corners[i + 1], corners[i + 2]};
    expected.push_back(known.emplace(corner, static_cast<std::uint32_t>(known.size())).first->second);
  }
  VertexWelder welder(1);
  std::vector<std::uint32_t> indices(expected.size());
  const std::size_t half = 3 * 7777;
  welder.add(std::span(corners).first(half), indices.data());
  welder.add(std::span(corners).subspan(half), indices.data() + half / 3);
  EXPECT_EQ(indices, expected);
  ASSERT_EQ(welder.size(), known.size());
  const Eigen::Matrix3Xd vertices = welder.vertices();
  for (std::size_t i = 0; i < indices.size(); ++i) {
    ASSERT_EQ(vertices.col(indices[i]), Eigen::Map<const Eigen::Vector3d>(&corners[3 * i]));
  }
}

TEST(VertexWelder, TheNumberOfCornersThatIsSaidBeforehandChangesNothing) {
  std::mt19937_64 random(8);
  std::uniform_int_distribution<int> coarse(0, 9), fine(0, 100000);
  std::vector<double> corners;
  // First many that come again, then hardly any.
  for (int i = 0; i < 9000; ++i) corners.push_back(i < 3000 ? coarse(random) : fine(random));
  std::vector<std::uint32_t> expected(3000);
  VertexWelder plain(1);
  plain.add(corners, expected.data());
  for (const std::size_t said : {std::size_t{1}, std::size_t{100}, std::size_t{3000}, std::size_t{1000000}}) {
    VertexWelder welder(1, said);
    std::vector<std::uint32_t> indices(3000);
    welder.add(corners, indices.data());
    EXPECT_EQ(indices, expected) << said;
    EXPECT_EQ(welder.vertices(), plain.vertices()) << said;
  }
}

TEST(VertexWelder, MinusZeroIsZeroAndTheLastBitKeepsApart) {
  const std::vector<double> corners = {0, 1, 2, -0.0, 1, 2, 0, std::nextafter(1.0, 2.0), 2};
  VertexWelder welder(3);
  std::array<std::uint32_t, 3> indices{};
  welder.add(corners, indices.data());
  EXPECT_EQ(indices, (std::array<std::uint32_t, 3>{0, 0, 1}));
  EXPECT_FALSE(std::signbit(welder.vertices()(0, 0)));
}

}  // namespace
}  // namespace abbe
