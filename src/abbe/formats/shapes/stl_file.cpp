#include "abbe/formats/shapes/stl_file.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/text_blocks.h"
#include "abbe/formats/text/text_cursor.h"
#include "abbe/geometry/parallel_blocks.h"
#include "abbe/geometry/surface/vertex_welder.h"

namespace abbe {
namespace {

static_assert(std::endian::native == std::endian::little, "STL files are little-endian");

constexpr std::size_t kHeader = 84;  // 80 bytes of text, then the number of triangles
constexpr std::size_t kFacet = 50;
constexpr std::size_t kTogether = 8192;  // facets
constexpr std::array<const char*, 12> kFacetFields = {"normal x",   "normal y",   "normal z",   "corner 1 x",
                                                      "corner 1 y", "corner 1 z", "corner 2 x", "corner 2 y",
                                                      "corner 2 z", "corner 3 x", "corner 3 y", "corner 3 z"};

/// Facets of a stretch of the file.
struct FacetBlock {
  std::vector<double> corners;  ///< 9 per facet
  std::size_t turned = 0;       ///< facets whose normal points to the other side

  std::size_t size() const { return corners.size() / 9; }
  void clear() {
    corners.clear();
    turned = 0;
  }
  /// @param facet  normal and three corners, finite
  void add(const double* facet) {
    const Eigen::Map<const Eigen::Vector3d> normal(facet), a(facet + 3), b(facet + 6), c(facet + 9);
    if ((b - a).cross(c - a).dot(normal) < 0) ++turned;
    corners.insert(corners.end(), facet + 3, facet + 12);
  }
};

/// Puts blocks together in the order of the file, equal corners becoming one vertex.
class WeldedFacets {
 public:
  /// @param expected  facets, about
  explicit WeldedFacets(std::size_t expected) : welder_(expected / 2 + 3, 3 * expected) {
    indices_.reserve(3 * expected);
  }

  void add(const FacetBlock& block) {
    const std::size_t before = indices_.size();
    indices_.resize(before + 3 * block.size());
    welder_.add(block.corners, indices_.data() + before);
    turned_ += block.turned;
  }

  MeshFile mesh(const FileUnit& unit, const char* format) const {
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

  std::size_t size() const { return indices_.size() / 3; }

 private:
  VertexWelder welder_;
  std::vector<std::uint32_t> indices_;
  std::size_t turned_ = 0;
};

/// Reads blocks on several threads, some at a time; while one lot is read, that before it is put together.
/// @param read  fills an empty block; false: it has to be looked at from the beginning of the file
/// @return false if a block was not read
bool read_blocks(std::size_t blocks, int threads, WeldedFacets& facets,
                 const std::function<bool(std::size_t, FacetBlock&)>& read) {
  const auto workers = static_cast<std::size_t>(threads > 0 ? threads : default_thread_count());
  const std::size_t lot = workers == 1 ? 1 : 4 * workers;
  std::vector<FacetBlock> now(lot), before(lot);
  std::size_t read_before = 0;
  std::atomic<bool> good = true;
  for (std::size_t begin = 0; begin < blocks + lot && good; begin += lot) {
    const std::size_t count = std::min(lot, blocks - std::min(begin, blocks));
    for_each_block(count + 1, threads, [&](std::size_t k) {
      if (k == 0) {
        for (std::size_t i = 0; i < read_before; ++i) facets.add(before[i]);
        return;
      }
      now[k - 1].clear();
      if (!read(begin + k - 1, now[k - 1])) good = false;
    });
    std::swap(now, before);
    read_before = count;
  }
  return good;
}

std::uint32_t stated_facets(std::string_view contents) {
  std::uint32_t facets = 0;
  std::memcpy(&facets, contents.data() + 80, sizeof facets);
  return facets;
}

MeshFile parse_binary(std::string_view contents, const std::string& file, const FileUnit& unit, int threads) {
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
  const auto read = [&](std::size_t facet, std::array<double, 12>& numbers) {
    std::array<float, 12> stored;
    std::memcpy(stored.data(), contents.data() + kHeader + kFacet * facet, sizeof stored);
    bool good = true;
    for (std::size_t k = 0; k < 12; ++k) {
      numbers[k] = static_cast<double>(stored[k]);
      // Normals may be anything: some programs write what 0/0 gives for facets without area.
      if (k >= 3) good = good && std::abs(numbers[k]) <= largest;
    }
    return good;
  };
  WeldedFacets welded(facets);
  const std::size_t blocks = (facets + kTogether - 1) / kTogether;
  const bool good = read_blocks(blocks, threads, welded, [&](std::size_t number, FacetBlock& block) {
    std::array<double, 12> facet;
    const std::size_t begin = number * kTogether, end = std::min<std::size_t>(begin + kTogether, facets);
    block.corners.reserve(9 * (end - begin));
    for (std::size_t i = begin; i < end; ++i) {
      if (!read(i, facet)) return false;
      block.add(facet.data());
    }
    return true;
  });
  if (good) return welded.mesh(unit, "STL, binary");
  std::array<double, 12> facet{};
  std::size_t i = 0;
  while (read(i, facet)) ++i;
  const auto bad = static_cast<std::size_t>(
      std::find_if(facet.begin() + 3, facet.end(), [&](double v) { return !(std::abs(v) <= largest); }) -
      facet.begin());
  throw InputError({file, 0, 0, kFacetFields[bad]},
                   fmt::format("at byte {}: triangle {}: {}", kHeader + kFacet * i + 4 * bad, i,
                               std::isfinite(facet[bad]) ? fmt::format("{:g} is too large", facet[bad])
                                                         : std::string("not a finite number")),
                   fmt::format("a coordinate of at most {:g} {}", largest, file_length_name(unit.length)));
}

bool is_word(std::string_view found, std::string_view wanted) {
  return std::equal(found.begin(), found.end(), wanted.begin(), wanted.end(),
                    [](char a, char b) { return (a | 0x20) == b; });
}

/// The next word, in small or capital letters.
void require_word(TextCursor& cursor, std::string_view wanted) {
  if (cursor.take(wanted)) return;
  const std::string_view found = cursor.word();
  if (is_word(found, wanted)) return;
  cursor.fail("", found.empty() ? "the file ends" : fmt::format("'{}'", shown_word(found)),
              fmt::format("'{}'", wanted));
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

/// Facets up to the end of the text.
/// @param inside  of a solid; becomes what it is at the end
void read_facets(TextCursor& cursor, const FileUnit& unit, bool& inside, FacetBlock& facets) {
  const double largest = kLargestInput / millimetres(unit.length);
  std::array<double, 12> facet;
  while (true) {
    if (!(inside && cursor.take("facet"))) {
      const std::string_view word = cursor.word();
      if (word.empty()) return;
      if (is_word(word, inside ? "endsolid" : "solid")) {
        cursor.line();
        inside = !inside;
        continue;
      }
      if (!inside || !is_word(word, "facet")) {
        cursor.fail("", fmt::format("'{}'", shown_word(word)), inside ? "'facet' or 'endsolid'" : "'solid'");
      }
    }
    require_word(cursor, "normal");
    for (std::size_t k = 0; k < 3; ++k) facet[k] = normal_component(cursor, kFacetFields[k]);
    require_word(cursor, "outer");
    require_word(cursor, "loop");
    for (std::size_t corner = 1; corner <= 3; ++corner) {
      require_word(cursor, "vertex");
      for (std::size_t k = 3 * corner; k < 3 * corner + 3; ++k) {
        facet[k] = cursor.number(kFacetFields[k]);
        if (std::abs(facet[k]) > largest) {
          cursor.fail(kFacetFields[k], fmt::format("{:g} is too large", facet[k]),
                      fmt::format("at most {:g} {}", largest, file_length_name(unit.length)));
        }
      }
    }
    require_word(cursor, "endloop");
    require_word(cursor, "endfacet");
    facets.add(facet.data());
  }
}

/// Where blocks begin: the first at the beginning of the text, the others at a line whose first word is "facet", which
/// in a file without errors stands nowhere else at the beginning of a line.
std::vector<std::size_t> facet_blocks(std::string_view contents) {
  constexpr std::string_view kWord = "facet";
  std::vector<std::size_t> begins{0};
  std::size_t at = text_block_end(contents, 0);
  while (at < contents.size()) {
    const std::size_t first = std::min(contents.find_first_not_of(" \t", at), contents.size());
    if (contents.substr(first, kWord.size()) == kWord) {
      begins.push_back(first);
      at = text_block_end(contents, first);
    } else {
      at = std::min(contents.find('\n', first), contents.size() - 1) + 1;
    }
  }
  return begins;
}

MeshFile parse_ascii(std::string_view contents, const std::string& file, const FileUnit& unit, int threads) {
  const std::vector<std::size_t> begins = facet_blocks(contents);
  // A facet in its shortest form takes 67 characters; in its usual form 200 and more.
  WeldedFacets welded(contents.size() / 256);
  const bool good = read_blocks(begins.size(), threads, welded, [&](std::size_t number, FacetBlock& block) {
    const bool last = number + 1 == begins.size();
    TextCursor cursor(contents.substr(0, last ? contents.size() : begins[number + 1]), file, begins[number]);
    bool inside = number > 0;
    try {
      read_facets(cursor, unit, inside, block);
    } catch (const InputError&) {
      return false;
    }
    return inside != last;
  });
  if (!good) {
    // From the beginning, so that the first thing that is wrong is said.
    welded = WeldedFacets(contents.size() / 256);
    TextCursor cursor(contents, file);
    FacetBlock all;
    bool inside = false;
    read_facets(cursor, unit, inside, all);
    if (inside) cursor.fail("", "the file ends", "'facet' or 'endsolid'");
    welded.add(all);
  }
  if (welded.size() == 0) throw InputError({file, 0, 0, ""}, "there are no triangles in the file", "at least one");
  return welded.mesh(unit, "STL, ascii");
}

}  // namespace

bool is_binary_stl(std::string_view contents) {
  return contents.size() >= kHeader && kHeader + std::uint64_t{kFacet} * stated_facets(contents) == contents.size();
}

bool begins_like_binary_stl(std::string_view contents) {
  if (contents.size() < kHeader || stated_facets(contents) == 0) return false;
  // Most headers are a text with zeros or blanks behind; the number of triangles has a zero byte at least. Files of
  // other programs mostly begin with a byte that no text has.
  const std::string_view header = contents.substr(0, kHeader);
  if (header.find('\0') == std::string_view::npos) return false;
  const auto is_text = [](char c) { return c == '\0' || (c >= ' ' && c <= '~'); };
  if (!is_text(header.front())) return false;
  std::array<float, 12> facet{};
  const std::size_t there = std::min(facet.size(), (contents.size() - kHeader) / sizeof(float));
  std::memcpy(facet.data(), contents.data() + kHeader, there * sizeof(float));
  bool any = false;
  for (std::size_t k = 0; k < there; ++k) {
    // Whole numbers and halves of doubles would be tiny, packed data anything.
    const float magnitude = std::abs(facet[k]);
    const bool plausible = magnitude == 0 || (magnitude > 1e-20F && magnitude <= static_cast<float>(kLargestInput));
    if (!plausible && !(k < 3 && std::isnan(magnitude))) return false;
    any = any || magnitude > 0;
  }
  return any || (there < facet.size() && std::all_of(header.begin(), header.begin() + 80, is_text));
}

bool is_ascii_stl(std::string_view contents) {
  while (!contents.empty() && is_blank(contents.front())) contents.remove_prefix(1);
  if (contents.size() < 5 || !is_word(contents.substr(0, 5), "solid")) return false;
  // Binary files that begin with the word and were cut off still have bytes that no text has.
  return contents.substr(0, 2 * kHeader).find('\0') == std::string_view::npos;
}

MeshFile parse_stl(std::string_view contents, const std::string& file, const MeshFileOptions& options) {
  const FileUnit unit = agreed_unit(std::nullopt, options.unit, file);
  if (is_binary_stl(contents) || !is_ascii_stl(contents)) {
    return parse_binary(contents, file, unit, options.threads);
  }
  return parse_ascii(contents, file, unit, options.threads);
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
