#pragma once

#include "abbe/formats/files/printed_page.h"
#include "abbe/report/customer/customer_report.h"

namespace abbe {

/// A customer report as PDF, printed with the fonts of its language. It states the day of the measurement as its date.
/// @throws as print_page()
PrintedPage printed_customer_report(const CustomerReport& report);

}  // namespace abbe
