#pragma once

// Internal to formats: what the XML section of an E57 file says of its scans.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "abbe/formats/shapes/e57_xml.h"
#include "abbe/geometry/rigid_transform.h"

namespace abbe {

/// What is wanted of a point, and which of the values in E57Scan::wanted it is.
enum E57Wanted : std::size_t { kE57Point = 0, kE57Normal = 3, kE57Invalid = 6, kE57WantedCount = 7 };

/// How the values of one field are stored.
struct E57Field {
  enum class Kind { integer, single_precision, double_precision, text };

  std::string name;
  Kind kind = Kind::double_precision;
  // Of integers, also scaled ones: value = (least + stored) * scale + offset.
  std::int64_t least = 0;
  std::uint64_t range = 0;  ///< largest stored value
  unsigned bits = 64;       ///< of one value; of a text at least 8
  double scale = 1;
  double offset = 0;
};

struct E57Scan {
  std::string name;  ///< for messages: "scan 2"
  std::uint64_t points = 0;
  std::uint64_t section = 0;  ///< byte of the file
  std::vector<E57Field> fields;
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  /// Indices in fields: coordinates x, y, z or range, azimuth, elevation; normal x, y, z; state. kNone where missing.
  std::array<std::size_t, kE57WantedCount> wanted{};
  bool is_spherical = false;
  RigidTransform file_from_scan;  ///< m

  bool has_normals() const { return wanted[kE57Normal] != kNone; }
};

/// The scans that have points. @throws InputError
std::vector<E57Scan> e57_scans(const E57Element& root, const std::string& file);

}  // namespace abbe
