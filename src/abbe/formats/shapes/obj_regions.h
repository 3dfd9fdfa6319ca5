#pragma once

// Internal to formats: which group, object and material each triangle of an OBJ file belongs to.
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace abbe {

/// A line "o", "g" or "usemtl": it counts for all triangles behind it.
struct ObjStatement {
  std::size_t scope = 0;      ///< 0: o, 1: g, 2: usemtl
  std::string_view name;      ///< the rest of the line; in the contents of the file
  std::size_t triangles = 0;  ///< of the same block in front of it
};

/// Numbers the combinations of object, group and material in the order of their first triangles. A combination that
/// comes again is the same region.
class ObjRegions {
 public:
  /// The next block of the file. @param triangles  of the block
  void add(const std::vector<ObjStatement>& statements, std::size_t triangles);

  bool any_statement() const { return any_statement_; }
  std::vector<std::uint32_t> region_of_triangle;
  /// "object / group / material", what is not stated left out; "unnamed" before the first statement. Each part is
  /// cut to 60 bytes.
  std::vector<std::string> names;

 private:
  void append(std::size_t triangles);

  static constexpr std::uint32_t kNone = 0xffffffffu;
  using Key = std::array<std::uint32_t, 3>;
  std::unordered_map<std::string_view, std::uint32_t> words_;
  std::array<std::string_view, 3> current_names_;
  Key current_{kNone, kNone, kNone};
  std::map<Key, std::uint32_t> regions_;
  bool any_statement_ = false;
};

}  // namespace abbe
