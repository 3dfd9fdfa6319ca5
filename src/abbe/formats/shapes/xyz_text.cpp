#include "abbe/formats/shapes/xyz_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "abbe/formats/shapes/point_normals.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/line_numbers.h"
#include "abbe/formats/text/text_blocks.h"
#include "abbe/formats/text/text_cursor.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

struct XyzBlock : TextBlock {
  std::size_t rows = 0;
  std::size_t first_row = 0;
};

constexpr std::array<const char*, 6> kPointFields = {"x", "y", "z", "nx", "ny", "nz"};
// Of the length of a normal: files with two decimals, but no colours.
constexpr double kNormalTolerance = 0.02;

/// Place of the first word of a line, or null for a blank line or a comment.
const char* first_word(std::string_view line) {
  const char* const end = line.data() + line.size();
  const char* const at = skip_spaces(line.data(), end);
  if (at == end || *at == '#' || (*at == '/' && end - at > 1 && at[1] == '/')) return nullptr;
  return at;
}

std::size_t count_words(std::string_view line) {
  const char* const end = line.data() + line.size();
  std::size_t words = 0;
  for (const char* at = skip_spaces(line.data(), end); at != end; at = skip_spaces(word_end(at, end), end)) ++words;
  return words;
}

class PointReader {
 public:
  PointReader(std::string_view text, std::size_t columns, double largest, PointCloud& cloud, XyzBlock& block)
      : text_(text), columns_(columns), largest_(largest), cloud_(cloud), block_(block) {}

  void read() {
    std::size_t row = block_.first_row;
    for (std::size_t at = block_.begin; at < block_.end;) {
      const std::string_view line = csv_next_line(text_, at);
      const char* const start = first_word(line);
      if (start == nullptr) continue;
      if (!read_row(line, start, row)) return;
      ++row;
    }
  }

 private:
  bool refuse(const char* at, const char* field, std::string problem, std::string expected) {
    block_.refusal =
        TextRefusal{static_cast<std::size_t>(at - text_.data()), field, std::move(problem), std::move(expected)};
    return false;
  }

  bool read_row(std::string_view line, const char* at, std::size_t row) {
    const char* const end = line.data() + line.size();
    double* const point = cloud_.points.data() + 3 * row;
    double* const normal = columns_ == 6 ? cloud_.normals.data() + 3 * row : nullptr;
    for (std::size_t k = 0; k < columns_; ++k) {
      double& value = k < 3 ? point[k] : normal[k - 3];
      NumberProblem problem = NumberProblem::none;
      const char* const behind = read_line_number(at, end, largest_, value, problem);
      if (behind == nullptr) return refuse_word(line, at, k, problem);
      at = skip_spaces(behind, end);
    }
    if (at != end) return refuse_length(line);
    if (normal != nullptr) {
      Eigen::Map<Eigen::Vector3d> direction(normal);
      const double length = direction.stableNorm();
      if (!(std::abs(length - 1) <= kNormalTolerance)) {
        return refuse(line.data(), "nx, ny, nz", fmt::format("the last three numbers have the length {:g}", length),
                      "a unit normal; other columns need a CSV file with a header");
      }
      make_unit(direction);
    }
    return true;
  }

  bool refuse_word(std::string_view line, const char* at, std::size_t column, NumberProblem problem) {
    const char* const end = line.data() + line.size();
    if (at == end) return refuse_length(line);
    const std::string_view word(at, static_cast<std::size_t>(word_end(at, end) - at));
    const bool commas = word.find_first_of(",;") != std::string_view::npos;
    return refuse(at, kPointFields[column], fmt::format("'{}' {}", shown_word(word), number_problem_words(problem)),
                  commas
                      ? "numbers with a point between spaces; comma-separated values are read from .csv files with a "
                        "header x_mm,y_mm,z_mm"
                      : fmt::format("a number of at most {:g}", largest_));
  }

  bool refuse_length(std::string_view line) {
    return refuse(line.data(), "", fmt::format("the line has {} numbers", count_words(line)),
                  fmt::format("{} as in the first line", columns_));
  }

  std::string_view text_;
  std::size_t columns_;
  double largest_;
  PointCloud& cloud_;
  XyzBlock& block_;
};

}  // namespace

std::size_t count_xyz_lines(std::string_view contents, std::size_t begin, std::size_t end) {
  std::size_t rows = 0;
  for (std::size_t at = begin; at < end;) {
    const char first = contents[at];
    if (first >= '0' && first <= '9') {
      const void* line_end = std::memchr(contents.data() + at, '\n', end - at);
      at = line_end == nullptr ? end
                               : static_cast<std::size_t>(static_cast<const char*>(line_end) - contents.data()) + 1;
      ++rows;
    } else if (first_word(csv_next_line(contents, at)) != nullptr) {
      ++rows;
    }
  }
  return rows;
}

std::size_t xyz_columns(std::string_view contents, const std::string& file, double largest) {
  std::size_t columns = 0;
  for (std::size_t at = 0; at < contents.size() && columns == 0;) {
    const std::string_view line = csv_next_line(contents, at);
    const char* const start = first_word(line);
    if (start == nullptr) continue;
    columns = count_words(line);
    if (columns == 3 || columns == 6) break;
    // A word that is no number says more than a wrong count.
    double ignored = 0;
    NumberProblem problem = NumberProblem::none;
    const char* const end = line.data() + line.size();
    if (read_line_number(start, end, largest, ignored, problem) == nullptr) {
      columns = 3;
      break;
    }
    throw_refusal(
        contents, file,
        {static_cast<std::size_t>(start - contents.data()), "", fmt::format("the line has {} numbers", columns),
         "3: x y z, or 6: x y z and a unit normal; other columns need a CSV file with a header"});
  }
  if (columns == 0) throw InputError({file, 0, 0, ""}, "there are no points in the file", "lines of three numbers");
  return columns;
}

std::optional<TextRefusal> read_xyz_lines(std::string_view contents, std::size_t begin, std::size_t end,
                                          std::size_t columns, double largest, PointCloud& cloud) {
  XyzBlock block;
  block.begin = begin;
  block.end = end;
  block.rows = count_xyz_lines(contents, begin, end);
  cloud.points.resize(3, static_cast<Eigen::Index>(block.rows));
  cloud.normals.resize(3, columns == 6 ? static_cast<Eigen::Index>(block.rows) : 0);
  PointReader(contents, columns, largest, cloud, block).read();
  return block.refusal;
}

PointCloud parse_xyz(std::string_view contents, const std::string& file, double largest, int threads) {
  if (contents.starts_with("\xEF\xBB\xBF")) contents.remove_prefix(3);
  const std::size_t columns = xyz_columns(contents, file, largest);
  std::vector<XyzBlock> blocks = split_into_blocks<XyzBlock>(contents, 0);
  for_each_block(blocks.size(), threads,
                 [&](std::size_t i) { blocks[i].rows = count_xyz_lines(contents, blocks[i].begin, blocks[i].end); });
  std::size_t rows = 0;
  for (XyzBlock& block : blocks) {
    block.first_row = rows;
    rows += block.rows;
  }
  PointCloud cloud;
  cloud.points.resize(3, static_cast<Eigen::Index>(rows));
  if (columns == 6) cloud.normals.resize(3, static_cast<Eigen::Index>(rows));
  for_each_block(blocks.size(), threads,
                 [&](std::size_t i) { PointReader(contents, columns, largest, cloud, blocks[i]).read(); });
  for (const XyzBlock& block : blocks) {
    if (block.refusal) throw_refusal(contents, file, *block.refusal);
  }
  return cloud;
}

}  // namespace abbe
