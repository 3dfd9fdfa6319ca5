#pragma once

// Internal to formats: points of files of instruments as rows of a table.
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/import/instrument_format.h"

namespace abbe {

/// The unit of coordinates, and how it is known.
struct PointUnit {
  std::string name = "mm";  ///< as in mapping files
  bool is_stated = false;
  std::string reason;  ///< "UNITS says MM"
  std::string doubt;   ///< where it is not stated
};

/// Collects points with names, and normals if all of them have one.
class InstrumentPoints {
 public:
  void add(std::string_view name, const std::array<std::string_view, 3>& coordinates, std::size_t line,
           const std::array<std::string_view, 3>* normal = nullptr);
  std::size_t count() const { return points_.size(); }
  bool empty() const { return points_.empty(); }
  void clear() { points_.clear(); }

  /// Writes columns and rows. @param names  what the file calls name, x, y and z, and the three of a normal
  void write(const PointUnit& unit, const std::vector<std::string>& names, InstrumentTable& table) const;

 private:
  struct Point {
    std::string name;
    std::array<std::string, 3> coordinates, normal;
    std::size_t line = 0;
  };
  std::vector<Point> points_;
};

}  // namespace abbe
