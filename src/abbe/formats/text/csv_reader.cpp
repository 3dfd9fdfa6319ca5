#include "abbe/formats/text/csv_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "abbe/formats/text/column_block.h"
#include "abbe/formats/text/csv_number.h"
#include "abbe/formats/text/csv_rows.h"
#include "abbe/formats/text/decimal_text.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"
#include "abbe/formats/text/text_blocks.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

/// A run of whole lines and where its rows belong.
struct RowBlock : TextBlock {
  std::size_t rows = 0;
  std::size_t first_row = 0;
  std::vector<std::vector<std::string>> names;  // per wanted text column, in order of appearance here
};

/// What to do with one column of the file, in the form the inner loop needs.
struct Target {
  const CsvFileColumn* column = nullptr;
  const CsvColumn* wanted = nullptr;
  double* numbers = nullptr;
  std::uint32_t* words = nullptr;
  std::string* labels = nullptr;
  int decimal_shift = 0;
  double factor = 1;
};

std::size_t count_rows(std::string_view text, std::size_t begin, std::size_t end) {
  std::size_t rows = 0;
  for (std::size_t at = begin; at < end;) {
    const char first = text[at];
    if ((first >= '-' && first <= '9') || first == '"') {
      const void* line_end = std::memchr(text.data() + at, '\n', end - at);
      at = line_end == nullptr ? end : static_cast<std::size_t>(static_cast<const char*>(line_end) - text.data()) + 1;
      ++rows;
    } else if (!csv_is_passed_over(csv_next_line(text, at))) {
      ++rows;
    }
  }
  return rows;
}

/// @returns the place behind the number, a comma or the end, or null if it has to be read the long way
const char* fast_number(const char* at, const char* end, int decimal_shift, double& value) {
  while (at != end && *at == ' ') ++at;
  at = read_short_decimal(at, end, decimal_shift, value);
  return at == nullptr || at == end || *at == ',' ? at : nullptr;
}

class RowReader {
 public:
  RowReader(std::string_view text, const std::vector<Target>& targets, std::size_t wanted, RowBlock& block)
      : text_(text), targets_(targets), block_(block) {
    block_.names.resize(wanted);
  }

  void read() {
    std::size_t row = block_.first_row;
    for (std::size_t at = block_.begin; at < block_.end;) {
      const std::string_view line = csv_next_line(text_, at);
      if (csv_is_passed_over(line)) continue;
      if (!read_row(line, row)) return;
      ++row;
    }
  }

 private:
  bool refuse(const char* at, const std::string& field, std::string problem, std::string expected) {
    block_.refusal =
        TextRefusal{static_cast<std::size_t>(at - text_.data()), field, std::move(problem), std::move(expected)};
    return false;
  }

  bool read_row(std::string_view line, std::size_t row) {
    const char* at = line.data();
    const char* const end = at + line.size();
    bool more = true;
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      const Target& target = targets_[i];
      if (!more) return refuse_length(line, i);
      const char* const start = at;
      double value = 0;
      if (target.numbers != nullptr) {
        const char* const behind = fast_number(at, end, target.decimal_shift, value);
        value *= target.factor;
        if (behind != nullptr && std::abs(value) <= kLargestInput && csv_in_range(value, target.wanted->range)) {
          target.numbers[row] = value;
          more = behind != end;
          at = more ? behind + 1 : behind;
          continue;
        }
      }
      std::string_view rest(at, static_cast<std::size_t>(end - at)), field;
      if (!csv_take_field(rest, field, unquoted_, more)) {
        return refuse(start, target.column->name, "the quote is not closed before the comma or the end of the line",
                      "");
      }
      at = rest.data();
      if (!read_field(field, start, target, row)) return false;
    }
    return more ? refuse_length(line, targets_.size() + 1) : true;
  }

  bool read_field(std::string_view field, const char* start, const Target& target, std::size_t row) {
    if (target.wanted == nullptr) return true;
    if (target.labels != nullptr) {
      target.labels[row] = field;
      return true;
    }
    if (target.words != nullptr) {
      if (field.empty()) return refuse(start, target.column->name, "is empty", "a name");
      const std::uint32_t word = word_index(field, target.column->wanted);
      if (word >= kLargestNameCount) {
        return refuse(start, target.column->name, "too many different names",
                      fmt::format("at most {}", kLargestNameCount));
      }
      target.words[row] = word;
      return true;
    }
    if (field.empty() && target.wanted->may_be_empty) {
      target.numbers[row] = std::numeric_limits<double>::quiet_NaN();
      return true;
    }
    double value = 0;
    const CsvColumn& wanted = *target.wanted;
    std::string problem = csv_read_number(field, wanted, *target.column->unit, value);
    if (!problem.empty()) {
      return refuse(start, target.column->name, std::move(problem), csv_expected_number(wanted, *target.column->unit));
    }
    target.numbers[row] = value;
    return true;
  }

  std::uint32_t word_index(std::string_view word, std::size_t wanted) {
    std::vector<std::string>& names = block_.names[wanted];
    // Few names in long runs: the last ones first.
    for (std::size_t i = names.size(); i-- > 0;) {
      if (names[i] == word) return static_cast<std::uint32_t>(i);
    }
    names.emplace_back(word);
    return static_cast<std::uint32_t>(names.size() - 1);
  }

  bool refuse_length(std::string_view line, std::size_t at_least) {
    const std::size_t fields =
        at_least > targets_.size() ? 1 + static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) : at_least;
    return refuse(line.data(), "", "the row has " + counted(fields, "field", "fields"),
                  fmt::format("{} as in the header", targets_.size()));
  }

  std::string_view text_;
  const std::vector<Target>& targets_;
  RowBlock& block_;
  std::string unquoted_;
};

/// Names of all blocks in order of appearance; renumbers the words of the blocks.
void join_names(const std::vector<RowBlock>& blocks, std::size_t wanted, CsvValues& values) {
  std::map<std::string, std::uint32_t, std::less<>> index;
  std::vector<std::uint32_t> renumbered;
  for (const RowBlock& block : blocks) {
    renumbered.clear();
    for (const std::string& name : block.names[wanted]) {
      const auto [entry, is_new] = index.emplace(name, static_cast<std::uint32_t>(values.names.size()));
      if (is_new) values.names.push_back(name);
      renumbered.push_back(entry->second);
    }
    for (std::size_t row = block.first_row; row < block.first_row + block.rows; ++row) {
      values.words[row] = renumbered[values.words[row]];
    }
  }
}

void make_room(const CsvColumn& wanted, std::size_t rows, CsvValues& values) {
  if (wanted.is_label) {
    values.labels.resize(rows);
  } else if (wanted.is_text) {
    values.words.resize(rows);
  } else {
    values.numbers.resize(rows);
  }
}

std::vector<Target> targets_of(const std::vector<CsvFileColumn>& columns, const std::vector<CsvColumn>& wanted,
                               CsvTable& table) {
  std::vector<Target> targets;
  for (const CsvFileColumn& column : columns) {
    Target target;
    target.column = &column;
    if (column.wanted != kUnreadColumn) {
      CsvValues& values = table.columns[column.wanted];
      values.present = true;
      values.header = column.name;
      target.wanted = &wanted[column.wanted];
      if (target.wanted->is_label) {
        target.labels = values.labels.data();
      } else if (target.wanted->is_text) {
        target.words = values.words.data();
      } else {
        target.numbers = values.numbers.data();
        target.decimal_shift = column.unit->decimal_shift;
        target.factor = column.unit->factor;
      }
    }
    targets.push_back(target);
  }
  return targets;
}

}  // namespace

CsvRows::CsvRows(std::string_view text, std::string file, std::vector<CsvColumn> wanted, const ColumnMapping& mapping)
    : text_(text), file_(std::move(file)), wanted_(std::move(wanted)) {
  if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);
  std::size_t header_at = 0;
  std::string_view header;
  while (first_ < text_.size() && csv_is_passed_over(header)) {
    header_at = first_;
    header = csv_next_line(text_, first_);
  }
  if (csv_is_passed_over(header)) {
    throw InputError({file_, 0, 0, ""}, "the file is empty", "a header line with column names");
  }
  columns_ = csv_match_header(header, file_, text_line(text_, header_at), wanted_, mapping);
}

std::optional<TextRefusal> CsvRows::read(std::size_t begin, std::size_t end, CsvTable& table) const {
  RowBlock block;
  block.begin = begin;
  block.end = end;
  block.rows = count_rows(text_, begin, end);
  table.rows = block.rows;
  table.columns.resize(wanted_.size());
  for (const CsvFileColumn& column : columns_) {
    if (column.wanted != kUnreadColumn) make_room(wanted_[column.wanted], block.rows, table.columns[column.wanted]);
  }
  const std::vector<Target> targets = targets_of(columns_, wanted_, table);
  RowReader(text_, targets, wanted_.size(), block).read();
  if (block.refusal) return std::move(block.refusal);
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    table.columns[i].names = wanted_[i].is_text ? std::move(block.names[i]) : std::vector<std::string>();
  }
  return std::nullopt;
}

std::size_t CsvRows::count(std::size_t begin, std::size_t end) const { return count_rows(text_, begin, end); }

std::size_t CsvRows::row_offset(std::size_t begin, std::size_t row) const {
  for (std::size_t at = begin; at < text_.size();) {
    const std::size_t start = at;
    if (!csv_is_passed_over(csv_next_line(text_, at)) && row-- == 0) return start;
  }
  return text_.size();
}

CsvTable read_csv(std::string_view text, const std::string& file, const std::vector<CsvColumn>& wanted,
                  const ColumnMapping& mapping, int threads) {
  if (is_column_block(text)) return read_column_block(text, file, wanted, mapping, threads);
  const CsvRows rows(text, file, wanted, mapping);
  text = rows.text();
  const std::vector<CsvFileColumn>& columns = rows.columns();
  std::vector<RowBlock> blocks = split_into_blocks<RowBlock>(text, rows.first());
  for_each_block(blocks.size(), threads,
                 [&](std::size_t i) { blocks[i].rows = count_rows(text, blocks[i].begin, blocks[i].end); });
  CsvTable table;
  for (RowBlock& block : blocks) {
    block.first_row = table.rows;
    table.rows += block.rows;
  }
  if (table.rows == 0) throw InputError({file, 0, 0, ""}, "there are no rows below the header", "at least one row");

  table.columns.resize(wanted.size());
  // The first touch of so much memory takes its time: on all threads too.
  for_each_block(columns.size(), threads, [&](std::size_t i) {
    const std::size_t column = columns[i].wanted;
    if (column != kUnreadColumn) make_room(wanted[column], table.rows, table.columns[column]);
  });
  const std::vector<Target> targets = targets_of(columns, wanted, table);
  for_each_block(blocks.size(), threads,
                 [&](std::size_t i) { RowReader(text, targets, wanted.size(), blocks[i]).read(); });

  for (const RowBlock& block : blocks) {
    if (block.refusal) throw_refusal(text, file, *block.refusal);
  }
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (!table.columns[i].words.empty()) join_names(blocks, i, table.columns[i]);
  }
  return table;
}

std::size_t csv_line(std::string_view text, std::size_t row) {
  if (is_column_block(text)) return row + 2;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  std::size_t line = 0;
  bool header_seen = false;
  for (std::size_t at = 0; at < text.size();) {
    ++line;
    if (csv_is_passed_over(csv_next_line(text, at))) continue;
    if (header_seen && row-- == 0) return line;
    header_seen = true;
  }
  return line;
}

std::vector<std::size_t> csv_lines(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  std::vector<std::size_t> lines;
  if (is_column_block(text)) {
    lines.resize(column_block_head(text, "").rows);
    std::iota(lines.begin(), lines.end(), 2);
    return lines;
  }
  std::size_t line = 0;
  bool header_seen = false;
  for (std::size_t at = 0; at < text.size();) {
    ++line;
    if (csv_is_passed_over(csv_next_line(text, at))) continue;
    if (header_seen) lines.push_back(line);
    header_seen = true;
  }
  return lines;
}

std::string csv_field(std::string_view text) {
  const bool plain = !text.empty() && text.find_first_of(",\"#\r\n") == std::string_view::npos &&
                     csv_trimmed(text).size() == text.size();
  if (plain) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace abbe
