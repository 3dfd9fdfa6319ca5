#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace abbe {

/// A page as PDF, or why there is none.
struct PrintedPage {
  std::string pdf;        ///< the whole file; empty: there is none
  std::size_t pages = 0;  ///< sheets
  std::string problem;  ///< what was wrong, and what would help, as one sentence without its full stop; empty: nothing
};

struct PrintSettings {
  std::string date{};         ///< "20261128": the file states it as the day it was made; empty: it states none
  std::string language{};     ///< "zh", "ja": a font for it must be installed; others and empty: nothing is looked for
  double most_seconds = 120;  ///< after that the browser is stopped
};

/// The browser that prints: the program that ABBE_BROWSER names, else the first of chromium, chromium-browser,
/// google-chrome, google-chrome-stable and chromium-headless-shell on the PATH; empty if there is none.
/// @throws InputError if the variable names what is no program
std::filesystem::path find_browser();

/// Prints a page that needs no other file, by headless Chromium: in a temporary folder of its own, without network. The
/// same page, browser and fonts give the same bytes: the file states a date that was given, never the clock.
///
/// @param html  UTF-8, with a content security policy: its scripts, if that allows any, are run
/// @throws InputError as find_browser(), std::runtime_error if there is no place for temporary files
PrintedPage print_page(const std::string& html, const PrintSettings& settings);

/// Number of sheets of a PDF as Chromium writes it: the largest count of a tree of pages; 0 if there is none.
std::size_t pdf_page_count(const std::string& pdf);

/// Writes another day into a PDF in place of the moments when it was made and changed; its length stays.
/// @param date  "20261128", or empty: blanks in place of both entries
void set_pdf_date(const std::string& date, std::string& pdf);

}  // namespace abbe
