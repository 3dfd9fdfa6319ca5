#include "abbe/report/customer/customer_report_file.h"

#include <gmock/gmock.h>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/report/customer/calibration_certificate.h"
#include "abbe/report/customer/customer_documents_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

CustomerReport report_for_files() {
  CustomerReport report;
  report.facts = facts_for_test();
  report.subject = "Positioning";
  report.states = {{"", ""}};
  CustomerFigure accuracy{.symbol = "A", .name = "accuracy", .unit = "um", .states = {}, .tolerance = 10};
  accuracy.states = {{5.25, 0.5, false}};
  report.figures = {accuracy};
  return report;
}

TEST(AFileOfACustomerReport, IsCheckedByTheEndingOfItsName) {
  for (const char* const name : {"a.pdf", "b.html", "folder.x/c.xml"}) {
    EXPECT_NO_THROW(check_customer_report_name(name, "--customer-report"));
  }
  const auto message = [](const std::string& name) {
    return message_of([&] { check_customer_report_name(name, "--customer-report"); });
  };
  EXPECT_THAT(message("a.txt"), HasSubstr("a.txt: --customer-report: is not the name of a PDF"));
  EXPECT_THAT(message("pdf"), HasSubstr("a name that ends in .pdf, .html, or .xml"));
  EXPECT_NO_THROW(check_qif_name("a.qif"));
  EXPECT_NO_THROW(check_qif_name("A.QIF"));
  EXPECT_THAT(message_of([] { check_qif_name("a.xml"); }),
              HasSubstr("a.xml: --qif: is not a file name of QIF results"));
}

TEST(AFileOfACustomerReport, IsAPageOrACertificateByItsName) {
  const std::filesystem::path folder = test::empty_folder("abbe_customer_report_file");
  CustomerReport report = report_for_files();
  EXPECT_EQ(write_customer_report(report, folder / "r.html").problem, "");
  EXPECT_EQ(read_text_file(folder / "r.html"), customer_page(report));
  EXPECT_EQ(write_customer_report(report, folder / "r.xml").problem, "");
  EXPECT_EQ(read_text_file(folder / "r.xml"), calibration_certificate(report));
  report.facts.number.clear();
  EXPECT_THAT(message_of([&] { write_customer_report(report, folder / "s.xml"); }),
              HasSubstr("s.xml: a certificate also needs number in [report]"));
  EXPECT_FALSE(std::filesystem::exists(folder / "s.xml"));
  std::filesystem::remove_all(folder);
}

TEST(AFileOfACustomerReport, ThatCouldNotBePrintedIsAnErrorThatNamesThePage) {
  EXPECT_EQ(html_beside("results/r.pdf"), "results/r.html");
  EXPECT_NO_THROW(require_printed("r.pdf", "r.html", {}));
  PrintedPage printed;
  printed.problem = "no browser is installed";
  EXPECT_THAT(message_of([&] { require_printed("results/r.pdf", "results/r.html", printed); }),
              StartsWith("results/r.pdf: not written, no browser is installed; r.html is written instead"));
}

}  // namespace
}  // namespace abbe
