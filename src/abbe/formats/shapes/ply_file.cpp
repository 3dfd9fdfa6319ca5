#include "abbe/formats/shapes/ply_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "abbe/formats/shapes/face_triangles.h"
#include "abbe/formats/shapes/ply_header.h"
#include "abbe/formats/shapes/point_normals.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/text_blocks.h"
#include "abbe/formats/text/text_cursor.h"
#include "abbe/geometry/surface/polygon_triangles.h"

namespace abbe {
namespace {

static_assert(std::endian::native == std::endian::little,
              "byte orders are told apart by comparing with this machine's");

/// Values of an ascii body.
class AsciiSource {
 public:
  AsciiSource(std::string_view contents, const std::string& file, std::size_t begin) : cursor_(contents, file, begin) {}

  double scalar(PlyType, const std::string& field) { return cursor_.number(field.c_str()); }
  long long integer(PlyType, const std::string& field) { return cursor_.integer(field.c_str()); }
  void skip(PlyType, const std::string& field) {
    if (cursor_.word().empty()) fail(field, "the file ends", "a value");
  }
  std::size_t position() const { return cursor_.position(); }
  static const char* floats(std::size_t) { return nullptr; }
  static void skip_floats(std::size_t) {}
  /// A digit and a space.
  static std::size_t least_bytes(PlyType) { return 2; }
  [[noreturn]] void fail(const std::string& field, const std::string& problem, const std::string& expected) const {
    cursor_.fail(field, problem, expected);
  }

 private:
  TextCursor cursor_;
};

/// Values of a binary body.
template <bool kSwap>
class BinarySource {
 public:
  BinarySource(std::string_view contents, const std::string& file, std::size_t begin)
      : contents_(contents), file_(file), at_(begin), value_at_(begin) {}

  double scalar(PlyType type, const std::string& field) {
    switch (type) {
      case PlyType::float32:
        return static_cast<double>(std::bit_cast<float>(take<std::uint32_t>(field)));
      case PlyType::float64:
        return std::bit_cast<double>(take<std::uint64_t>(field));
      default:
        return static_cast<double>(integer(type, field));
    }
  }
  long long integer(PlyType type, const std::string& field) {
    switch (type) {
      case PlyType::int8:
        return static_cast<std::int8_t>(take<std::uint8_t>(field));
      case PlyType::uint8:
        return take<std::uint8_t>(field);
      case PlyType::int16:
        return static_cast<std::int16_t>(take<std::uint16_t>(field));
      case PlyType::uint16:
        return take<std::uint16_t>(field);
      case PlyType::int32:
        return static_cast<std::int32_t>(take<std::uint32_t>(field));
      default:
        return take<std::uint32_t>(field);
    }
  }
  void skip(PlyType type, const std::string& field) {
    value_at_ = at_;
    if (contents_.size() - at_ < ply_type_size(type)) fail(field, "the file ends", "");
    at_ += ply_type_size(type);
  }
  std::size_t position() const { return at_; }
  /// So many float32 numbers from here on in this machine's byte order; null if they are none, or not all there.
  const char* floats(std::size_t count) const {
    return kSwap || (contents_.size() - at_) / sizeof(float) < count ? nullptr : contents_.data() + at_;
  }
  void skip_floats(std::size_t count) { at_ += count * sizeof(float); }
  static std::size_t least_bytes(PlyType type) { return ply_type_size(type); }
  [[noreturn]] void fail(const std::string& field, const std::string& problem, const std::string& expected) const {
    throw InputError({file_, 0, 0, field}, fmt::format("at byte {}: {}", value_at_, problem), expected);
  }

 private:
  template <typename Word>
  Word take(const std::string& field) {
    value_at_ = at_;
    if (contents_.size() - at_ < sizeof(Word)) fail(field, "the file ends", "");
    std::array<unsigned char, sizeof(Word)> bytes;
    std::memcpy(bytes.data(), contents_.data() + at_, sizeof(Word));
    at_ += sizeof(Word);
    if constexpr (kSwap) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<Word>(bytes);
  }

  std::string_view contents_;
  const std::string& file_;
  std::size_t at_;
  std::size_t value_at_;
};

template <typename Source>
class BodyReader {
 public:
  BodyReader(std::string_view contents, const std::string& file, const PlyHeader& header, const FileUnit& unit)
      : contents_(contents),
        file_(file),
        header_(header),
        source_(contents, file, header.data),
        largest_(kLargestInput / millimetres(unit.length)) {
    result_.unit = unit;
  }

  PlyContents read() {
    const auto vertex = std::find_if(header_.elements.begin(), header_.elements.end(),
                                     [](const PlyElement& element) { return element.name == "vertex"; });
    if (vertex == header_.elements.end()) {
      throw InputError({file_, 0, 0, "vertex"}, "the file has no such element", "a line 'element vertex NUMBER'");
    }
    vertices_ = vertex->count;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face") {
        read_faces(element);
      } else {
        skip_element(element);
      }
    }
    if (const auto offset = faces_.cut(result_.points)) {
      const bool ascii = header_.form == PlyForm::ascii;
      throw InputError({file_, ascii ? text_line(contents_, *offset) : 0, 0, "face"},
                       fmt::format("at byte {}: a polygon that is not convex has too many corners", *offset),
                       fmt::format("at most {}", kLargestConcavePolygon));
    }
    result_.triangles = faces_.triangles();
    if (const double factor = millimetres(result_.unit.length); factor != 1) result_.points *= factor;
    return std::move(result_);
  }

 private:
  [[noreturn]] void refuse_element(const PlyElement& element, const std::string& problem,
                                   const std::string& expected) const {
    throw InputError({file_, text_line(contents_, element.offset), 0, "element " + shown_word(element.name)}, problem,
                     expected);
  }

  /// What the header promises must fit into the file before memory is taken for it.
  void require_room(const PlyElement& element, std::size_t least_bytes) const {
    const std::size_t left = contents_.size() - std::min(source_.position(), contents_.size());
    // The last value of an ascii file may have nothing behind it.
    if (least_bytes == 0 || element.count <= (left + 1) / least_bytes) return;
    refuse_element(element, fmt::format("{} are stated, but only {} bytes are left for them", element.count, left),
                   fmt::format("at least {} bytes for each", least_bytes));
  }

  static std::size_t least_bytes(const PlyElement& element) {
    std::size_t bytes = 0;
    for (const PlyProperty& property : element.properties) {
      bytes += Source::least_bytes(property.count_type ? *property.count_type : property.type);
    }
    return bytes;
  }

  void skip_property(const PlyProperty& property) {
    if (!property.count_type) {
      source_.skip(property.type, property.name);
      return;
    }
    for (long long left = length(property); left > 0; --left) source_.skip(property.type, property.name);
  }

  long long length(const PlyProperty& list) {
    const long long length = source_.integer(*list.count_type, list.name);
    if (length < 0) source_.fail(list.name, fmt::format("a list of length {}", length), "a length not below zero");
    return length;
  }

  void skip_element(const PlyElement& element) {
    if (element.properties.empty()) return;
    require_room(element, least_bytes(element));
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties) skip_property(property);
    }
  }

  void read_vertices(const PlyElement& element) {
    constexpr std::array<const char*, 6> kWanted = {"x", "y", "z", "nx", "ny", "nz"};
    std::vector<int> slots(element.properties.size(), -1);
    std::size_t found = 0;
    for (std::size_t k = 0; k < kWanted.size(); ++k) {
      const std::size_t at = element.find(kWanted[k]);
      const bool present = at < element.properties.size() && !element.properties[at].count_type;
      if (present) {
        slots[at] = static_cast<int>(k);
        ++found;
      } else if (k < 3) {
        refuse_element(element, fmt::format("has no property {}", kWanted[k]), "numbers x, y, z");
      }
    }
    if (found != 3 && found != kWanted.size()) {
      refuse_element(element, "has only a part of a normal", "numbers nx, ny, nz or none of them");
    }
    if (element.count == 0) refuse_element(element, "there are no vertices", "at least one");
    if (element.count >= 0xffffffffU) refuse_element(element, "too many vertices", "at most 4294967294");
    require_room(element, least_bytes(element));
    const auto count = static_cast<Eigen::Index>(element.count);
    const bool normals = found == kWanted.size();
    result_.points.resize(3, count);
    if (slots == std::vector<int>{0, 1, 2} && read_floats(element)) return;
    if (normals) result_.normals.resize(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < slots.size(); ++k) {
        const PlyProperty& property = element.properties[k];
        const int slot = slots[k];
        if (slot < 0) {
          skip_property(property);
          continue;
        }
        const double value = source_.scalar(property.type, property.name);
        if (!(std::abs(value) <= largest_)) refuse_number(value, property.name, i);
        (slot < 3 ? result_.points : result_.normals)(slot % 3, i) = value;
      }
      if (normals && !make_unit(result_.normals.col(i))) {
        source_.fail("nx, ny, nz", fmt::format("the normal of vertex {} has no direction", i),
                     "a vector with a length");
      }
    }
  }

  /// Vertices of three float32, which most scans have. @returns false if they are others, or one of them is refused
  bool read_floats(const PlyElement& element) {
    const auto is_float = [](const PlyProperty& property) { return property.type == PlyType::float32; };
    const std::size_t count = 3 * element.count;
    const char* const from = source_.floats(count);
    if (from == nullptr || !std::all_of(element.properties.begin(), element.properties.end(), is_float)) return false;
    double* const to = result_.points.data();
    bool good = true;
    for (std::size_t i = 0; i < count; ++i) {
      float value = 0;
      std::memcpy(&value, from + i * sizeof(float), sizeof(float));
      to[i] = static_cast<double>(value);
      good &= std::abs(to[i]) <= largest_;
    }
    if (good) source_.skip_floats(count);
    return good;
  }

  [[noreturn]] void refuse_number(double value, const std::string& field, Eigen::Index vertex) const {
    source_.fail(field,
                 std::isfinite(value) ? fmt::format("vertex {}: {:g} is too large", vertex, value)
                                      : fmt::format("vertex {}: not a finite number", vertex),
                 fmt::format("a number of at most {:g}", largest_));
  }

  void read_faces(const PlyElement& element) {
    result_.has_faces = true;
    std::size_t list = element.find("vertex_indices");
    if (list == element.properties.size()) list = element.find("vertex_index");
    const bool good = list < element.properties.size() && element.properties[list].count_type &&
                      ply_type_is_integer(element.properties[list].type);
    if (!good) {
      refuse_element(element, "has no list of vertices", "'property list uchar int vertex_indices'");
    }
    const PlyProperty& corners = element.properties[list];
    require_room(element, least_bytes(element) + 3 * Source::least_bytes(corners.type));
    faces_.reserve(element.count);
    std::vector<std::uint32_t> face;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t k = 0; k < element.properties.size(); ++k) {
        if (k != list) {
          skip_property(element.properties[k]);
          continue;
        }
        const std::size_t offset = source_.position();
        const long long n = length(corners);
        if (n < 3) source_.fail(corners.name, fmt::format("face {} has {} corners", i, n), "at least 3");
        face.clear();
        for (long long corner = 0; corner < n; ++corner) {
          const long long index = source_.integer(corners.type, corners.name);
          if (index < 0 || static_cast<std::uint64_t>(index) >= vertices_) {
            source_.fail(corners.name, fmt::format("face {} has a corner at vertex {}", i, index),
                         fmt::format("0 to {}", vertices_ - 1));
          }
          face.push_back(static_cast<std::uint32_t>(index));
        }
        faces_.add(face, offset);
      }
    }
  }

  std::string_view contents_;
  const std::string& file_;
  const PlyHeader& header_;
  Source source_;
  double largest_;
  std::uint64_t vertices_ = 0;
  PlyContents result_;
  FaceTriangles faces_;
};

}  // namespace

bool is_ply(std::string_view contents) {
  return contents == "ply" || contents.starts_with("ply\n") || contents.starts_with("ply\r");
}

PlyContents parse_ply(std::string_view contents, const std::string& file, const std::optional<FileLength>& unit) {
  const PlyHeader header = parse_ply_header(contents, file);
  const FileUnit agreed = agreed_unit(header.unit, unit, file);
  PlyContents result;
  switch (header.form) {
    case PlyForm::ascii:
      result = BodyReader<AsciiSource>(contents, file, header, agreed).read();
      result.format = "PLY, ascii";
      break;
    case PlyForm::binary_little_endian:
      result = BodyReader<BinarySource<false>>(contents, file, header, agreed).read();
      result.format = "PLY, binary little-endian";
      break;
    case PlyForm::binary_big_endian:
      result = BodyReader<BinarySource<true>>(contents, file, header, agreed).read();
      result.format = "PLY, binary big-endian";
      break;
  }
  return result;
}

}  // namespace abbe
