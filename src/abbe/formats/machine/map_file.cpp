#include "abbe/formats/machine/map_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>

#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {
namespace {

static_assert(std::endian::native == std::endian::little, "VTK files are written as LittleEndian");

double in_unit(double value, const Unit& unit) { return value / unit.factor * std::pow(10.0, -unit.decimal_shift); }

std::string base64(const std::string& bytes) {
  static constexpr char kAlphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k > bytes.size() - i ? '=' : kAlphabet[(group >> (18 - 6 * k)) & 63U];
    }
  }
  return text;
}

/// Number of bytes (UInt64), then the bytes: the inline binary form of VTK's XML files.
template <typename T>
std::string binary(const std::vector<T>& values) {
  const std::uint64_t size = values.size() * sizeof(T);
  std::string bytes(sizeof size + size, '\0');
  std::memcpy(bytes.data(), &size, sizeof size);
  if (size > 0) std::memcpy(bytes.data() + sizeof size, values.data(), size);
  return base64(bytes);
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

template <typename T>
std::string data_array(const char* type, const std::string& name, std::size_t components,
                       const std::vector<T>& values) {
  const std::string label = name.empty() ? "" : fmt::format(" Name=\"{}\"", escaped(name));
  return fmt::format("<DataArray type=\"{}\"{} NumberOfComponents=\"{}\" format=\"binary\">{}</DataArray>\n", type,
                     label, components, binary(values));
}

std::string point_data(const MapData& map) {
  std::string text = "<PointData>\n";
  for (const MapField& field : map.fields) {
    const Unit& unit = unit_named(field.quantity, field.unit);
    std::vector<double> values;
    values.reserve(map.count() * field.components.size());
    for (std::size_t i = 0; i < map.count(); ++i) {
      for (const std::vector<double>& component : field.components) values.push_back(in_unit(component[i], unit));
    }
    const std::string name = field.unit.empty() ? field.name : fmt::format("{} ({})", field.name, field.unit);
    text += data_array("Float64", name, field.components.size(), values);
  }
  return text + "</PointData>\n";
}

std::string points(const MapData& map) {
  std::vector<double> values;
  values.reserve(3 * map.count());
  for (std::size_t i = 0; i < map.count(); ++i) {
    for (const std::vector<double>& coordinate : map.points) values.push_back(coordinate[i]);
  }
  return "<Points>\n" + data_array("Float64", "point (mm)", 3, values) + "</Points>\n";
}

/// Points per direction of the grid without the directions of one point, filled up to three with 1.
std::array<std::size_t, 3> structured_counts(const MapData& map) {
  std::array<std::size_t, 3> counts = {1, 1, 1};
  std::size_t used = 0;
  for (const std::size_t count : map.grid) {
    if (count > 1) counts[used++] = count;
  }
  return counts;
}

void check([[maybe_unused]] const MapData& map) {
  [[maybe_unused]] const auto complete = [&](const std::vector<double>& values) {
    return values.size() == map.count();
  };
  assert(std::ranges::all_of(map.points, complete));
  assert(std::ranges::all_of(map.fields, [&](const MapField& field) {
    return (field.components.size() == 1 || field.components.size() == 3) &&
           std::ranges::all_of(field.components, complete);
  }));
}

}  // namespace

bool map_is_structured(const MapData& map) {
  if (map.grid.empty()) return false;
  std::size_t product = 1;
  for (const std::size_t count : map.grid) product *= count;
  return product == map.count() &&
         std::count_if(map.grid.begin(), map.grid.end(), [](std::size_t count) { return count > 1; }) <= 3;
}

std::string map_csv(const MapData& map) {
  check(map);
  std::string text = "point_x_mm,point_y_mm,point_z_mm";
  for (const MapField& field : map.fields) {
    const std::string unit = field.unit.empty() ? "" : "_" + field.unit;
    for (std::size_t k = 0; k < field.components.size(); ++k) {
      const std::string direction = field.components.size() == 1 ? "" : std::string("_") + "xyz"[k];
      text += "," + csv_field(field.name + direction + unit);
    }
  }
  text += '\n';
  for (std::size_t i = 0; i < map.count(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (k > 0) text += ',';
      text += shortest_text(map.points[k][i]);
    }
    for (const MapField& field : map.fields) {
      const Unit& unit = unit_named(field.quantity, field.unit);
      for (const std::vector<double>& component : field.components) {
        text += ',';
        text += quantity_text(component[i], unit);
      }
    }
    text += '\n';
  }
  return text;
}

std::string map_vtk(const MapData& map) {
  check(map);
  const bool structured = map_is_structured(map);
  const char* const type = structured ? "StructuredGrid" : "UnstructuredGrid";
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"{}\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n",
      type);
  if (structured) {
    const auto counts = structured_counts(map);
    const std::string extent = fmt::format("0 {} 0 {} 0 {}", counts[0] - 1, counts[1] - 1, counts[2] - 1);
    text += fmt::format("<StructuredGrid WholeExtent=\"{}\">\n<Piece Extent=\"{}\">\n", extent, extent);
    text += point_data(map) + points(map);
  } else {
    text += fmt::format("<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", map.count(),
                        map.count());
    text += point_data(map) + points(map);
    std::vector<std::int64_t> indices(map.count()), ends(map.count());
    for (std::size_t i = 0; i < map.count(); ++i) {
      indices[i] = static_cast<std::int64_t>(i);
      ends[i] = indices[i] + 1;
    }
    constexpr std::uint8_t kVertex = 1;
    text += "<Cells>\n" + data_array("Int64", "connectivity", 1, indices) + data_array("Int64", "offsets", 1, ends) +
            data_array("UInt8", "types", 1, std::vector<std::uint8_t>(map.count(), kVertex)) + "</Cells>\n";
  }
  return text + fmt::format("</Piece>\n</{}>\n</VTKFile>\n", type);
}

std::string map_text(const std::string& name, const MapData& map) {
  return std::filesystem::path(name).extension() == ".csv" ? map_csv(map) : map_vtk(map);
}

void require_map_name(const std::string& name, const MapData& map) {
  const std::string extension = std::filesystem::path(name).extension().string();
  const std::string vtk = map_is_structured(map) ? ".vts" : ".vtu";
  if (extension == ".csv" || extension == vtk) return;
  throw InputError({.file = name}, "unknown kind of map file",
                   "a name ending in .csv, or in " + vtk + " for these poses");
}

}  // namespace abbe
