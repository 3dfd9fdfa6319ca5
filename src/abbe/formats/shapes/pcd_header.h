#pragma once

// Internal to formats: the header of a PCD file.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

enum class PcdForm { ascii, binary, binary_compressed };

struct PcdField {
  std::string name;
  char type = 'F';         ///< F float, I signed, U unsigned
  std::size_t size = 4;    ///< bytes of one value
  std::size_t count = 1;   ///< values of one point
  std::size_t offset = 0;  ///< bytes before it in one point
  std::size_t words = 0;   ///< values before it in one point
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t points = 0;
  PcdForm form = PcdForm::ascii;
  std::size_t line = 0;         ///< of the number of points, from 1
  std::size_t data = 0;         ///< first byte after the header
  std::size_t point_bytes = 0;  ///< of all fields
  std::size_t point_words = 0;
};

/// True if the contents begin like a PCD file: the comment "# .PCD", or an entry of its header.
bool is_pcd(std::string_view contents);

/// @throws InputError
PcdHeader parse_pcd_header(std::string_view contents, const std::string& file);

}  // namespace abbe
