#pragma once

#include <string>
#include <utility>
#include <vector>

namespace abbe {

/// Texts under headers, and columns behind them in which the operator writes.
struct MeasuringSheetTable {
  std::string caption;
  std::vector<std::string> headers;
  std::vector<std::vector<std::string>> rows;  ///< each as long as the headers
  std::vector<std::string> blank;              ///< headers of empty columns
};

/// What an operator needs beside a machine that runs a measuring program.
struct MeasuringSheet {
  std::string title, subtitle;
  std::vector<std::pair<std::string, std::string>> facts;  ///< name, text; an empty text is a line to write on
  std::vector<std::string> notes;                          ///< what he has to know before he begins
  std::vector<MeasuringSheetTable> tables;
};

/// The sheet as one page for paper of size A4, without scripts and without any address to load. Text is shown as text,
/// whatever it contains.
std::string measuring_sheet_page(const MeasuringSheet& sheet);

}  // namespace abbe
