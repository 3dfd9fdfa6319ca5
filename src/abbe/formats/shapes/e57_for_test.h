#pragma once

// For tests: E57 files of any scans and fields.
#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "abbe/formats/files/crc32c.h"
#include "abbe/formats/shapes/e57_pages.h"

namespace abbe {

/// One field of a prototype with all its values. Integers, also scaled ones, are given as they are stored.
struct E57FieldForTest {
  std::string name;
  std::string attributes;  ///< "type=\"Float\""
  enum class Kind { single_precision, double_precision, integer, text } kind = Kind::double_precision;
  std::int64_t least = 0, most = 0;
  std::vector<double> numbers{};
  std::vector<std::int64_t> integers{};
};

inline E57FieldForTest e57_float_for_test(std::string name, bool is_single, std::vector<double> values) {
  return {std::move(name),
          is_single ? "type=\"Float\" precision=\"single\"" : "type=\"Float\"",
          is_single ? E57FieldForTest::Kind::single_precision : E57FieldForTest::Kind::double_precision,
          0,
          0,
          std::move(values)};
}

/// @param scaling  "" or attributes of a ScaledInteger: "scale=\"0.001\" offset=\"5\""
inline E57FieldForTest e57_integer_for_test(std::string name, std::int64_t least, std::int64_t most,
                                            const std::string& scaling, std::vector<std::int64_t> values) {
  std::string attributes = scaling.empty() ? "type=\"Integer\"" : "type=\"ScaledInteger\" " + scaling;
  attributes += " minimum=\"" + std::to_string(least) + "\" maximum=\"" + std::to_string(most) + "\"";
  return {std::move(name), attributes, E57FieldForTest::Kind::integer, least, most, {}, std::move(values)};
}

/// Texts of one letter each.
inline E57FieldForTest e57_text_for_test(std::string name, std::size_t points) {
  return {std::move(name),
          "type=\"String\"",
          E57FieldForTest::Kind::text,
          0,
          0,
          {},
          std::vector<std::int64_t>(points, 'a')};
}

struct E57ScanForTest {
  std::vector<E57FieldForTest> fields;
  std::size_t points = 0;
  std::string pose{};       ///< XML of the pose, or empty
  std::size_t packets = 1;  ///< among which the streams are cut, also within values
  bool with_other_packets = false;
  std::string count{};  ///< in place of the number of points
};

template <typename Number>
void put_for_test(std::string& bytes, Number number) {
  char raw[sizeof number];
  std::memcpy(raw, &number, sizeof number);
  bytes.append(raw, sizeof number);
}

/// The byte stream of a field: bits of integers from the lowest on, filled up to whole bytes.
inline std::string e57_stream_for_test(const E57FieldForTest& field) {
  std::string bytes;
  for (const double number : field.numbers) {
    if (field.kind == E57FieldForTest::Kind::single_precision) {
      put_for_test(bytes, static_cast<float>(number));
    } else {
      put_for_test(bytes, number);
    }
  }
  if (field.kind == E57FieldForTest::Kind::text) {
    for (const std::int64_t letter : field.integers) {
      bytes += '\2';  // a length of 1, twice, in its short form
      bytes += static_cast<char>(letter);
    }
    return bytes;
  }
  const auto bits = static_cast<int>(
      std::bit_width(static_cast<std::uint64_t>(field.most) - static_cast<std::uint64_t>(field.least)));
  std::size_t place = 0;
  for (const std::int64_t integer : field.integers) {
    const std::uint64_t stored = static_cast<std::uint64_t>(integer) - static_cast<std::uint64_t>(field.least);
    for (int bit = 0; bit < bits; ++bit, ++place) {
      if (place % 8 == 0) bytes += '\0';
      if ((stored >> bit & 1U) != 0) {
        bytes.back() = static_cast<char>(static_cast<unsigned char>(bytes.back()) | 1U << (place % 8));
      }
    }
  }
  return bytes;
}

/// Puts right the length and the checksums of a file whose pages were changed.
inline std::string e57_repaired_for_test(std::string file) {
  file.resize(std::max<std::size_t>((file.size() + kE57PageBytes - 1) / kE57PageBytes, 1) * kE57PageBytes, '\0');
  const std::uint64_t length = file.size();
  std::memcpy(file.data() + 16, &length, 8);
  for (std::size_t page = 0; page < file.size(); page += kE57PageBytes) {
    const std::uint32_t sum = crc32c({file.data() + page, kE57PageData});
    for (std::size_t k = 0; k < 4; ++k) file[page + kE57PageData + k] = static_cast<char>(sum >> (24 - 8 * k) & 0xffU);
  }
  return file;
}

inline std::string e57_section_for_test(const E57ScanForTest& scan, std::uint64_t begin) {
  std::vector<std::string> streams;
  for (const E57FieldForTest& field : scan.fields) streams.push_back(e57_stream_for_test(field));
  std::string packets;
  const auto add_packet = [&](std::string packet) {
    packet.resize((packet.size() + 3) / 4 * 4, '\0');
    assert(packet.size() <= 65536);
    const auto length = static_cast<std::uint16_t>(packet.size() - 1);
    std::memcpy(packet.data() + 2, &length, 2);
    packets += packet;
  };
  for (std::size_t i = 0; i < scan.packets; ++i) {
    std::string packet("\1\0\0\0", 4), data;
    put_for_test(packet, static_cast<std::uint16_t>(streams.size()));
    for (const std::string& stream : streams) {
      const std::size_t from = stream.size() * i / scan.packets, to = stream.size() * (i + 1) / scan.packets;
      put_for_test(packet, static_cast<std::uint16_t>(to - from));
      data += stream.substr(from, to - from);
    }
    add_packet(packet + data);
    if (scan.with_other_packets) {
      add_packet(std::string(32, '\0'));                             // an index
      add_packet(std::string("\2\0\0\0", 4) + std::string(8, 'x'));  // an empty one
    }
  }
  std::string section("\1\0\0\0\0\0\0\0", 8);
  put_for_test(section, std::uint64_t{32 + packets.size()});
  put_for_test(section, E57Pages::physical(begin + 32));
  put_for_test(section, std::uint64_t{0});
  return section + packets;
}

/// @param namespaces  attributes of the root
inline std::string e57_for_test(
    const std::vector<E57ScanForTest>& scans,
    const std::string& namespaces = " xmlns:nor=\"http://www.libe57.org/E57_NOR_surface_normals.txt\"") {
  std::string logical(kE57HeaderBytes, '\0');
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\" "
      "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\"" +
      namespaces +
      ">\n<formatName type=\"String\"><![CDATA[ASTM E57 3D Imaging Data File]]></formatName>\n"
      "<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">\n";
  for (const E57ScanForTest& scan : scans) {
    logical.resize((logical.size() + 3) / 4 * 4, '\0');
    const std::uint64_t begin = logical.size();
    logical += e57_section_for_test(scan, begin);
    xml += "<vectorChild type=\"Structure\">\n" + scan.pose + "<points type=\"CompressedVector\" fileOffset=\"" +
           std::to_string(E57Pages::physical(begin)) + "\" recordCount=\"" +
           (scan.count.empty() ? std::to_string(scan.points) : scan.count) + "\">\n<prototype type=\"Structure\">\n";
    for (const E57FieldForTest& field : scan.fields) {
      xml += "<" + field.name + " " + field.attributes + "/>\n";
    }
    xml +=
        "</prototype>\n<codecs type=\"Vector\" "
        "allowHeterogeneousChildren=\"1\">\n</codecs>\n</points>\n</vectorChild>\n";
  }
  xml += "</data3D>\n</e57Root>\n";
  std::memcpy(logical.data(), "ASTM-E57", 8);
  const std::uint32_t version = 1;
  const std::uint64_t place = E57Pages::physical(logical.size()), length = xml.size(), page = kE57PageBytes;
  std::memcpy(logical.data() + 8, &version, 4);
  std::memcpy(logical.data() + 24, &place, 8);
  std::memcpy(logical.data() + 32, &length, 8);
  std::memcpy(logical.data() + 40, &page, 8);
  logical += xml;
  std::string file;
  for (std::size_t at = 0; at < logical.size(); at += kE57PageData) {
    std::string bytes = logical.substr(at, kE57PageData);
    bytes.resize(kE57PageBytes, '\0');
    file += bytes;
  }
  return e57_repaired_for_test(file);
}

}  // namespace abbe
