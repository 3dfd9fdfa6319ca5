#include "abbe/report/customer/customer_report_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/customer/calibration_certificate.h"

namespace abbe {

void check_customer_report_name(const std::string& name, const char* field) {
  const std::string extension = std::filesystem::path(name).extension().string();
  if (extension == ".pdf" || extension == ".html" || extension == ".xml") return;
  throw InputError({.file = name, .field = field}, "is not the name of a PDF, a page or a certificate",
                   "a name that ends in .pdf, .html, or .xml for a digital calibration certificate");
}

void check_qif_name(const std::string& name) {
  const std::string extension = std::filesystem::path(name).extension().string();
  if (extension == ".qif" || extension == ".QIF") return;
  throw InputError({.file = name, .field = "--qif"}, "is not a file name of QIF results", "a name that ends in .qif");
}

PrintedPage write_customer_report(const CustomerReport& report, const std::string& name) {
  if (std::filesystem::path(name).extension() == ".xml") {
    const std::vector<std::string> missing = missing_for_certificate(report.facts);
    if (!missing.empty()) {
      throw InputError({.file = name}, fmt::format("a certificate also needs {} in [report]", fmt::join(missing, ", ")),
                       "all of them, as docs/customer-report.md says");
    }
    write_file_atomically(name, calibration_certificate(report));
    return {};
  }
  if (std::filesystem::path(name).extension() == ".html") {
    write_file_atomically(name, customer_page(report));
    return {};
  }
  PrintedPage printed = printed_customer_report(report);
  if (printed.problem.empty()) {
    write_file_atomically(name, printed.pdf);
  } else {
    write_file_atomically(html_beside(name), customer_page(report));
  }
  return printed;
}

std::filesystem::path html_beside(const std::filesystem::path& pdf) {
  return std::filesystem::path(pdf).replace_extension(".html");
}

void require_printed(const std::filesystem::path& pdf, const std::filesystem::path& html, const PrintedPage& printed) {
  if (printed.problem.empty()) return;
  throw InputError({.file = pdf.string()},
                   fmt::format("not written, {}; {} is written instead", printed.problem, html.filename().string()));
}

}  // namespace abbe
