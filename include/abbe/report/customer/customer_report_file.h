#pragma once

#include <filesystem>
#include <string>

#include "abbe/report/customer/printed_report.h"

namespace abbe {

/// @param field  how the user calls the name, for the message: "--customer-report"
/// @throws InputError for the name of a customer report that ends in none of .pdf, .html and .xml
void check_customer_report_name(const std::string& name, const char* field);

/// @throws InputError for a name of QIF results that does not end in .qif
void check_qif_name(const std::string& name);

/// Writes a report by the ending of its name; .xml is a digital calibration certificate. Where no PDF can be printed,
/// the page is written in its place, under html_beside(). @returns what was printed; without a problem for a page
/// @throws InputError for a certificate whose facts are not enough, and as print_page() and write_file_atomically()
PrintedPage write_customer_report(const CustomerReport& report, const std::string& name);

/// "report.html" of "report.pdf".
std::filesystem::path html_beside(const std::filesystem::path& pdf);

/// Call it at the end of a command, when everything else is done and the page is written.
/// @throws InputError if printing had a problem
void require_printed(const std::filesystem::path& pdf, const std::filesystem::path& html, const PrintedPage& printed);

}  // namespace abbe
