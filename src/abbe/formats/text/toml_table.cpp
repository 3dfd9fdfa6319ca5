#include "abbe/formats/text/toml_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <system_error>
#include <utility>

#include "abbe/formats/text/toml_document.h"
#include "abbe/formats/text/utf8.h"

namespace abbe {

struct TomlTable::State {
  std::shared_ptr<const TomlDocument> document;
  const toml::table* table = nullptr;
  std::string prefix;  // "axis.X."
  struct Asked {
    std::string base;
    Quantity quantity;
  };
  std::vector<Asked> asked;
  std::vector<std::string> accepted;  // every key that would have been read
  std::set<std::string, std::less<>> consumed;

  std::string name(std::string_view key) const {
    if (key.empty()) return prefix.empty() ? "" : prefix.substr(0, prefix.size() - 1);
    return prefix + std::string(key);
  }

  toml::source_position position(std::string_view key) const {
    const auto entry = table->find(key);
    return entry == table->end() ? table->source().begin : entry->first.source().begin;
  }

  [[noreturn]] void fail(std::string_view key, const std::string& problem, const std::string& expected) const {
    throw InputError(document->place(position(key), name(key)), problem, expected);
  }

  [[noreturn]] void fail_at(const toml::node& node, const std::string& field, const std::string& problem,
                            const std::string& expected) const {
    throw InputError(document->place(node.source().begin, field), problem, expected);
  }

  /// The node of a key, or null; remembers that it was asked for.
  const toml::node* look(std::string_view key) {
    accepted.emplace_back(key);
    const toml::node* node = table->get(key);
    if (node != nullptr) consumed.emplace(key);
    return node;
  }

  const toml::node& need(std::string_view key, const std::string& expected) {
    const toml::node* node = look(key);
    if (node == nullptr) {
      for (const std::string& other : unconsumed()) {
        const std::vector<std::string> wanted = {std::string(key)};
        if (!nearest_name(other, wanted).empty()) fail(other, "unknown key", std::string(key));
      }
      fail_missing(std::string(key), expected);
    }
    return *node;
  }

  [[noreturn]] void fail_missing(const std::string& what, const std::string& expected) const {
    throw InputError(document->place(table->source().begin, name(what)), "missing", expected);
  }

  std::vector<std::string> unconsumed() const {
    std::vector<std::pair<toml::source_position, std::string>> found;
    for (const auto& [key, node] : *table) {
      if (consumed.find(key.str()) == consumed.end()) found.emplace_back(key.source().begin, key.str());
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::string> names;
    for (auto& [position, key] : found) names.push_back(std::move(key));
    return names;
  }

  /// If the key is a base with a missing or wrong unit: throws.
  void refuse_wrong_unit(const std::string& key, const std::string& base, Quantity quantity) const {
    const std::string expected = accepted_names(base, quantity);
    if (key == base) fail(key, "the unit is missing from the name", expected);
    if (key.starts_with(base + "_")) {
      const std::string rest = key.substr(base.size() + 1);
      if (quantity == Quantity::dimensionless) fail(key, "unknown key", expected + ", a number without unit");
      fail(key, fmt::format("'{}' is not a unit of {}", rest, quantity_words(quantity)), expected);
    }
  }

  /// Node and unit of a quantity, or null.
  std::pair<const toml::node*, const Unit*> look_quantity(std::string_view base, Quantity quantity, std::string& key) {
    asked.push_back({std::string(base), quantity});
    std::pair<const toml::node*, const Unit*> found{nullptr, nullptr};
    for (const Unit& unit : units_of(quantity)) {
      const std::string candidate = unit.suffix.empty() ? std::string(base) : fmt::format("{}_{}", base, unit.suffix);
      const toml::node* node = look(candidate);
      if (node == nullptr) continue;
      if (found.first != nullptr)
        fail(candidate, fmt::format("is given together with {}", name(key)), "only one of them");
      found = {node, &unit};
      key = candidate;
    }
    return found;
  }

  std::pair<const toml::node*, const Unit*> need_quantity(std::string_view base, Quantity quantity, std::string& key,
                                                          std::string_view what) {
    const auto found = look_quantity(base, quantity, key);
    if (found.first == nullptr) {
      for (const std::string& other : unconsumed()) refuse_wrong_unit(other, std::string(base), quantity);
      for (const std::string& other : unconsumed()) {
        const std::string_view near = nearest_name(other, accepted);
        if (unit_of_name(near, base, quantity) != nullptr) fail(other, "unknown key", std::string(near));
      }
      const std::string shown =
          std::string(base) +
          (quantity == Quantity::dimensionless ? "" : "_" + std::string(units_of(quantity)[0].suffix));
      fail_missing(shown, fmt::format("{} ({})", what, accepted_names(base, quantity)));
    }
    return found;
  }

  double value(const toml::node& node, const Unit& unit, Quantity quantity, const std::string& field) const {
    const std::string expected = unit.suffix.empty() ? std::string(quantity_words(quantity))
                                                     : fmt::format("{} in {}", quantity_words(quantity), unit.suffix);
    if (!node.is_number()) fail_at(node, field, "is not a number", expected);
    std::string text = document->number_text(node.source().begin);
    double result = 0;
    NumberProblem problem = parse_quantity(text, unit, result);
    if (problem == NumberProblem::not_a_number) {  // 0x10, inf, nan: not plain decimals
      text = node.is_integer() ? fmt::format("{}", node.as_integer()->get())
                               : fmt::format("{}", node.as_floating_point()->get());
      problem = parse_quantity(text, unit, result);
    }
    if (problem == NumberProblem::too_large) {
      fail_at(node, field, fmt::format("{} is too large", text),
              fmt::format("{}, at most 1e9 {}", expected, units_of(quantity)[0].suffix));
    }
    if (problem != NumberProblem::none) fail_at(node, field, fmt::format("{} is not a finite number", text), expected);
    return result;
  }

  std::vector<double> values(const toml::node& node, const Unit& unit, Quantity quantity, const std::string& field,
                             std::size_t count) const {
    const std::string expected =
        count == npos
            ? fmt::format("an array of numbers{}{}", unit.suffix.empty() ? "" : " in ", unit.suffix)
            : fmt::format("an array of {} numbers{}{}", count, unit.suffix.empty() ? "" : " in ", unit.suffix);
    const toml::array* array = node.as_array();
    if (array == nullptr) fail_at(node, field, "is not an array", expected);
    if (count != npos && array->size() != count) {
      fail_at(node, field, fmt::format("has {} elements", array->size()), expected);
    }
    std::vector<double> result;
    result.reserve(array->size());
    for (const toml::node& element : *array) {
      result.push_back(value(element, unit, quantity, fmt::format("{}[{}]", field, result.size() + 1)));
    }
    return result;
  }

  std::int64_t whole(const toml::node& node, const std::string& field, std::int64_t smallest,
                     std::int64_t largest) const {
    const std::string expected = fmt::format("a whole number from {} to {}", smallest, largest);
    if (!node.is_integer()) fail_at(node, field, "is not a whole number", expected);
    const std::int64_t result = node.as_integer()->get();
    if (result < smallest || result > largest) fail_at(node, field, fmt::format("is {}", result), expected);
    return result;
  }

  std::string string(const toml::node& node, const std::string& field) const {
    if (!node.is_string()) fail_at(node, field, "is not a text", "a text in quotes");
    // Names go into messages, comments of programs and tables, where a line feed would begin another line.
    if (has_control_character(node.as_string()->get())) {
      fail_at(node, field, "has control characters in it", "a text on one line");
    }
    return node.as_string()->get();
  }
};

TomlTable TomlTable::parse(std::string text, const std::string& file) {
  auto state = std::make_shared<State>();
  state->document = std::make_shared<const TomlDocument>(std::move(text), file);
  state->table = &state->document->root();
  return TomlTable(std::move(state));
}

const std::string& TomlTable::file() const { return state_->document->file(); }
std::string TomlTable::full_name(std::string_view key) const { return state_->name(key); }
bool TomlTable::has(std::string_view key) const { return state_->table->contains(key); }

bool TomlTable::is_text(std::string_view key) const {
  const toml::node* node = state_->table->get(key);
  return node != nullptr && node->is_string();
}

bool TomlTable::has(std::string_view base, Quantity quantity) const {
  for (const auto& [key, node] : *state_->table) {
    if (unit_of_name(key.str(), base, quantity) != nullptr) return true;
  }
  return false;
}

std::vector<std::string> TomlTable::keys() const {
  State all = *state_;
  all.consumed.clear();
  return all.unconsumed();
}

std::string TomlTable::text(std::string_view key) {
  return state_->string(state_->need(key, "a text in quotes"), full_name(key));
}

std::string TomlTable::free_text(std::string_view key) {
  const toml::node& node = state_->need(key, "a text in quotes");
  return node.is_string() ? node.as_string()->get() : state_->string(node, full_name(key));
}

std::string TomlTable::text_or(std::string_view key, std::string otherwise) {
  const toml::node* node = state_->look(key);
  return node == nullptr ? std::move(otherwise) : state_->string(*node, full_name(key));
}

bool TomlTable::boolean_or(std::string_view key, bool otherwise) {
  const toml::node* node = state_->look(key);
  if (node == nullptr) return otherwise;
  if (!node->is_boolean()) state_->fail_at(*node, full_name(key), "is neither true nor false", "true or false");
  return node->as_boolean()->get();
}

std::int64_t TomlTable::integer(std::string_view key, std::int64_t smallest, std::int64_t largest) {
  const toml::node& node = state_->need(key, fmt::format("a whole number from {} to {}", smallest, largest));
  return state_->whole(node, full_name(key), smallest, largest);
}

std::int64_t TomlTable::integer_or(std::string_view key, std::int64_t otherwise, std::int64_t smallest,
                                   std::int64_t largest) {
  const toml::node* node = state_->look(key);
  return node == nullptr ? otherwise : state_->whole(*node, full_name(key), smallest, largest);
}

std::vector<std::int64_t> TomlTable::integers(std::string_view key, std::int64_t smallest, std::int64_t largest) {
  const toml::node& node = state_->need(key, "an array of whole numbers");
  if (!node.is_array()) state_->fail_at(node, full_name(key), "is not an array", "an array of whole numbers");
  std::vector<std::int64_t> result;
  for (const toml::node& element : *node.as_array()) {
    result.push_back(
        state_->whole(element, fmt::format("{}[{}]", full_name(key), result.size() + 1), smallest, largest));
  }
  return result;
}

std::vector<std::string> TomlTable::texts(std::string_view key) {
  const toml::node& node = state_->need(key, "a text or an array of texts");
  if (!node.is_array()) return {state_->string(node, full_name(key))};
  std::vector<std::string> result;
  for (const toml::node& element : *node.as_array()) {
    result.push_back(state_->string(element, fmt::format("{}[{}]", full_name(key), result.size() + 1)));
  }
  return result;
}

std::vector<std::string> TomlTable::texts_or_none(std::string_view key) {
  if (has(key)) return texts(key);
  state_->look(key);
  return {};
}

double TomlTable::number(std::string_view base, Quantity quantity) {
  std::string key;
  const auto [node, unit] = state_->need_quantity(base, quantity, key, quantity_words(quantity));
  return state_->value(*node, *unit, quantity, full_name(key));
}

std::optional<double> TomlTable::optional_number(std::string_view base, Quantity quantity) {
  std::string key;
  const auto [node, unit] = state_->look_quantity(base, quantity, key);
  if (node == nullptr) return std::nullopt;
  return state_->value(*node, *unit, quantity, full_name(key));
}

double TomlTable::number_or(std::string_view base, Quantity quantity, double otherwise) {
  return optional_number(base, quantity).value_or(otherwise);
}

double TomlTable::size_or(std::string_view base, Quantity quantity, double otherwise) {
  const double result = number_or(base, quantity, otherwise);
  if (result < 0)
    fail_quantity(base, quantity, "is negative", fmt::format("{} not below zero", quantity_words(quantity)));
  return result;
}

std::vector<double> TomlTable::numbers(std::string_view base, Quantity quantity, std::size_t count) {
  std::string key;
  const std::string what = count == npos ? "an array of numbers" : fmt::format("an array of {} numbers", count);
  const auto [node, unit] = state_->need_quantity(base, quantity, key, what);
  return state_->values(*node, *unit, quantity, full_name(key), count);
}

std::optional<std::vector<double>> TomlTable::optional_numbers(std::string_view base, Quantity quantity,
                                                               std::size_t count) {
  std::string key;
  const auto [node, unit] = state_->look_quantity(base, quantity, key);
  if (node == nullptr) return std::nullopt;
  return state_->values(*node, *unit, quantity, full_name(key), count);
}

std::size_t TomlTable::word(std::string_view key, std::initializer_list<std::string_view> words) {
  return word(key, std::vector<std::string_view>(words));
}

std::size_t TomlTable::word(std::string_view key, const std::vector<std::string_view>& words) {
  const std::string found = text_or(key, "");
  const auto at = std::find(words.begin(), words.end(), found);
  if (at != words.end()) return static_cast<std::size_t>(at - words.begin());
  std::string expected;
  std::size_t left = words.size();
  for (const std::string_view choice : words) {
    expected += fmt::format("\"{}\"{}", choice, --left == 0 ? "" : left == 1 ? " or " : ", ");
  }
  if (!has(key)) state_->fail_missing(std::string(key), expected);
  fail(key, fmt::format("unknown word \"{}\"", found), expected);
}

std::size_t TomlTable::word_or(std::string_view key, std::size_t otherwise,
                               std::initializer_list<std::string_view> words) {
  if (has(key)) return word(key, words);
  state_->look(key);
  return otherwise;
}

TomlTable TomlTable::table(std::string_view key) {
  state_->need(key, fmt::format("a table [{}]", full_name(key)));
  return *optional_table(key);
}

std::optional<TomlTable> TomlTable::optional_table(std::string_view key) {
  const toml::node* node = state_->look(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_table()) state_->fail_at(*node, full_name(key), "is not a table", fmt::format("[{}]", full_name(key)));
  auto child = std::make_shared<State>();
  child->document = state_->document;
  child->table = node->as_table();
  child->prefix = full_name(key) + ".";
  return TomlTable(std::move(child));
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) {
  std::vector<TomlTable> result;
  const toml::node* node = state_->look(key);
  if (node == nullptr) return result;
  const std::string expected = fmt::format("tables [[{}]]", full_name(key));
  if (!node->is_array()) state_->fail_at(*node, full_name(key), "is not an array of tables", expected);
  for (const toml::node& element : *node->as_array()) {
    if (!element.is_table()) state_->fail_at(element, full_name(key), "is not a table", expected);
    auto child = std::make_shared<State>();
    child->document = state_->document;
    child->table = element.as_table();
    child->prefix = fmt::format("{}[{}].", full_name(key), result.size() + 1);
    result.push_back(TomlTable(std::move(child)));
  }
  return result;
}

void TomlTable::finish() {
  for (const std::string& key : state_->unconsumed()) {
    const State::Asked* longest = nullptr;
    for (const State::Asked& asked : state_->asked) {
      if (key != asked.base && !key.starts_with(asked.base + "_")) continue;
      if (longest == nullptr || asked.base.size() > longest->base.size()) longest = &asked;
    }
    if (longest != nullptr) state_->refuse_wrong_unit(key, longest->base, longest->quantity);
    const std::string_view near = nearest_name(key, state_->accepted);
    fail(key, near.empty() ? "unknown key" : fmt::format("unknown key, did you mean {}?", near));
  }
}

InputError::Place TomlTable::place(std::string_view key) const {
  return state_->document->place(state_->position(key), state_->name(key));
}

void TomlTable::fail(std::string_view key, const std::string& problem, const std::string& expected) const {
  state_->fail(key, problem, expected);
}

void TomlTable::fail_quantity(std::string_view base, Quantity quantity, const std::string& problem,
                              const std::string& expected) const {
  for (const auto& [key, node] : *state_->table) {
    if (unit_of_name(key.str(), base, quantity) != nullptr) fail(key.str(), problem, expected);
  }
  fail(base, problem, expected);
}

std::string TomlTable::file_name(std::string_view key) {
  constexpr std::size_t kLongest = 100;
  std::string name = text(key);
  const bool is_plain = name.find_first_of("/\t") == std::string::npos;
  if (name.empty() || name.size() > kLongest || name.front() == '.' || !is_plain) {
    fail(key, "cannot be the name of a file", "1 to 100 bytes without \"/\" and control characters, no dot in front");
  }
  return name;
}

std::filesystem::path TomlTable::file(std::string_view key, const std::filesystem::path& folder,
                                      const std::string& expected) {
  std::filesystem::path path = folder / text(key);
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) fail(key, fmt::format("there is no file {}", path.string()), expected);
  return path;
}

}  // namespace abbe
