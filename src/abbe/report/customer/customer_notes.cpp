#include "abbe/report/customer/customer_notes.h"

#include <cctype>
#include <vector>

#include "abbe/report/customer/customer_note_words.h"

namespace abbe {
namespace {

constexpr std::string_view kBetween = ", ";  // of a list

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// A number as readers of the language write it, with what stands behind it: "-1.5 µm"; and "9 x 9".
/// Text that does not begin with a number is a name, which stays.
std::string local_amount(std::string_view text, ReportLanguage language) {
  const std::size_t sign = text.starts_with('-') ? 1 : 0;
  if (text.size() <= sign || !is_digit(text[sign])) return std::string(text);
  std::string result = sign == 0 ? "" : "\xE2\x88\x92";
  for (std::size_t i = sign; i < text.size(); ++i) {
    const bool is_between = i > sign && i + 1 < text.size() && is_digit(text[i - 1]) && is_digit(text[i + 1]);
    if (text[i] == '.' && is_between && language == ReportLanguage::german) {
      result += ',';
    } else if (text.substr(i).starts_with(" x ")) {
      result += " \xC3\x97 ";
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

std::string filled(std::string_view text, const std::vector<std::string>& arguments) {
  std::string result;
  while (!text.empty()) {
    if (text.size() > 2 && text[0] == '{' && is_digit(text[1]) && text[2] == '}') {
      result += arguments.at(static_cast<std::size_t>(text[1] - '0'));
      text.remove_prefix(3);
    } else {
      result += text.front();
      text.remove_prefix(1);
    }
  }
  return result;
}

/// Place of an argument in an English format.
struct Place {
  std::size_t at = std::string_view::npos, size = 0;
  bool may_be_list = false, must_be_word = false;
};

Place next_place(std::string_view format) {
  Place place;
  place.at = format.find('{');
  if (place.at == std::string_view::npos) return place;
  place.may_be_list = format.substr(place.at).starts_with("{*}");
  place.must_be_word = format.substr(place.at).starts_with("{w}");
  place.size = place.may_be_list || place.must_be_word ? 3 : 2;
  return place;
}

/// Finds the words of a note.
class NoteReader {
 public:
  explicit NoteReader(ReportLanguage language) : language_(language) {}

  /// One sentence after the other.
  std::optional<std::string> note(std::string_view text) const {
    auto found = one_of(evaluation_note_words(), text, true);
    return found ? found : one_of(study_note_words(), text, true);
  }

  /// A word, several of them, a number or a name.
  std::string argument(std::string_view text) const {
    if (auto word = one_of(note_argument_words(), text, false)) return *word;
    const std::size_t comma = text.find(kBetween);
    if (comma == std::string_view::npos) return local_amount(text, language_);
    return argument(text.substr(0, comma)) + (is_without_blanks() ? "\xE3\x80\x81" : ", ") +
           argument(text.substr(comma + kBetween.size()));
  }

 private:
  /// What is understood so far of a text by one word.
  struct Match {
    const NoteWord& word;
    bool is_sentence;  ///< else it stands in a place of another
    std::vector<std::string_view> arguments;
  };

  std::optional<std::string> one_of(std::span<const NoteWord> words, std::string_view text, bool is_sentence) const {
    for (const NoteWord& word : words) {
      Match match{word, is_sentence, {}};
      if (auto found = from_here(match, word.english, text)) return found;
    }
    return std::nullopt;
  }

  /// Chinese and Japanese have no blanks between sentences.
  bool is_without_blanks() const { return language_ != ReportLanguage::german; }

  /// The rest of a word's format at the beginning of the text, then the sentences behind it.
  std::optional<std::string> from_here(Match& match, std::string_view format, std::string_view text) const {
    const Place place = next_place(format);
    const std::string_view literal = format.substr(0, place.at);
    if (!text.starts_with(literal)) return std::nullopt;
    text.remove_prefix(literal.size());
    if (place.size == 0) return with_rest(match, text);
    format.remove_prefix(place.at + place.size);
    const std::string_view next = format.substr(0, next_place(format).at);
    // The shortest argument with which the rest is understood.
    for (std::size_t end = 1; end <= text.size(); ++end) {
      const std::string_view last = text.substr(end - 1);
      const bool may_be_list = match.is_sentence || place.may_be_list || place.must_be_word;
      if (!may_be_list && last.starts_with(kBetween)) break;
      // Names and numbers do not reach into the next sentence.
      if (!place.must_be_word && last.starts_with(". ")) break;
      if (next.empty() ? end != text.size() : !text.substr(end).starts_with(next)) continue;
      if (place.must_be_word && !one_of(note_argument_words(), text.substr(0, end), false)) continue;
      match.arguments.push_back(text.substr(0, end));
      if (auto found = from_here(match, format, text.substr(end))) return found;
      match.arguments.pop_back();
    }
    return std::nullopt;
  }

  std::optional<std::string> with_rest(const Match& match, std::string_view rest) const {
    if (!rest.empty() && (!match.is_sentence || !rest.starts_with(' ') || !match.word.english.ends_with('.'))) {
      return std::nullopt;
    }
    const std::optional<std::string> others = rest.empty() ? std::string() : note(rest.substr(1));
    if (!others) return std::nullopt;
    std::vector<std::string> own;
    for (const std::string_view one : match.arguments) own.push_back(argument(one));
    const std::string text = filled(match.word.texts[static_cast<std::size_t>(language_) - 1], own);
    return others->empty() || is_without_blanks() ? text + *others : text + " " + *others;
  }

  ReportLanguage language_;
};

}  // namespace

std::optional<std::string> customer_note(std::string_view english, ReportLanguage language) {
  if (language == ReportLanguage::english) return std::string(english);
  return NoteReader(language).note(english);
}

std::string customer_note_argument(std::string_view english, ReportLanguage language) {
  if (language == ReportLanguage::english) return std::string(english);
  return NoteReader(language).argument(english);
}

}  // namespace abbe
