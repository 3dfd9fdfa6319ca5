#pragma once

// Internal to report: formats of the notes of evaluations and studies, and their translations.
#include <array>
#include <span>
#include <string_view>

#include "abbe/formats/study/report_facts.h"

namespace abbe {

struct NoteWord {
  /// With a place for each argument. In words that stand in places of others, "{}" holds no list but "{*}" may. What
  /// stands in "{w}" must be such a word.
  std::string_view english;
  /// German, Chinese, Japanese; with places "{0}", "{1}", ... for the arguments in the order of the English ones.
  std::array<std::string_view, kReportLanguageCount - 1> texts;
};

/// Terms as in customer_words.cpp: DIN ISO 230, GB/T 17421, JIS B 6190.
std::span<const NoteWord> evaluation_note_words();
std::span<const NoteWord> study_note_words();
/// Words that stand in places of those above, such as reasons and ranges.
std::span<const NoteWord> note_argument_words();

}  // namespace abbe
