#include "abbe/formats/shapes/e57_scans.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

constexpr std::array<const char*, kE57WantedCount> kE57Cartesian = {
    "cartesianX", "cartesianY", "cartesianZ", "nor:normalX", "nor:normalY", "nor:normalZ", "cartesianInvalidState"};
constexpr std::array<const char*, kE57WantedCount> kE57Spherical = {
    "sphericalRange", "sphericalAzimuth", "sphericalElevation",   "nor:normalX",
    "nor:normalY",    "nor:normalZ",      "sphericalInvalidState"};
// Single precision, and what programs make of a rotation matrix of theirs.
constexpr double kUnitQuaternion = 1e-3;

std::string_view e57_trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Reads one vectorChild of data3D.
class E57ScanReader {
 public:
  E57ScanReader(const E57Element& element, std::string name, const std::string& file) : element_(element), file_(file) {
    scan_.name = std::move(name);
  }

  E57Scan read() {
    const E57Element* const points = element_.child("points");
    if (points == nullptr) fail("points", element_, "missing", "a CompressedVector");
    if (const std::string* type = points->attribute("type"); type == nullptr || *type != "CompressedVector") {
      fail("points", *points, fmt::format("type '{}'", type == nullptr ? "" : shown_word(*type)), "CompressedVector");
    }
    scan_.points = unsigned_attribute(*points, "recordCount");
    if (scan_.points == 0) return std::move(scan_);
    scan_.section = unsigned_attribute(*points, "fileOffset");
    const E57Element* const prototype = points->child("prototype");
    if (prototype == nullptr) fail("points", *points, "there is no prototype", "the fields of a point");
    add_fields(*prototype, "");
    if (const E57Element* codecs = points->child("codecs"); codecs != nullptr) require_bit_packing(*codecs);
    find_wanted();
    if (const E57Element* pose = element_.child("pose"); pose != nullptr) read_pose(*pose);
    return std::move(scan_);
  }

 private:
  [[noreturn]] void fail(std::string_view field, const E57Element& at, const std::string& problem,
                         const std::string& expected) const {
    throw InputError({.file = file_, .field = scan_.name + " " + std::string(field)},
                     fmt::format("in line {} of the XML section: {}", at.line, problem), expected);
  }

  std::uint64_t unsigned_attribute(const E57Element& element, const char* name) const {
    const std::int64_t value = integer_attribute(element, name, -1);
    if (value < 0) {
      const std::string* const text = element.attribute(name);
      fail(name, element, text == nullptr ? "missing" : fmt::format("'{}'", shown_word(*text)),
           "a whole number not below zero");
    }
    return static_cast<std::uint64_t>(value);
  }

  std::int64_t integer_attribute(const E57Element& element, const char* name, std::int64_t otherwise) const {
    const std::string* const text = element.attribute(name);
    if (text == nullptr) return otherwise;
    const std::string_view word = e57_trimmed(*text);
    std::int64_t value = 0;
    const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || read.ec != std::errc() || read.ptr != word.data() + word.size()) {
      fail(element.name + " " + name, element, fmt::format("'{}'", shown_word(*text)), "a whole number");
    }
    return value;
  }

  double number_attribute(const E57Element& element, const char* name, double otherwise) const {
    const std::string* const text = element.attribute(name);
    return text == nullptr ? otherwise : number(element, element.name + " " + name, *text);
  }

  double number(const E57Element& element, const std::string& field, std::string_view text) const {
    double value = 0;
    if (parse_number(e57_trimmed(text), 0, value) != NumberProblem::none || std::abs(value) > kLargestInput) {
      fail(field, element, fmt::format("'{}'", shown_word(text)), "a number of at most 1e+09");
    }
    return value;
  }

  /// Fields in the order of their byte streams: the elements without children, as they stand in the prototype.
  void add_fields(const E57Element& structure, const std::string& path) {
    for (const E57Element& element : structure.children) {
      const std::string* const type = element.attribute("type");
      E57Field field;
      field.name = path + element.name;
      if (type == nullptr) {
        fail(field.name, element, "has no type", "Integer, ScaledInteger, Float, String or Structure");
      } else if (*type == "Structure" || *type == "Vector") {
        add_fields(element, field.name + "/");
        continue;
      } else if (*type == "Integer" || *type == "ScaledInteger") {
        read_integer(element, *type == "ScaledInteger", field);
      } else if (*type == "Float") {
        const std::string* const precision = element.attribute("precision");
        const bool is_single = precision != nullptr && *precision == "single";
        if (precision != nullptr && !is_single && *precision != "double") {
          fail(field.name, element, fmt::format("precision '{}'", shown_word(*precision)), "single or double");
        }
        field.kind = is_single ? E57Field::Kind::single_precision : E57Field::Kind::double_precision;
        field.bits = is_single ? 32 : 64;
      } else if (*type == "String") {
        field.kind = E57Field::Kind::text;
        field.bits = 8;
      } else {
        fail(field.name, element, fmt::format("type '{}'", shown_word(*type)),
             "Integer, ScaledInteger, Float, String or Structure");
      }
      scan_.fields.push_back(std::move(field));
    }
  }

  void read_integer(const E57Element& element, bool is_scaled, E57Field& field) const {
    field.kind = E57Field::Kind::integer;
    field.least = integer_attribute(element, "minimum", std::numeric_limits<std::int64_t>::min());
    const std::int64_t most = integer_attribute(element, "maximum", std::numeric_limits<std::int64_t>::max());
    if (most < field.least) {
      fail(field.name, element, fmt::format("the maximum {} is below the minimum {}", most, field.least), "");
    }
    field.range = static_cast<std::uint64_t>(most) - static_cast<std::uint64_t>(field.least);
    field.bits = static_cast<unsigned>(std::bit_width(field.range));
    if (!is_scaled) return;
    field.scale = number_attribute(element, "scale", 1);
    field.offset = number_attribute(element, "offset", 0);
  }

  void require_bit_packing(const E57Element& codecs) const {
    for (const E57Element& codec : codecs.children) {
      for (const E57Element& one : codec.children) {
        if (one.name == "inputs" || one.name == "bitPackCodec") continue;
        fail("codecs", one, fmt::format("'{}'", shown_word(one.name)), "bitPackCodec, the only one of the standard");
      }
    }
  }

  std::size_t index_of(const char* name) const {
    const auto found = std::find_if(scan_.fields.begin(), scan_.fields.end(),
                                    [&](const E57Field& field) { return field.name == name; });
    return found == scan_.fields.end() ? E57Scan::kNone : static_cast<std::size_t>(found - scan_.fields.begin());
  }

  /// How many of three fields there are; fewer than all but more than none are refused.
  bool has_all(const std::array<const char*, kE57WantedCount>& names, std::size_t first) {
    std::size_t count = 0;
    for (std::size_t k = first; k < first + 3; ++k) {
      scan_.wanted[k] = index_of(names[k]);
      if (scan_.wanted[k] == E57Scan::kNone) continue;
      if (scan_.fields[scan_.wanted[k]].kind == E57Field::Kind::text) {
        fail(names[k], element_, "is a text", "a number");
      }
      ++count;
    }
    if (count != 0 && count != 3) {
      fail("prototype", element_, fmt::format("it has {} of three fields", count),
           fmt::format("{}, {} and {}, or none of them", names[first], names[first + 1], names[first + 2]));
    }
    return count == 3;
  }

  void find_wanted() {
    scan_.wanted.fill(E57Scan::kNone);
    if (!has_all(kE57Cartesian, kE57Point)) {
      scan_.is_spherical = has_all(kE57Spherical, kE57Point);
      if (!scan_.is_spherical) {
        fail("prototype", element_, "its points have no coordinates",
             "cartesianX, cartesianY and cartesianZ, or sphericalRange, sphericalAzimuth and sphericalElevation");
      }
    }
    has_all(kE57Cartesian, kE57Normal);
    scan_.wanted[kE57Invalid] = index_of((scan_.is_spherical ? kE57Spherical : kE57Cartesian)[kE57Invalid]);
    if (const std::size_t state = scan_.wanted[kE57Invalid]; state != E57Scan::kNone) {
      if (scan_.fields[state].kind != E57Field::Kind::integer) {
        fail(scan_.fields[state].name, element_, "is not an Integer", "0, 1 or 2");
      }
    }
  }

  /// A number of the pose; an element that is empty is zero.
  double pose_number(const E57Element& parent, const char* name, double otherwise) const {
    const E57Element* const element = parent.child(name);
    if (element == nullptr) return otherwise;
    const std::string field = fmt::format("pose/{}/{}", parent.name, name);
    const double stored = e57_trimmed(element->text).empty() ? 0 : number(*element, field, element->text);
    const std::string* const type = element->attribute("type");
    if (type == nullptr || *type != "ScaledInteger") return stored;
    return stored * number_attribute(*element, "scale", 1) + number_attribute(*element, "offset", 0);
  }

  void read_pose(const E57Element& pose) {
    if (const E57Element* turn = pose.child("rotation"); turn != nullptr) {
      const Eigen::Quaterniond q(pose_number(*turn, "w", 1), pose_number(*turn, "x", 0), pose_number(*turn, "y", 0),
                                 pose_number(*turn, "z", 0));
      if (!(std::abs(q.norm() - 1) <= kUnitQuaternion)) {
        fail("pose/rotation", *turn, fmt::format("the quaternion has the length {:g}", q.norm()), "1");
      }
      scan_.file_from_scan.rotation = q.normalized().toRotationMatrix();
    }
    if (const E57Element* shift = pose.child("translation"); shift != nullptr) {
      const double x = pose_number(*shift, "x", 0), y = pose_number(*shift, "y", 0), z = pose_number(*shift, "z", 0);
      scan_.file_from_scan.translation = {x, y, z};
    }
  }

  const E57Element& element_;
  const std::string& file_;
  E57Scan scan_;
};

}  // namespace

std::vector<E57Scan> e57_scans(const E57Element& root, const std::string& file) {
  if (root.name != "e57Root") {
    throw InputError({.file = file, .field = "XML section"}, fmt::format("its root is '{}'", shown_word(root.name)),
                     "e57Root");
  }
  std::vector<E57Scan> scans;
  const E57Element* const data = root.child("data3D");
  if (data == nullptr) return scans;
  for (std::size_t i = 0; i < data->children.size(); ++i) {
    E57Scan scan = E57ScanReader(data->children[i], fmt::format("scan {}:", i + 1), file).read();
    if (scan.points > 0) scans.push_back(std::move(scan));
  }
  return scans;
}

}  // namespace abbe
