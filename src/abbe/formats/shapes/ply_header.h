#pragma once

// Internal to formats: the header of a PLY file.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/file_unit.h"

namespace abbe {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class PlyForm { ascii, binary_little_endian, binary_big_endian };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count_type;  ///< of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
  std::size_t offset = 0;  ///< byte of its line

  /// Index of a property, or properties.size().
  std::size_t find(std::string_view property) const;
};

struct PlyHeader {
  PlyForm form = PlyForm::ascii;
  std::vector<PlyElement> elements;
  std::optional<FileLength> unit;  ///< of a line "comment unit mm"
  std::size_t data = 0;            ///< byte behind the header
};

/// Bytes of a type in a binary file.
std::size_t ply_type_size(PlyType type);
bool ply_type_is_integer(PlyType type);

/// @throws InputError
PlyHeader parse_ply_header(std::string_view contents, const std::string& file);

}  // namespace abbe
