#pragma once

// For tests: PCD files of any fields, and LZF data.
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// A greedy compressor, which writes runs of literals and copies of all lengths.
inline std::string lzf_for_test(std::string_view data) {
  std::string out, literals;
  const auto flush = [&] {
    if (literals.empty()) return;
    out += static_cast<char>(literals.size() - 1);
    out += literals;
    literals.clear();
  };
  std::vector<std::size_t> last(1U << 16U, static_cast<std::size_t>(-1));
  for (std::size_t at = 0; at < data.size();) {
    std::size_t length = 0, back = 0;
    if (at + 3 <= data.size()) {
      std::uint32_t key = 0;
      std::memcpy(&key, data.data() + at, 3);
      std::size_t& place = last[(key * 2654435761U) >> 16U];
      if (place < at && at - place <= 8192) {
        while (length < 264 && at + length < data.size() && data[place + length] == data[at + length]) ++length;
        back = at - place;
      }
      place = at;
    }
    if (length < 3) {
      literals += data[at++];
      if (literals.size() == 32) flush();
      continue;
    }
    flush();
    const std::size_t code = length - 2, offset = back - 1;
    out += static_cast<char>((code < 7 ? code : 7U) << 5U | offset >> 8U);
    if (code >= 7) out += static_cast<char>(code - 7);
    out += static_cast<char>(offset & 0xffU);
    at += length;
  }
  flush();
  return out;
}

/// One field of a PCD file with all its values, [points * count].
struct PcdFieldForTest {
  std::string name;
  char type = 'F';
  int size = 4;
  int count = 1;
  std::vector<double> values;
};

inline std::string pcd_value_for_test(const PcdFieldForTest& field, double value) {
  std::string bytes(8, '\0');
  if (field.type == 'F' && field.size == 4) {
    const auto number = static_cast<float>(value);
    std::memcpy(bytes.data(), &number, 4);
  } else if (field.type == 'F') {
    std::memcpy(bytes.data(), &value, 8);
  } else {
    // Two's complement, the lowest byte first.
    const auto number = static_cast<std::int64_t>(value);
    std::memcpy(bytes.data(), &number, 8);
  }
  bytes.resize(static_cast<std::size_t>(field.size));
  return bytes;
}

inline std::string pcd_header_for_test(const std::vector<PcdFieldForTest>& fields, std::size_t points,
                                       const std::string& form) {
  std::string names = "FIELDS", sizes = "SIZE", types = "TYPE", counts = "COUNT";
  for (const PcdFieldForTest& field : fields) {
    names += " " + field.name;
    sizes += " " + std::to_string(field.size);
    types += std::string(" ") + field.type;
    counts += " " + std::to_string(field.count);
  }
  const std::string n = std::to_string(points);
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n" + names + "\n" + sizes + "\n" + types + "\n" +
         counts + "\nWIDTH " + n + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA " + form + "\n";
}

/// @param form  "ascii", "binary" or "binary_compressed"
inline std::string pcd_for_test(const std::vector<PcdFieldForTest>& fields, std::size_t points,
                                const std::string& form) {
  const auto count = [](const PcdFieldForTest& field) { return static_cast<std::size_t>(field.count); };
  std::string data;
  if (form == "binary_compressed") {
    for (const PcdFieldForTest& field : fields) {
      for (std::size_t i = 0; i < points * count(field); ++i) data += pcd_value_for_test(field, field.values[i]);
    }
    const std::string packed = lzf_for_test(data);
    std::string sizes(8, '\0');
    const auto small = static_cast<std::uint32_t>(packed.size()), large = static_cast<std::uint32_t>(data.size());
    std::memcpy(sizes.data(), &small, 4);
    std::memcpy(sizes.data() + 4, &large, 4);
    data = sizes + packed;
  } else {
    for (std::size_t i = 0; i < points; ++i) {
      std::string line;
      for (const PcdFieldForTest& field : fields) {
        for (std::size_t k = 0; k < count(field); ++k) {
          const double value = field.values[i * count(field) + k];
          if (form == "binary") {
            line += pcd_value_for_test(field, value);
            continue;
          }
          std::string word(32, '\0');
          word.resize(static_cast<std::size_t>(std::snprintf(word.data(), word.size(), "%.17g", value)));
          line += (line.empty() ? "" : " ") + word;
        }
      }
      data += form == "binary" ? line : line + "\n";
    }
  }
  return pcd_header_for_test(fields, points, form) + data;
}

}  // namespace abbe
