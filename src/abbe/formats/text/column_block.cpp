#include "abbe/formats/text/column_block.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>

#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/csv_number.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

constexpr std::string_view kBlockMark("\0columns", 8);
constexpr const char* kText = "text";

/// Takes one thing after the other off a block.
class BlockReader {
 public:
  BlockReader(std::string_view block, const std::string& file) : block_(block), file_(file) {}

  std::string_view take(std::size_t count, std::size_t width = 1) {
    if (count > (block_.size() - at_) / width) fail();
    const std::string_view taken = block_.substr(at_, count * width);
    at_ += taken.size();
    return taken;
  }
  std::size_t number() {
    std::int64_t value = 0;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    if (value < 0) fail();
    return static_cast<std::size_t>(value);
  }
  bool flag() { return take(1)[0] != 0; }
  std::string text() { return std::string(take(number())); }
  std::size_t at() const { return at_; }
  void go_to(std::size_t at) { at_ = at; }
  [[noreturn]] void fail() const {
    throw InputError({.file = file_}, "the rows of its columns are cut off or damaged", "rows as pyarrow reads them");
  }

 private:
  std::string_view block_;
  const std::string& file_;
  std::size_t at_ = 0;
};

/// Where the values of a column are.
struct BlockValues {
  const ColumnOfBlock* column = nullptr;
  std::string_view present;  ///< a byte for each row; empty: all are there
  std::string_view numbers;  ///< doubles
  std::string_view ends;     ///< of texts, one more than there are rows
  std::string_view texts;

  bool is_text() const { return column->kind == kText; }
  bool has(std::size_t row) const { return present.empty() || present[row] != 0; }
  double number(std::size_t row) const {
    double value;
    std::memcpy(&value, numbers.data() + row * sizeof value, sizeof value);
    return value;
  }
  std::int64_t end(std::size_t row) const {
    std::int64_t value;
    std::memcpy(&value, ends.data() + row * sizeof value, sizeof value);
    return value;
  }
  std::string_view text(std::size_t row) const {
    const auto begin = static_cast<std::size_t>(end(row) - end(0));
    return texts.substr(begin, static_cast<std::size_t>(end(row + 1) - end(row)));
  }
};

BlockValues take_values(BlockReader& reader, const ColumnOfBlock& column, std::size_t rows) {
  BlockValues values;
  values.column = &column;
  if (!values.is_text()) {
    if (!reader.flag()) values.present = reader.take(rows);
    values.numbers = reader.take(rows, sizeof(double));
    return values;
  }
  if (rows == std::numeric_limits<std::size_t>::max()) reader.fail();
  values.ends = reader.take(rows + 1, sizeof(std::int64_t));
  for (std::size_t row = 0; row < rows; ++row) {
    if (values.end(row) < 0 || values.end(row + 1) < values.end(row)) reader.fail();
  }
  values.texts = reader.take(static_cast<std::size_t>(values.end(rows) - values.end(0)));
  return values;
}

struct BlockRefusal {
  std::size_t row = 0;
  std::string problem, expected;
};

/// Reads the values of one column into what is wanted.
class BlockColumnReader {
 public:
  BlockColumnReader(const BlockValues& from, const CsvColumn& wanted, const Unit* unit, std::size_t rows, CsvValues& to)
      : from_(from), wanted_(wanted), unit_(unit), rows_(rows), to_(to) {}

  std::optional<BlockRefusal> read() {
    if (wanted_.is_label) {
      to_.labels.resize(rows_);
    } else if (wanted_.is_text) {
      to_.words.resize(rows_);
    } else {
      to_.numbers.resize(rows_);
    }
    for (std::size_t row = 0; row < rows_; ++row) {
      if (wanted_.is_text ? !read_text(row) : !read_number(row)) return std::move(refusal_);
    }
    return std::nullopt;
  }

 private:
  bool refuse(std::size_t row, std::string problem, std::string expected) {
    refusal_ = {row, std::move(problem), std::move(expected)};
    return false;
  }

  bool read_number(std::size_t row) {
    double& value = to_.numbers[row];
    if (!from_.has(row)) {
      value = std::numeric_limits<double>::quiet_NaN();
      return wanted_.may_be_empty || refuse(row, "is empty", csv_expected_number(wanted_, *unit_));
    }
    const double number = from_.number(row);
    value = number * unit_->factor;
    if (unit_->decimal_shift == 0 && std::abs(value) <= kLargestInput && csv_in_range(value, wanted_.range))
      return true;
    // As text, so that a micrometre is a thousandth in decimal, and so that problems have the words of text.
    const std::string text = std::isfinite(number) ? shortest_text(number) : fmt::format("{}", number);
    std::string problem = csv_read_number(text, wanted_, *unit_, value);
    return problem.empty() || refuse(row, std::move(problem), csv_expected_number(wanted_, *unit_));
  }

  bool read_text(std::size_t row) {
    const std::string_view text = from_.is_text() ? from_.text(row) : whole_number(row);
    if (wanted_.is_label) {
      to_.labels[row] = text;
      return true;
    }
    if (text.empty()) return refuse(row, "is empty", "a name");
    // Few names in long runs: the last ones first.
    std::size_t word = to_.names.size();
    while (word > 0 && to_.names[word - 1] != text) --word;
    if (word == 0) {
      if (to_.names.size() == kLargestNameCount) {
        return refuse(row, "too many different names", fmt::format("at most {}", kLargestNameCount));
      }
      to_.names.emplace_back(text);
      word = to_.names.size();
    }
    to_.words[row] = static_cast<std::uint32_t>(word - 1);
    return true;
  }

  /// Names that are numbers: a table that was read from text has them as integers.
  std::string_view whole_number(std::size_t row) {
    number_ = from_.has(row) ? shortest_text(from_.number(row)) : "";
    return number_;
  }

  const BlockValues& from_;
  const CsvColumn& wanted_;
  const Unit* unit_;
  std::size_t rows_;
  CsvValues& to_;
  std::string number_;
  BlockRefusal refusal_;
};

void require_kind(const ColumnOfBlock& column, const CsvFileColumn& as, const CsvColumn& wanted,
                  const std::string& file) {
  const bool is_number = column.kind == "float" || column.kind == "integer";
  if (wanted.is_text ? column.kind == kText || column.kind == "integer" : is_number) return;
  throw InputError({.file = file, .field = column.name}, fmt::format("the column holds values of type {}", column.kind),
                   wanted.is_text ? "text (string), or integers"
                                  : csv_expected_number(wanted, *as.unit) + " as float64, float32 or integers");
}

std::string header_of(const ColumnBlockHead& head) {
  std::string header;
  for (const ColumnOfBlock& column : head.columns) header += (header.empty() ? "" : ",") + csv_field(column.name);
  return header;
}

}  // namespace

bool is_column_block(std::string_view text) { return text.starts_with(kBlockMark); }

ColumnBlockHead column_block_head(std::string_view block, const std::string& file) {
  BlockReader reader(block, file);
  if (reader.take(kBlockMark.size()) != kBlockMark) reader.fail();
  ColumnBlockHead head;
  head.rows = reader.number();
  for (std::size_t left = reader.number(); left > 0; --left) {
    ColumnOfBlock& column = head.columns.emplace_back();
    column.name = reader.text();
    column.kind = reader.text();
    column.is_read = reader.flag();
  }
  head.values_at = reader.at();
  return head;
}

CsvTable read_column_block(std::string_view block, const std::string& file, const std::vector<CsvColumn>& wanted,
                           const ColumnMapping& mapping, int threads) {
  const ColumnBlockHead head = column_block_head(block, file);
  if (head.columns.empty()) throw InputError({.file = file}, "there are no columns", "columns of readings");
  const std::vector<CsvFileColumn> as = csv_match_header(header_of(head), file, 0, wanted, mapping);
  if (head.rows == 0) throw InputError({.file = file}, "there are no rows", "at least one row");
  BlockReader reader(block, file);
  reader.go_to(head.values_at);
  std::vector<BlockValues> values(head.columns.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool is_wanted = as[i].wanted != kUnreadColumn;
    if (is_wanted) require_kind(head.columns[i], as[i], wanted[as[i].wanted], file);
    if (head.columns[i].is_read) values[i] = take_values(reader, head.columns[i], head.rows);
    if (is_wanted && values[i].column == nullptr) reader.fail();
  }
  CsvTable table;
  table.rows = head.rows;
  table.columns.resize(wanted.size());
  std::vector<std::optional<BlockRefusal>> refusals(values.size());
  for_each_block(values.size(), threads, [&](std::size_t i) {
    if (as[i].wanted == kUnreadColumn) return;
    CsvValues& to = table.columns[as[i].wanted];
    to.present = true;
    to.header = as[i].name;
    refusals[i] = BlockColumnReader(values[i], wanted[as[i].wanted], as[i].unit, head.rows, to).read();
  });
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < refusals.size(); ++i) {
    if (refusals[i] && (!first || refusals[i]->row < refusals[*first]->row)) first = i;
  }
  if (first) {
    const BlockRefusal& refusal = *refusals[*first];
    throw InputError({file, refusal.row + 2, 0, as[*first].name}, refusal.problem, refusal.expected);
  }
  return table;
}

}  // namespace abbe
