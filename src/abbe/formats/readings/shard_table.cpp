#include "abbe/formats/readings/shard_table.h"

#include <algorithm>
#include <optional>

#include "abbe/formats/readings/column_file.h"
#include "abbe/geometry/digest.h"

namespace abbe {
namespace {

class TextShard : public ShardTable {
 public:
  using ShardTable::ShardTable;

  ShardRows find_rows(std::size_t number, std::size_t first, std::size_t together,
                      const std::function<void(std::size_t)>& read) override {
    ShardRows rows = abbe::find_rows(file_, number, first, together, read);
    header_ = rows.header;
    return rows;
  }
  std::string read(const ShardPart& part) const override { return header_ + file_.read(part.begin, part.end); }
  std::size_t bytes_of(const ShardPart& part) const override { return part.end - part.begin; }
  InputError placed(const InputError& error, const ShardPart& part) const override {
    InputError::Place place = error.place();
    if (place.line < 2) return error;
    place.line += part.line - 2;
    return InputError(place, error.problem(), error.expected());
  }

 private:
  std::string header_;
};

class ColumnShard : public ShardTable {
 public:
  ColumnShard(const ShardFile& file, std::shared_ptr<ColumnReader> reader, std::size_t number)
      : ShardTable(file.path), reader_(std::move(reader)), number_(number), mapping_(file.mapping) {}

  ShardRows find_rows(std::size_t number, std::size_t first, std::size_t together,
                      const std::function<void(std::size_t)>& read) override {
    ShardRows rows;
    Digest content;
    for (std::size_t begin = 0; begin < file_.size(); begin += kTogether) {
      const std::string bytes = file_.read(begin, std::min(file_.size(), begin + kTogether));
      content.add_text(bytes);
      read(bytes.size());
    }
    rows.content = content.value();
    columns_.emplace(reader_, number_, mapping_);
    rows.count = columns_->rows();
    for (std::size_t row = 0; row < rows.count;) {
      ShardPart part;
      part.file = number;
      part.begin = row;
      part.first = first + row;
      part.count = std::min(rows.count - row, together - part.first % together);
      part.line = row + 2;
      part.end = row += part.count;
      rows.parts.push_back(part);
    }
    return rows;
  }
  std::string read(const ShardPart& part) const override { return columns_->read(part.begin, part.end); }
  std::size_t bytes_of(const ShardPart& part) const override {
    return static_cast<std::size_t>(static_cast<double>(file_.size()) * static_cast<double>(part.count) /
                                    static_cast<double>(columns_->rows()));
  }
  InputError placed(const InputError& error, const ShardPart& part) const override {
    return at_row_of_columns(error, part.begin);
  }

 private:
  static constexpr std::size_t kTogether = std::size_t{4} << 20;

  std::shared_ptr<ColumnReader> reader_;
  std::size_t number_;
  ColumnMapping mapping_;
  std::optional<ColumnFile> columns_;
};

}  // namespace

std::vector<std::unique_ptr<ShardTable>> open_shard_tables(const std::vector<ShardFile>& files) {
  std::vector<std::filesystem::path> column_files;
  for (const ShardFile& file : files) {
    if (is_column_file(file.path)) column_files.push_back(file.path);
  }
  const auto reader = std::make_shared<ColumnReader>(column_files);
  std::vector<std::unique_ptr<ShardTable>> tables;
  std::size_t next = 0;
  for (const ShardFile& file : files) {
    if (next < column_files.size() && file.path == column_files[next]) {
      tables.push_back(std::make_unique<ColumnShard>(file, reader, next++));
    } else {
      tables.push_back(std::make_unique<TextShard>(file.path));
    }
  }
  return tables;
}

}  // namespace abbe
