#include "abbe/report/drawings/surface_data.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "abbe/geometry/surface/meshes_for_test.h"
#include "abbe/report/drawings/packed_numbers.h"

namespace abbe {
namespace {

/// Bytes of base64 text.
std::vector<std::uint8_t> bytes_of(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  unsigned held = 0, bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    held = held << 6U | static_cast<unsigned>(digits.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<std::uint8_t>(held >> bits & 0xffU));
    held &= (1U << bits) - 1U;
  }
  return bytes;
}

std::vector<int> words_of(const std::string& text, bool is_signed) {
  const std::vector<std::uint8_t> bytes = bytes_of(text);
  std::vector<int> words;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const int word = bytes[i] + 256 * bytes[i + 1];
    words.push_back(is_signed && word >= 32768 ? word - 65536 : word);
  }
  return words;
}

TEST(PackedNumbers, AreTheBytesInBase64) {
  // The examples of RFC 4648, section 10.
  for (const auto& [plain, expected] : std::vector<std::pair<std::string, std::string>>{
           {"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"foobar", "Zm9vYmFy"}}) {
    const std::vector<std::uint8_t> bytes(plain.begin(), plain.end());
    EXPECT_EQ(packed(std::span<const std::uint8_t>(bytes)), expected);
  }
  const std::array<std::int16_t, 3> numbers{-32768, -1, 258};
  EXPECT_EQ(words_of(packed(std::span<const std::int16_t>(numbers)), true), (std::vector<int>{-32768, -1, 258}));
  const std::array<std::uint32_t, 1> large{0x01020304U};
  EXPECT_EQ(bytes_of(packed(std::span<const std::uint32_t>(large))), (std::vector<std::uint8_t>{4, 3, 2, 1}));
}

TEST(SurfaceData, HoldsPlacesAndDeviationsToTheStatedSteps) {
  SurfacePicture part;
  part.mesh = block_for_test({1000, -5, 0}, {1030, 15, 10});
  part.triangles_of_part = 12;
  DeviationPicture deviation;
  deviation.limit_mm = 0.1;
  deviation.measured = 5;
  deviation.counted = 2;
  deviation.average.mean_mm = {0.01, -0.02, 0, 0, 0, 0, 7, -0.1};
  deviation.average.count = {3, 9, 3, 0, 2, 1, 4, 5};
  deviation.readings.foot.resize(3, 2);
  deviation.readings.foot << 1030, 1010.1234, 3, 15, 10, 0;
  deviation.readings.normal.resize(3, 2);
  deviation.readings.normal << 1, 0, 0, 0.6, 0, -0.8;
  deviation.readings.deviation_mm = {0.0333, -1e9};
  const nlohmann::json data = surface_data(part, &deviation);
  const double step = data.at("step_mm");
  EXPECT_NEAR(step, 30.0 / 65535, 1e-12);
  const std::vector<int> vertices = words_of(data.at("vertices"), false);
  ASSERT_EQ(vertices.size(), 24U);
  for (std::size_t i = 0; i < 24; ++i) {
    const double at = data.at("lower_mm").at(i % 3).get<double>() + step * vertices[i];
    EXPECT_NEAR(at, part.mesh.vertices(static_cast<Eigen::Index>(i % 3), static_cast<Eigen::Index>(i / 3)), step / 2);
  }
  const std::vector<int> corners = words_of(data.at("triangles"), false);
  ASSERT_EQ(corners.size(), 36U);
  EXPECT_EQ(corners[4], static_cast<int>(part.mesh.triangles(1, 1)));
  const double value_step = data.at("value_step_um");
  EXPECT_DOUBLE_EQ(value_step, 0.05);
  const std::vector<int> values = words_of(data.at("values"), true);
  EXPECT_EQ(values, (std::vector<int>{200, -400, 0, kNoDeviation, kNoDeviation, kNoDeviation, 32767, -2000}));
  const nlohmann::json& points = data.at("points");
  EXPECT_EQ(points.at("drawn"), 2);
  EXPECT_EQ(words_of(points.at("values"), true), (std::vector<int>{666, -32767}));
  EXPECT_EQ(bytes_of(points.at("normal")), (std::vector<std::uint8_t>{127, 0, 0, 0, 76, 256 - 102}));
}

TEST(SurfaceData, ManyVerticesGetLongerNumbersAndWrongLengthsAreRefused) {
  SurfacePicture part;
  part.mesh = sphere_for_test({0, 0, 0}, 5, 190);
  ASSERT_GT(part.mesh.vertices.cols(), 65536);
  const nlohmann::json data = surface_data(part, nullptr);
  EXPECT_EQ(bytes_of(data.at("triangles")).size(), static_cast<std::size_t>(12 * part.mesh.size()));
  EXPECT_FALSE(data.contains("points"));
  part.coverage = {1, 2};
  EXPECT_THROW(surface_data(part, nullptr), std::invalid_argument);
  DeviationPicture deviation;
  deviation.limit_mm = 1;
  part.coverage.clear();
  EXPECT_THROW(surface_data(part, &deviation), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
