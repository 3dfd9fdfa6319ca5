#include "abbe/formats/shapes/obj_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

#include "abbe/formats/shapes/face_triangles.h"
#include "abbe/formats/shapes/obj_regions.h"
#include "abbe/formats/shapes/point_normals.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/line_numbers.h"
#include "abbe/formats/text/text_blocks.h"
#include "abbe/formats/text/text_cursor.h"
#include "abbe/geometry/parallel_blocks.h"
#include "abbe/geometry/surface/polygon_triangles.h"

namespace abbe {
namespace {

constexpr std::array<std::string_view, 15> kPassedOver = {"vt",     "s",        "mtllib",   "l",          "p",
                                                          "usemap", "maplib",   "lod",      "bevel",      "mg",
                                                          "call",   "c_interp", "d_interp", "shadow_obj", "trace_obj"};
constexpr std::array<std::string_view, 3> kScopes = {"o", "g", "usemtl"};

struct StatementBlock : TextBlock {
  std::size_t vertices = 0;
  std::size_t normals = 0;
  std::size_t textures = 0;
  std::size_t first_vertex = 0;
  std::size_t first_normal = 0;
  std::size_t first_texture = 0;
  FaceTriangles faces;
  std::vector<ObjStatement> statements;
};

struct Counts {
  std::size_t vertices = 0;
  std::size_t normals = 0;
  std::size_t textures = 0;
};

/// Keyword of a line, and the place behind it; empty for blank lines and comments.
std::string_view keyword(std::string_view line, const char*& behind) {
  const char* const end = line.data() + line.size();
  const char* const at = skip_spaces(line.data(), end);
  behind = word_end(at, end);
  if (at == end || *at == '#') return {};
  return {at, static_cast<std::size_t>(behind - at)};
}

void count(std::string_view text, StatementBlock& block) {
  for (std::size_t at = block.begin; at < block.end;) {
    const char* behind = nullptr;
    const std::string_view word = keyword(csv_next_line(text, at), behind);
    if (word == "v") ++block.vertices;
    if (word == "vn") ++block.normals;
    if (word == "vt") ++block.textures;
  }
}

class StatementReader {
 public:
  StatementReader(std::string_view text, const Counts& counts, double largest, ObjContents& result,
                  StatementBlock& block)
      : text_(text),
        counts_(counts),
        largest_(largest),
        result_(result),
        block_(block),
        vertex_(block.first_vertex),
        normal_(block.first_normal),
        texture_(block.first_texture) {}

  void read() {
    for (std::size_t at = block_.begin; at < block_.end;) {
      const std::string_view line = csv_next_line(text_, at);
      const char* behind = nullptr;
      const std::string_view word = keyword(line, behind);
      end_ = line.data() + line.size();
      if (word.empty()) continue;
      bool good = true;
      if (word == "v") {
        good = read_three(behind, result_.points, vertex_++, "v");
      } else if (word == "f") {
        good = read_face(behind);
      } else if (word == "vn") {
        good = read_normal(behind);
      } else if (word == "vt") {
        ++texture_;
      } else if (const auto scope = std::find(kScopes.begin(), kScopes.end(), word); scope != kScopes.end()) {
        add_statement(static_cast<std::size_t>(scope - kScopes.begin()), behind);
      } else if (std::find(kPassedOver.begin(), kPassedOver.end(), word) == kPassedOver.end()) {
        good = refuse(word.data(), "", fmt::format("'{}'", shown_word(word)),
                      "v, vn, vt, f, g, o, s, mtllib or usemtl: free-form surfaces are not read");
      }
      if (!good) return;
    }
  }

 private:
  bool refuse(const char* at, std::string field, std::string problem, std::string expected) {
    block_.refusal = TextRefusal{static_cast<std::size_t>(at - text_.data()), std::move(field), std::move(problem),
                                 std::move(expected)};
    return false;
  }

  bool read_three(const char* at, Eigen::Matrix3Xd& into, std::size_t column, const char* field) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      at = skip_spaces(at, end_);
      double value = 0;
      NumberProblem problem = NumberProblem::none;
      const char* const behind = read_line_number(at, end_, largest_, value, problem);
      if (behind == nullptr) {
        const std::string_view word(at, static_cast<std::size_t>(word_end(at, end_) - at));
        return refuse(
            at, field,
            word.empty() ? "the line ends" : fmt::format("'{}' {}", shown_word(word), number_problem_words(problem)),
            fmt::format("three numbers of at most {:g}", largest_));
      }
      into(k, static_cast<Eigen::Index>(column)) = value;
      at = behind;
    }
    // A weight or a colour may follow; it is not read.
    return true;
  }

  bool read_normal(const char* at) {
    const std::size_t column = normal_++;
    return read_three(at, result_.normals, column, "vn");
  }

  /// The name is the rest of the line without the blanks around it; a group may have several.
  void add_statement(std::size_t scope, const char* at) {
    at = skip_spaces(at, end_);
    const char* end = end_;
    while (end > at && is_blank(end[-1])) --end;
    block_.statements.push_back({scope, {at, static_cast<std::size_t>(end - at)}, block_.faces.size()});
  }

  /// A reference counted from 1, or backwards from the last one so far.
  bool resolve(const char*& at, std::size_t so_far, std::size_t count, const char* field, std::uint32_t& index) {
    const char* const start = at;
    long long number = 0;
    const auto result = std::from_chars(at, end_, number);
    if (result.ec != std::errc()) {
      const std::string_view word(start, static_cast<std::size_t>(word_end(start, end_) - start));
      return refuse(start, field, fmt::format("'{}' is not a reference", shown_word(word)), "a whole number");
    }
    at = result.ptr;
    const auto last = static_cast<long long>(number < 0 ? so_far : count);
    const long long zero_based = number < 0 ? last + number : number - 1;
    if (number == 0 || zero_based < 0 || zero_based >= last) {
      return refuse(start, field, fmt::format("{} refers to nothing", number),
                    fmt::format("1 to {} or -1 to -{}", count, so_far));
    }
    index = static_cast<std::uint32_t>(zero_based);
    return true;
  }

  bool read_face(const char* at) {
    const char* const start = at;
    face_.clear();
    for (at = skip_spaces(at, end_); at != end_; at = skip_spaces(at, end_)) {
      std::uint32_t vertex = 0, ignored = 0;
      if (!resolve(at, vertex_, counts_.vertices, "f", vertex)) return false;
      if (at != end_ && *at == '/') {
        ++at;
        const bool texture = at != end_ && *at != '/' && at != word_end(at, end_);
        if (texture && !resolve(at, texture_, counts_.textures, "f (vt)", ignored)) return false;
        if (at != end_ && *at == '/' && !resolve(++at, normal_, counts_.normals, "f (vn)", ignored)) return false;
      }
      if (at != word_end(at, end_)) {
        return refuse(at, "f", fmt::format("'{}' behind a corner", shown_word({at, 1})),
                      "a corner as 1, 1/2, 1//3 or 1/2/3");
      }
      face_.push_back(vertex);
    }
    if (face_.size() < 3) {
      return refuse(start, "f", fmt::format("a face of {} corners", face_.size()), "at least 3");
    }
    block_.faces.add(face_, static_cast<std::size_t>(start - text_.data()));
    return true;
  }

  std::string_view text_;
  const Counts& counts_;
  double largest_;
  ObjContents& result_;
  StatementBlock& block_;
  std::size_t vertex_, normal_, texture_;
  const char* end_ = nullptr;
  std::vector<std::uint32_t> face_;
};

}  // namespace

ObjContents parse_obj(std::string_view contents, const std::string& file, const std::optional<FileLength>& unit,
                      int threads) {
  std::vector<StatementBlock> blocks = split_into_blocks<StatementBlock>(contents, 0);
  for_each_block(blocks.size(), threads, [&](std::size_t i) { count(contents, blocks[i]); });
  Counts counts;
  for (StatementBlock& block : blocks) {
    block.first_vertex = counts.vertices;
    block.first_normal = counts.normals;
    block.first_texture = counts.textures;
    counts.vertices += block.vertices;
    counts.normals += block.normals;
    counts.textures += block.textures;
  }
  if (counts.vertices == 0) throw InputError({file, 0, 0, "v"}, "there are no vertices in the file", "at least one");
  if (std::max({counts.vertices, counts.normals, counts.textures}) >= 0xffffffffU) {
    throw InputError({file, 0, 0, "v"}, "too many vertices", "at most 4294967294");
  }
  ObjContents result;
  result.unit = agreed_unit(std::nullopt, unit, file);
  result.points.resize(3, static_cast<Eigen::Index>(counts.vertices));
  result.normals.resize(3, static_cast<Eigen::Index>(counts.normals));
  const double largest = kLargestInput / millimetres(result.unit.length);
  for_each_block(blocks.size(), threads,
                 [&](std::size_t i) { StatementReader(contents, counts, largest, result, blocks[i]).read(); });
  FaceTriangles faces;
  std::size_t triangles = 0;
  for (const StatementBlock& block : blocks) {
    if (block.refusal) throw_refusal(contents, file, *block.refusal);
    triangles += block.faces.size();
  }
  faces.reserve(triangles);
  ObjRegions regions;
  for (const StatementBlock& block : blocks) {
    faces.append(block.faces);
    regions.add(block.statements, block.faces.size());
  }
  if (const auto offset = faces.cut(result.points)) {
    throw_refusal(contents, file,
                  {*offset, "f", "a polygon that is not convex has too many corners",
                   fmt::format("at most {}", kLargestConcavePolygon)});
  }
  result.triangles = faces.triangles();
  if (regions.any_statement()) {
    result.region_of_triangle = std::move(regions.region_of_triangle);
    result.regions = std::move(regions.names);
  }
  result.points *= millimetres(result.unit.length);
  if (triangles > 0 || result.normals.cols() != result.points.cols()) result.normals.resize(3, 0);
  for (Eigen::Index i = 0; i < result.normals.cols(); ++i) {
    if (!make_unit(result.normals.col(i))) {
      throw InputError({file, 0, 0, "vn"}, fmt::format("normal {} has no direction", i + 1), "a vector with a length");
    }
  }
  return result;
}

}  // namespace abbe
