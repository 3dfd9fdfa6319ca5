#include "abbe/formats/import/table_facts.h"

#include <algorithm>

#include "abbe/formats/import/foreign_number.h"
#include "abbe/formats/import/foreign_row.h"
#include "abbe/formats/import/foreign_unit.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/text_blocks.h"
#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

struct FactBlock : TextBlock {
  std::vector<ColumnFacts> columns;
};

void add_word(std::string_view word, ColumnFacts& facts) {
  if (facts.more_words) return;
  if (std::find(facts.words.begin(), facts.words.end(), word) != facts.words.end()) return;
  facts.more_words = facts.words.size() == ColumnFacts::kMostWords;
  if (!facts.more_words) facts.words.emplace_back(word);
}

void add_value(double value, ColumnFacts& facts) {
  const bool first = facts.numbers == 0;
  facts.smallest = first ? value : std::min(facts.smallest, value);
  facts.largest = first ? value : std::max(facts.largest, value);
  ++facts.numbers;
}

void add_field(std::string_view field, const NumberNotation& notation, std::string& buffer, ColumnFacts& facts) {
  if (field.empty()) {
    ++facts.empty;
    return;
  }
  add_word(field, facts);
  double value = 0;
  const std::string_view plain = plain_number(field, notation, buffer);
  if (!plain.empty() && parse_number(plain, 0, value) == NumberProblem::none) {
    add_value(value, facts);
  } else if (!sexagesimal_arcseconds(field, notation.decimal, buffer).empty()) {
    ++facts.sexagesimal;
  } else {
    ++facts.texts;
  }
}

void join_facts(const ColumnFacts& more, ColumnFacts& facts) {
  if (more.numbers > 0) {
    const bool first = facts.numbers == 0;
    facts.smallest = first ? more.smallest : std::min(facts.smallest, more.smallest);
    facts.largest = first ? more.largest : std::max(facts.largest, more.largest);
  }
  facts.numbers += more.numbers;
  facts.sexagesimal += more.sexagesimal;
  facts.texts += more.texts;
  facts.empty += more.empty;
  for (const std::string& word : more.words) add_word(word, facts);
  facts.more_words = facts.more_words || more.more_words;
}

void read_block(std::string_view text, const FoundLayout& found, FactBlock& block) {
  block.columns.resize(found.names.size());
  const TableLayout& layout = found.layout;
  const NumberNotation notation{layout.decimal, layout.thousands};
  ForeignRow row;
  std::string buffer;
  for (std::size_t at = block.begin; at < block.end;) {
    const std::string_view line = csv_next_line(text, at);
    // Rows of another length are told where they are read.
    if (kind_of_line(line, layout) != ForeignLine::row || !row.split(line, layout.separator)) continue;
    const std::size_t count = std::min(row.fields().size(), block.columns.size());
    for (std::size_t i = 0; i < count; ++i) add_field(row.fields()[i].text, notation, buffer, block.columns[i]);
  }
}

}  // namespace

std::vector<ColumnFacts> column_facts(std::string_view text, const FoundLayout& found) {
  auto blocks = split_into_blocks<FactBlock>(text, line_start(text, found.layout.first_line));
  for_each_block(blocks.size(), 0, [&](std::size_t i) { read_block(text, found, blocks[i]); });
  std::vector<ColumnFacts> columns(found.names.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (const FactBlock& block : blocks) join_facts(block.columns[i], columns[i]);
    columns[i].header = found.names[i];
    auto [name, unit] = split_header(found.names[i]);
    columns[i].name = std::move(name);
    const std::string stated(without_brackets(found.units[i]));
    columns[i].unit = stated.empty() || stated == "-" ? std::move(unit) : stated;
  }
  return columns;
}

}  // namespace abbe
