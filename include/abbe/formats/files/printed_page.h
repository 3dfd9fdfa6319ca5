#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace abbe {

/// A page as PDF, or the reason why there is none.
struct PrintedPage {
  std::string pdf;        ///< the whole file; empty: there is none
  std::size_t pages = 0;  ///< sheets
  std::string problem;  ///< what was wrong, and what would help, as one sentence without its full stop; empty: nothing
};

struct PrintSettings {
  std::string date{};         ///< "20261128": the file states it as the day it was made; empty: it states none
  std::string language{};     ///< "zh", "ja": a font for it must be installed; others and empty: nothing is looked for
  double most_seconds = 300;  ///< after that the program is stopped
};

/// A program that prints pages.
struct PagePrinter {
  enum class Kind { browser, weasyprint };

  std::filesystem::path program;  ///< empty: none is installed
  Kind kind = Kind::browser;      ///< which options it takes
};

/// The program that prints: the one that ABBE_BROWSER names (WeasyPrint if its name begins with "weasyprint", else a
/// browser), else the first of chromium, chromium-browser, google-chrome, google-chrome-stable, chromium-headless-shell
/// and weasyprint on the PATH.
/// @throws InputError if the variable does not name a program
PagePrinter find_page_printer();

/// Prints a page that needs no other file, by headless Chromium or WeasyPrint: in a temporary folder of its own,
/// without network. The same page, program and fonts give the same bytes: the file states a date that was given, never
/// the clock.
///
/// @param html  UTF-8, with a content security policy: Chromium runs its scripts, if that allows any. WeasyPrint takes
///              the date from <meta name="dcterms.created">
/// @throws InputError as find_page_printer(), std::runtime_error if there is no place for temporary files
PrintedPage print_page(const std::string& html, const PrintSettings& settings);

/// Number of sheets of a PDF as these programs write it: the largest count of a tree of pages; 0 if there is none.
std::size_t pdf_page_count(const std::string& pdf);

/// Replaces the creation and modification times of a PDF by a date; the length of the file does not change. The "D:"
/// that the format requires is added where it is missing, as with WeasyPrint 57.
/// @param date  "20261128", or empty: blanks in place of both entries
void set_pdf_date(const std::string& date, std::string& pdf);

/// Renumbers the nodes of a page, "(node00000053)", from 1 in their order, in place. Chromium's counter also counts its
/// other work, so on a busy machine the same page gets other numbers.
void number_pdf_nodes(std::string& pdf);

}  // namespace abbe
