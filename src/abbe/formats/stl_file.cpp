#include "abbe/formats/stl_file.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "abbe/formats/input_error.h"
#include "abbe/formats/number_text.h"
#include "abbe/formats/text_cursor.h"
#include "abbe/geometry/vertex_welder.h"

namespace abbe {
namespace {

static_assert(std::endian::native == std::endian::little, "STL files are little-endian");

constexpr std::size_t kHeader = 84;  // 80 bytes of text, then the number of triangles
constexpr std::size_t kFacet = 50;
constexpr std::size_t kTogether = 1024;  // facets
constexpr std::array<const char*, 12> kFields = {"normal x",   "normal y",   "normal z",   "corner 1 x",
                                                 "corner 1 y", "corner 1 z", "corner 2 x", "corner 2 y",
                                                 "corner 2 z", "corner 3 x", "corner 3 y", "corner 3 z"};

/// Collects facets; welds, and counts normals that point to the other side.
class Facets {
 public:
  explicit Facets(std::size_t expected) : welder_(expected / 2 + 3) { corners_.reserve(9 * kTogether); }

  /// @param facet  normal and three corners, finite
  void add(const double* facet) {
    const Eigen::Map<const Eigen::Vector3d> normal(facet), a(facet + 3), b(facet + 6), c(facet + 9);
    if ((b - a).cross(c - a).dot(normal) < 0) ++turned_;
    corners_.insert(corners_.end(), facet + 3, facet + 12);
    if (corners_.size() == 9 * kTogether) flush();
  }

  MeshFile mesh(const FileUnit& unit, const char* format) {
    flush();
    MeshFile result;
    result.format = format;
    result.unit = unit;
    result.mesh.vertices = millimetres(unit.length) * welder_.vertices();
    result.mesh.triangles = Eigen::Map<const Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic>>(
        indices_.data(), 3, static_cast<Eigen::Index>(indices_.size() / 3));
    if (turned_ > 0) {
      result.notes.push_back(
          fmt::format("the normals of {} facets contradict the order of their corners, which counts", turned_));
    }
    return result;
  }

  std::size_t size() const { return indices_.size() / 3 + corners_.size() / 9; }
  void reserve(std::size_t facets) { indices_.reserve(3 * facets); }

 private:
  void flush() {
    const std::size_t before = indices_.size();
    indices_.resize(before + corners_.size() / 3);
    welder_.add(corners_, indices_.data() + before);
    corners_.clear();
  }

  VertexWelder welder_;
  std::vector<double> corners_;
  std::vector<std::uint32_t> indices_;
  std::size_t turned_ = 0;
};

std::uint32_t stated_facets(std::string_view contents) {
  std::uint32_t facets = 0;
  std::memcpy(&facets, contents.data() + 80, sizeof facets);
  return facets;
}

MeshFile parse_binary(std::string_view contents, const std::string& file, const FileUnit& unit) {
  const InputError::Place place{file, 0, 0, ""};
  if (contents.size() < kHeader) {
    throw InputError(place, fmt::format("the file ends at byte {}", contents.size()),
                     "a binary STL file of at least 84 bytes");
  }
  const std::uint32_t facets = stated_facets(contents);
  const std::uint64_t length = kHeader + std::uint64_t{kFacet} * facets;
  if (length != contents.size()) {
    throw InputError({file, 0, 0, "number of triangles"},
                     fmt::format("at byte 80: {} triangles are stated in a file of {} bytes", facets, contents.size()),
                     fmt::format("a file of {} bytes: 84 and 50 for each triangle", length));
  }
  if (facets == 0) throw InputError(place, "there are no triangles in the file", "at least one");
  const double largest = kLargestInput / millimetres(unit.length);
  Facets collected(facets);
  collected.reserve(facets);
  std::array<float, 12> numbers;
  std::array<double, 12> facet;
  for (std::size_t i = 0; i < facets; ++i) {
    std::memcpy(numbers.data(), contents.data() + kHeader + kFacet * i, sizeof numbers);
    bool good = true;
    for (std::size_t k = 0; k < 12; ++k) {
      facet[k] = static_cast<double>(numbers[k]);
      // Normals may be anything: some programs write what 0/0 gives for facets without area.
      if (k >= 3) good = good && std::abs(facet[k]) <= largest;
    }
    if (!good) {
      const auto bad = static_cast<std::size_t>(
          std::find_if(facet.begin() + 3, facet.end(), [&](double v) { return !(std::abs(v) <= largest); }) -
          facet.begin());
      throw InputError({file, 0, 0, kFields[bad]},
                       fmt::format("at byte {}: triangle {}: {}", kHeader + kFacet * i + 4 * bad, i,
                                   std::isfinite(facet[bad]) ? fmt::format("{:g} is too large", facet[bad])
                                                             : std::string("not a finite number")),
                       fmt::format("a coordinate of at most {:g} {}", largest, file_length_name(unit.length)));
    }
    collected.add(facet.data());
  }
  return collected.mesh(unit, "STL, binary");
}

void require_word(TextCursor& cursor, std::string_view found, std::string_view wanted) {
  const auto same = [](char a, char b) { return (a | 0x20) == b; };
  if (std::equal(found.begin(), found.end(), wanted.begin(), wanted.end(), same)) return;
  cursor.fail("", found.empty() ? "the file ends" : fmt::format("'{}'", shown_word(found)),
              fmt::format("'{}'", wanted));
}

bool is_word(std::string_view found, std::string_view wanted) {
  return std::equal(found.begin(), found.end(), wanted.begin(), wanted.end(),
                    [](char a, char b) { return (a | 0x20) == b; });
}

/// A component of a facet normal: anything that looks like a number, "nan" too.
double normal_component(TextCursor& cursor, const char* field) {
  const std::string_view word = cursor.word();
  double value = 0;
  switch (parse_number(word, 0, value)) {
    case NumberProblem::none:
      return value;
    case NumberProblem::not_finite:
    case NumberProblem::too_large:
      return 0;
    case NumberProblem::not_a_number:
      // Some programs write -nan(ind).
      if (word.find("nan") != std::string_view::npos) return 0;
      break;
  }
  cursor.fail(field, word.empty() ? "the file ends" : fmt::format("'{}' is not a number", shown_word(word)),
              "a number");
}

MeshFile parse_ascii(std::string_view contents, const std::string& file, const FileUnit& unit) {
  TextCursor cursor(contents, file);
  const double largest = kLargestInput / millimetres(unit.length);
  // A facet in its shortest form takes 67 characters; in its usual form 200 and more.
  Facets collected(contents.size() / 256);
  std::array<double, 12> facet;
  bool inside = false;
  for (std::string_view word = cursor.word(); !word.empty(); word = cursor.word()) {
    if (!inside) {
      require_word(cursor, word, "solid");
      cursor.line();
      inside = true;
      continue;
    }
    if (is_word(word, "endsolid")) {
      cursor.line();
      inside = false;
      continue;
    }
    require_word(cursor, word, "facet");
    require_word(cursor, cursor.word(), "normal");
    for (std::size_t k = 0; k < 3; ++k) facet[k] = normal_component(cursor, kFields[k]);
    require_word(cursor, cursor.word(), "outer");
    require_word(cursor, cursor.word(), "loop");
    for (std::size_t corner = 1; corner <= 3; ++corner) {
      require_word(cursor, cursor.word(), "vertex");
      for (std::size_t k = 3 * corner; k < 3 * corner + 3; ++k) {
        facet[k] = cursor.number(kFields[k]);
        if (std::abs(facet[k]) > largest) {
          cursor.fail(kFields[k], fmt::format("{:g} is too large", facet[k]),
                      fmt::format("at most {:g} {}", largest, file_length_name(unit.length)));
        }
      }
    }
    require_word(cursor, cursor.word(), "endloop");
    require_word(cursor, cursor.word(), "endfacet");
    collected.add(facet.data());
  }
  if (inside) cursor.fail("", "the file ends", "'facet' or 'endsolid'");
  if (collected.size() == 0) throw InputError({file, 0, 0, ""}, "there are no triangles in the file", "at least one");
  return collected.mesh(unit, "STL, ascii");
}

}  // namespace

bool is_binary_stl(std::string_view contents) {
  return contents.size() >= kHeader && kHeader + std::uint64_t{kFacet} * stated_facets(contents) == contents.size();
}

bool is_ascii_stl(std::string_view contents) {
  while (!contents.empty() && is_blank(contents.front())) contents.remove_prefix(1);
  if (contents.size() < 5 || !is_word(contents.substr(0, 5), "solid")) return false;
  // Binary files that begin with the word and were cut off still have bytes that no text has.
  return contents.substr(0, 2 * kHeader).find('\0') == std::string_view::npos;
}

MeshFile parse_stl(std::string_view contents, const std::string& file, const MeshFileOptions& options) {
  const FileUnit unit = agreed_unit(std::nullopt, options.unit, file);
  if (is_binary_stl(contents) || !is_ascii_stl(contents)) return parse_binary(contents, file, unit);
  return parse_ascii(contents, file, unit);
}

std::string stl_bytes(const TriangleMesh& mesh) {
  const auto facets = static_cast<std::size_t>(mesh.size());
  std::string bytes(kHeader + kFacet * facets, '\0');
  constexpr std::string_view kText = "binary STL, unit mm";
  std::copy(kText.begin(), kText.end(), bytes.begin());
  const auto count = static_cast<std::uint32_t>(facets);
  std::memcpy(bytes.data() + 80, &count, sizeof count);
  std::array<float, 12> numbers;
  for (std::size_t i = 0; i < facets; ++i) {
    const auto triangle = static_cast<Eigen::Index>(i);
    const Eigen::Vector3d a = mesh.corner(triangle, 0), b = mesh.corner(triangle, 1), c = mesh.corner(triangle, 2);
    const Eigen::Vector3d normal = (b - a).cross(c - a).stableNormalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      numbers[k] = static_cast<float>(normal[row]);
      numbers[3 + k] = static_cast<float>(a[row]);
      numbers[6 + k] = static_cast<float>(b[row]);
      numbers[9 + k] = static_cast<float>(c[row]);
    }
    std::memcpy(bytes.data() + kHeader + kFacet * i, numbers.data(), sizeof numbers);
  }
  return bytes;
}

}  // namespace abbe
