#include "abbe/report/customer/printed_report.h"

#include "abbe/formats/text/calendar_date.h"

namespace abbe {

PrintedPage printed_customer_report(const CustomerReport& report) {
  PrintSettings settings;
  settings.language = language_code(report.facts.language);
  if (const auto& date = report.facts.date) {
    settings.date = calendar_date_text(*date);
    std::erase(settings.date, '-');
  }
  return print_page(customer_page(report), settings);
}

}  // namespace abbe
