#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "abbe/formats/study/report_facts.h"

namespace abbe {

/// A note of an evaluation or of a study in the language of a customer report.
///
/// A note is one sentence or several. Each sentence is a word with arguments: a format that is known in all languages
/// (evaluation_note_words.cpp, study_note_words.cpp) and the numbers, names and further words in its places. Numbers
/// are written as readers of the language do.
/// @param english  the note as the evaluation or the study makes it
/// @returns none if a sentence of it is not known; English itself for English
std::optional<std::string> customer_note(std::string_view english, ReportLanguage language);

/// What stands in a place of a note: a word, a list of words, or a number with its unit; anything else stays as it is.
/// "0 to 1000 mm" is "0 bis 1000 mm" in German.
std::string customer_note_argument(std::string_view english, ReportLanguage language);

}  // namespace abbe
