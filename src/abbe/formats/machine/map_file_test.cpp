#include "abbe/formats/machine/map_file.h"

#include <gmock/gmock.h>

#include <cstring>

#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

MapData map_of_six() {
  MapData map;
  for (int i = 0; i < 6; ++i) {
    map.points[0].push_back(10.0 * (i % 3));
    map.points[1].push_back(0);
    map.points[2].push_back(i < 3 ? 0 : 0.1);
  }
  map.fields.push_back({"C", Quantity::angle, "deg", {{0, 0, 0, 3.14159265358979323846, 0, 0}}});
  map.fields.push_back({"before", Quantity::length, "um", {map.points[2], map.points[1], map.points[0]}});
  map.grid = {3, 1, 2};
  return map;
}

std::vector<double> decoded(const std::string& text, const std::string& name) {
  const std::size_t at = text.find("Name=\"" + name + "\"");
  if (at == std::string::npos) return {};
  const std::size_t begin = text.find('>', at) + 1, end = text.find('<', begin);
  std::string bytes;
  std::uint32_t group = 0;
  int held = 0;
  for (std::size_t i = begin; i < end && text[i] != '='; ++i) {
    const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    group = group << 6 | static_cast<std::uint32_t>(alphabet.find(text[i]));
    if ((held += 6) >= 8) bytes += static_cast<char>(group >> (held -= 8) & 255U);
  }
  EXPECT_EQ((end - begin) % 4, 0U);
  std::uint64_t size = 0;
  std::memcpy(&size, bytes.data(), sizeof size);
  EXPECT_EQ(size, bytes.size() - sizeof size);
  std::vector<double> values(size / sizeof(double));
  std::memcpy(values.data(), bytes.data() + sizeof size, size);
  return values;
}

TEST(MapFile, CsvHasUnitsInItsHeaderAndExactNumbers) {
  const std::string text = map_csv(map_of_six());
  EXPECT_EQ(text.substr(0, text.find('\n')),
            "point_x_mm,point_y_mm,point_z_mm,C_deg,before_x_um,before_y_um,before_z_um");
  const CsvTable table = read_csv(text, "map.csv",
                                  {{"point_x", Quantity::length},
                                   {"point_y", Quantity::length},
                                   {"point_z", Quantity::length},
                                   {"C", Quantity::angle},
                                   {"before_x", Quantity::length},
                                   {"before_y", Quantity::length},
                                   {"before_z", Quantity::length}});
  EXPECT_EQ(table.columns[2].numbers, map_of_six().points[2]);
  EXPECT_EQ(table.columns[4].numbers, map_of_six().points[2]);
  EXPECT_EQ(table.columns[6].numbers, map_of_six().points[0]);
  EXPECT_DOUBLE_EQ(table.columns[3].numbers[3], 3.14159265358979323846);
}

TEST(MapFile, GridIsAStructuredVtkFile) {
  MapData map = map_of_six();
  ASSERT_TRUE(map_is_structured(map));
  const std::string text = map_vtk(map);
  EXPECT_NE(text.find("<StructuredGrid WholeExtent=\"0 2 0 1 0 0\">"), std::string::npos);
  const std::vector<double> points = decoded(text, "point (mm)"), before = decoded(text, "before (um)");
  ASSERT_EQ(points.size(), 18U);
  EXPECT_EQ(points[3], 10);
  EXPECT_EQ(points[11], 0.1);
  ASSERT_EQ(before.size(), 18U);
  EXPECT_EQ(before[5], 10000);
  EXPECT_DOUBLE_EQ(decoded(text, "C (deg)")[3], 180);
}

TEST(MapFile, ScatteredPointsAreAnUnstructuredVtkFile) {
  MapData map = map_of_six();
  map.grid = {};
  EXPECT_FALSE(map_is_structured(map));
  const std::string text = map_vtk(map);
  EXPECT_NE(text.find("<Piece NumberOfPoints=\"6\" NumberOfCells=\"6\">"), std::string::npos);
  EXPECT_EQ(decoded(text, "point (mm)").size(), 18U);
  map.grid = {2, 2, 2, 2};
  EXPECT_FALSE(map_is_structured(map));
}

TEST(MapFile, IsOfTheKindThatItsNameSays) {
  MapData map = map_of_six();
  EXPECT_EQ(map_text("a/map.csv", map), map_csv(map));
  EXPECT_EQ(map_text("map.vts", map), map_vtk(map));
  EXPECT_NO_THROW(require_map_name("map.csv", map));
  EXPECT_NO_THROW(require_map_name("map.vts", map));
  const auto message = [&](const std::string& name) { return message_of([&] { require_map_name(name, map); }); };
  EXPECT_THAT(message("map.vtu"), testing::HasSubstr("map.vtu: unknown kind of map file; expected a name ending in "
                                                     ".csv, or in .vts for these poses"));
  EXPECT_THAT(message("csv"), testing::HasSubstr("unknown kind"));
  map.grid.clear();
  EXPECT_NO_THROW(require_map_name("map.vtu", map));
  EXPECT_THAT(message("map.vts"), testing::HasSubstr("or in .vtu for these poses"));
}

}  // namespace
}  // namespace abbe
