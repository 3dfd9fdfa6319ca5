#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::test {

/// Writes a block of rows of a column file (column_block.h).
class ColumnBlockText {
 public:
  ColumnBlockText(std::size_t rows, std::size_t columns) : head_("\0columns", 8) {
    add_number(head_, rows);
    add_number(head_, columns);
  }

  void add_head(std::string_view name, std::string_view kind, bool is_read) {
    for (const std::string_view text : {name, kind}) {
      add_number(head_, text.size());
      head_ += text;
    }
    head_ += is_read ? '\1' : '\0';
  }
  /// @param present  of each value whether it is there; empty: all are
  void add_numbers(std::string_view name, std::string_view kind, const std::vector<double>& values,
                   const std::vector<bool>& present = {}) {
    add_head(name, kind, true);
    values_ += present.empty() ? '\1' : '\0';
    for (const bool one : present) values_ += one ? '\1' : '\0';
    values_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
  }
  void add_texts(std::string_view name, const std::vector<std::string>& texts) {
    add_head(name, "text", true);
    std::size_t at = 1000;  // as in a slice of a longer column
    std::string joined;
    add_number(values_, at);
    for (const std::string& text : texts) {
      add_number(values_, at += text.size());
      joined += text;
    }
    values_ += joined;
  }
  std::string text() const { return head_ + values_; }

 private:
  static void add_number(std::string& to, std::size_t number) {
    const auto value = static_cast<std::int64_t>(number);
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  }

  std::string head_, values_;
};

}  // namespace abbe::test
