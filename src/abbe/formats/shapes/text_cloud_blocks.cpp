#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "abbe/formats/shapes/cloud_block_reader.h"
#include "abbe/formats/shapes/cloud_columns.h"
#include "abbe/formats/shapes/xyz_text.h"
#include "abbe/formats/text/csv_rows.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/text_blocks.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

using Eigen::Index;

/// Points in lines: pieces of about 1 MiB are read in parallel.
class TextReader : public PointCloudBlocks::Reader {
 public:
  TextReader(std::string_view text, std::string file) : text_(text), file_(std::move(file)) { end = text.size(); }

  std::size_t block_end(std::size_t from, std::size_t points) const override {
    const std::size_t least = std::max<std::size_t>(1, points) * kBytesOfPointInText;
    if (end - from <= least) return end;
    const std::size_t line_end = text_.find('\n', from + least - 1);
    return line_end == std::string_view::npos ? end : line_end + 1;
  }

  std::size_t about_points() const override { return (end - begin + kBytesOfPointInText - 1) / kBytesOfPointInText; }

  std::size_t count(std::size_t from, std::size_t to, int threads) const override {
    const std::vector<TextBlock> pieces = split_into_blocks<TextBlock>(text_.substr(0, to), from);
    std::vector<std::size_t> points(pieces.size());
    for_each_block(pieces.size(), threads,
                   [&](std::size_t i) { points[i] = count_lines(pieces[i].begin, pieces[i].end); });
    return std::accumulate(points.begin(), points.end(), std::size_t{0});
  }

  CloudBlock read(std::size_t from, std::size_t to, int threads) const override {
    std::vector<TextBlock> pieces = split_into_blocks<TextBlock>(text_.substr(0, to), from);
    std::vector<Eigen::Matrix3Xd> points(pieces.size());
    for_each_block(pieces.size(), threads,
                   [&](std::size_t i) { pieces[i].refusal = read_lines(pieces[i].begin, pieces[i].end, points[i]); });
    Index count = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (pieces[i].refusal) throw_refusal(text_, file_, *pieces[i].refusal);
      count += points[i].cols();
    }
    CloudBlock result;
    result.points.resize(3, count);
    Index at = 0;
    for (const Eigen::Matrix3Xd& piece : points) {
      result.points.middleCols(at, piece.cols()) = piece;
      at += piece.cols();
    }
    return result;
  }

 protected:
  virtual std::size_t count_lines(std::size_t from, std::size_t to) const = 0;
  virtual std::optional<TextRefusal> read_lines(std::size_t from, std::size_t to, Eigen::Matrix3Xd& points) const = 0;

  std::string_view text_;
  std::string file_;
};

class XyzReader : public TextReader {
 public:
  XyzReader(std::string_view text, const std::string& file, const PointCloudOptions& options) : TextReader(text, file) {
    format = "XYZ";
    unit = agreed_unit(std::nullopt, options.unit, file);
    factor_ = millimetres(unit.length);
    begin = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
    columns_ = xyz_columns(text.substr(begin), file, kLargestInput / factor_);
  }

 protected:
  std::size_t count_lines(std::size_t from, std::size_t to) const override { return count_xyz_lines(text_, from, to); }

  std::optional<TextRefusal> read_lines(std::size_t from, std::size_t to, Eigen::Matrix3Xd& points) const override {
    PointCloud cloud;
    auto refusal = read_xyz_lines(text_, from, to, columns_, kLargestInput / factor_, cloud);
    points = factor_ * cloud.points;
    return refusal;
  }

 private:
  std::size_t columns_ = 3;
  double factor_ = 1;
};

class CsvReader : public TextReader {
 public:
  CsvReader(std::string_view text, const std::string& file, const PointCloudOptions& options)
      : TextReader(text, file), rows_(text, file, cloud_columns(false), options.mapping) {
    if (options.unit) {
      throw InputError({file, 0, 0, "unit"}, "a CSV file states the unit of each column in its header", "no unit");
    }
    format = "CSV";
    unit = {FileLength::millimetre, UnitSource::stated};
    text_ = rows_.text();
    begin = rows_.first();
    end = text_.size();
  }

 protected:
  std::size_t count_lines(std::size_t from, std::size_t to) const override { return rows_.count(from, to); }

  std::optional<TextRefusal> read_lines(std::size_t from, std::size_t to, Eigen::Matrix3Xd& points) const override {
    CsvTable table;
    auto refusal = rows_.read(from, to, table);
    if (refusal) return refusal;
    points.resize(3, static_cast<Index>(table.rows));
    for (std::size_t k = 0; k < 3; ++k) {
      points.row(static_cast<Index>(k)) =
          Eigen::Map<const Eigen::RowVectorXd>(table.columns[k].numbers.data(), points.cols());
    }
    return refusal;
  }

 private:
  CsvRows rows_;
};

}  // namespace

std::unique_ptr<const PointCloudBlocks::Reader> csv_block_reader(std::string_view contents, std::string file,
                                                                 const PointCloudOptions& options) {
  return std::make_unique<CsvReader>(contents, file, options);
}

std::unique_ptr<const PointCloudBlocks::Reader> xyz_block_reader(std::string_view contents, std::string file,
                                                                 const PointCloudOptions& options) {
  if (!options.mapping.columns.empty() || !options.mapping.ignore.empty()) {
    throw InputError({.file = file}, "its columns cannot be named or left out: this is not a CSV file",
                     "a CSV file, whose first line has the names of its columns");
  }
  return std::make_unique<XyzReader>(contents, file, options);
}

}  // namespace abbe
