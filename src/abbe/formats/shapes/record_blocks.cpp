#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <utility>
#include <vector>

#include "abbe/formats/shapes/cloud_block_reader.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/text_blocks.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

using Eigen::Index;

constexpr std::size_t kRecordsTogether = 16384;
constexpr std::array<const char*, 3> kRecordFields = {"x", "y", "z"};

/// Where one coordinate is in a record, and how it is stored.
struct RecordNumber {
  std::size_t offset = 0, size = 4;
  char type = 'F';  ///< F float, I signed, U unsigned
};

template <typename Word, typename Number>
double swapped_number(const char* at, bool swap) {
  std::array<char, sizeof(Word)> bytes;
  std::memcpy(bytes.data(), at, sizeof(Word));
  if (swap) std::reverse(bytes.begin(), bytes.end());
  return static_cast<double>(std::bit_cast<Number>(bytes));
}

using ReadNumber = double (*)(const char* at, bool swap);

ReadNumber number_reader(const RecordNumber& number) {
  if (number.type == 'F') {
    return number.size == 8 ? swapped_number<std::uint64_t, double> : swapped_number<std::uint32_t, float>;
  }
  const bool is_signed = number.type == 'I';
  switch (number.size) {
    case 1:
      return is_signed ? swapped_number<std::uint8_t, std::int8_t> : swapped_number<std::uint8_t, std::uint8_t>;
    case 2:
      return is_signed ? swapped_number<std::uint16_t, std::int16_t> : swapped_number<std::uint16_t, std::uint16_t>;
    case 4:
      return is_signed ? swapped_number<std::uint32_t, std::int32_t> : swapped_number<std::uint32_t, std::uint32_t>;
    default:
      return is_signed ? swapped_number<std::uint64_t, std::int64_t> : swapped_number<std::uint64_t, std::uint64_t>;
  }
}

/// Points in records of the same length, one after the other.
class RecordReader : public PointCloudBlocks::Reader {
 public:
  RecordReader(std::string_view contents, std::string file) : contents_(contents), file_(std::move(file)) {}

  std::size_t block_end(std::size_t from, std::size_t points) const override {
    return from + std::min((end - from) / stride, points) * stride;
  }

  std::size_t about_points() const override { return (end - begin) / stride; }

  std::size_t count(std::size_t from, std::size_t to, int threads) const override {
    const std::size_t records = (to - from) / stride, blocks = (records + kRecordsTogether - 1) / kRecordsTogether;
    if (!leaves_out) return records;
    std::vector<std::size_t> finite(blocks);
    for_each_block(blocks, threads, [&](std::size_t block) {
      const std::size_t last = std::min(records, (block + 1) * kRecordsTogether);
      for (std::size_t i = block * kRecordsTogether; i < last; ++i)
        finite[block] += is_finite(from + i * stride) ? 1 : 0;
    });
    return std::accumulate(finite.begin(), finite.end(), std::size_t{0});
  }

  CloudBlock read(std::size_t from, std::size_t to, int threads) const override {
    const std::size_t count = (to - from) / stride, blocks = (count + kRecordsTogether - 1) / kRecordsTogether;
    CloudBlock result;
    result.points.resize(3, static_cast<Index>(count));
    std::vector<std::size_t> kept(blocks);
    for_each_block(blocks, threads, [&](std::size_t block) {
      const std::size_t first = block * kRecordsTogether;
      kept[block] = read_records(from, first, std::min(count, first + kRecordsTogether), result.points);
    });
    // Closes the gaps of points that are left out.
    Index found = 0;
    for (std::size_t block = 0; block < blocks; ++block) {
      const auto first = static_cast<Index>(block * kRecordsTogether), size = static_cast<Index>(kept[block]);
      if (first != found) result.points.middleCols(found, size) = result.points.middleCols(first, size).eval();
      found += size;
    }
    result.not_finite = count - static_cast<std::size_t>(found);
    if (result.not_finite > 0) result.points.conservativeResize(3, found);
    return result;
  }

  std::array<RecordNumber, 3> numbers;
  std::size_t stride = 0;
  bool swap = false;
  bool leaves_out = false;       ///< points that are not finite; else they are refused
  const char* record = "point";  ///< in messages

 private:
  bool is_finite(std::size_t at) const {
    return std::all_of(numbers.begin(), numbers.end(), [&](const RecordNumber& number) {
      return std::isfinite(number_reader(number)(contents_.data() + at + number.offset, swap));
    });
  }

  /// @returns how many points are kept; they stand from `first` on
  std::size_t read_records(std::size_t from, std::size_t first, std::size_t last, Eigen::Matrix3Xd& points) const {
    const double factor = millimetres(unit.length), largest = kLargestInput / factor;
    const std::array<ReadNumber, 3> readers = {number_reader(numbers[0]), number_reader(numbers[1]),
                                               number_reader(numbers[2])};
    std::size_t next = first;
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t at = from + i * stride;
      Eigen::Vector3d point;
      for (std::size_t k = 0; k < 3; ++k) {
        point[static_cast<Index>(k)] = readers[k](contents_.data() + at + numbers[k].offset, swap);
      }
      if (leaves_out && !point.allFinite()) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        if (!(std::abs(point[static_cast<Index>(k)]) <= largest)) refuse(at, k, point[static_cast<Index>(k)], largest);
      }
      points.col(static_cast<Index>(next++)) = factor * point;
    }
    return next - first;
  }

  [[noreturn]] void refuse(std::size_t at, std::size_t k, double value, double largest) const {
    const std::string place = fmt::format("at byte {}: {} {}: ", at + numbers[k].offset, record, (at - begin) / stride);
    throw InputError({.file = file_, .field = kRecordFields[k]},
                     place + (std::isfinite(value) ? fmt::format("{:g} is too large", value) : "not a finite number"),
                     fmt::format("a number of at most {:g}", largest));
  }

  std::string_view contents_;
  std::string file_;
};

/// Bytes of a record of an element without lists; nothing for others.
std::optional<std::size_t> record_bytes(const PlyElement& element) {
  std::size_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    if (property.count_type) return std::nullopt;
    bytes += ply_type_size(property.type);
  }
  return bytes;
}

RecordNumber ply_number(const PlyElement& element, std::size_t property) {
  RecordNumber number;
  for (std::size_t k = 0; k < property; ++k) number.offset += ply_type_size(element.properties[k].type);
  const PlyType type = element.properties[property].type;
  number.size = ply_type_size(type);
  if (ply_type_is_integer(type)) {
    number.type = type == PlyType::int8 || type == PlyType::int16 || type == PlyType::int32 ? 'I' : 'U';
  }
  return number;
}

[[noreturn]] void refuse_short_cloud(const std::string& file, std::size_t line, const std::string& field,
                                     std::uint64_t count, std::size_t left, std::size_t bytes) {
  throw InputError({file, line, 0, field},
                   fmt::format("{} are stated, but only {} bytes are left for them", count, left),
                   fmt::format("at least {} bytes for each", bytes));
}

}  // namespace

std::optional<std::size_t> ply_vertices_in_blocks(const PlyHeader& header) {
  if (header.form == PlyForm::ascii) return std::nullopt;
  for (std::size_t i = 0; i < header.elements.size(); ++i) {
    if (!record_bytes(header.elements[i])) return std::nullopt;
    if (header.elements[i].name == "vertex") return i;
  }
  return std::nullopt;
}

std::unique_ptr<const PointCloudBlocks::Reader> ply_block_reader(std::string_view contents, std::string file,
                                                                 const PointCloudOptions& options) {
  const PlyHeader header = parse_ply_header(contents, file);
  auto reader = std::make_unique<RecordReader>(contents, file);
  reader->unit = agreed_unit(header.unit, options.unit, file);
  reader->swap = header.form == PlyForm::binary_big_endian;
  reader->format = reader->swap ? "PLY, binary big-endian" : "PLY, binary little-endian";
  reader->record = "vertex";
  const std::size_t vertex = ply_vertices_in_blocks(header).value();
  std::size_t at = header.data;
  for (std::size_t i = 0; i <= vertex; ++i) {
    const PlyElement& element = header.elements[i];
    const std::size_t bytes = *record_bytes(element), left = contents.size() - at;
    const auto refuse = [&](const char* problem, const char* expected) {
      throw InputError({file, text_line(contents, element.offset), 0, "element vertex"}, problem, expected);
    };
    if (i == vertex && element.count == 0) refuse("there are no vertices", "at least one");
    for (std::size_t k = 0; k < 3 && i == vertex; ++k) {
      const std::size_t property = element.find(kRecordFields[k]);
      if (property == element.properties.size()) {
        refuse(fmt::format("has no property {}", kRecordFields[k]).c_str(), "numbers x, y, z");
      }
      reader->numbers[k] = ply_number(element, property);
    }
    if (bytes > 0 && element.count > left / bytes) {
      refuse_short_cloud(file, text_line(contents, element.offset), "element " + shown_word(element.name),
                         element.count, left, bytes);
    }
    reader->begin = at;
    reader->stride = bytes;
    at += static_cast<std::size_t>(element.count) * bytes;
  }
  reader->end = at;
  return reader;
}

std::unique_ptr<const PointCloudBlocks::Reader> pcd_block_reader(std::string_view contents, std::string file,
                                                                 const PointCloudOptions& options) {
  const PcdHeader header = parse_pcd_header(contents, file);
  auto reader = std::make_unique<RecordReader>(contents, file);
  reader->unit = agreed_unit(std::nullopt, options.unit, file);
  reader->format = "PCD, binary";
  reader->leaves_out = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const PcdField* found = nullptr;
    for (const PcdField& field : header.fields) {
      if (field.name != kRecordFields[k]) continue;
      if (found != nullptr) {
        throw InputError({.file = file, .field = "FIELDS"}, fmt::format("{} is given twice", kRecordFields[k]));
      }
      if (field.count != 1) {
        throw InputError({.file = file, .field = "COUNT"},
                         fmt::format("{} has {} values", kRecordFields[k], field.count), "1");
      }
      found = &field;
    }
    if (found == nullptr) {
      throw InputError({.file = file, .field = "FIELDS"}, fmt::format("there is no field {}", kRecordFields[k]),
                       "x y z");
    }
    reader->numbers[k] = {found->offset, found->size, found->type};
  }
  const std::size_t left = contents.size() - header.data;
  if (header.points > left / header.point_bytes) {
    refuse_short_cloud(file, header.line, "POINTS", header.points, left, header.point_bytes);
  }
  reader->stride = header.point_bytes;
  reader->begin = header.data;
  reader->end = header.data + static_cast<std::size_t>(header.points) * header.point_bytes;
  const std::size_t more = contents.find_first_not_of(std::string_view("\0\r\n \t", 5), reader->end);
  if (more != std::string_view::npos) {
    throw InputError({.file = file, .field = "POINTS"},
                     fmt::format("at byte {}: the file continues after its {} points", more, header.points),
                     "the end of the file");
  }
  return reader;
}

}  // namespace abbe
