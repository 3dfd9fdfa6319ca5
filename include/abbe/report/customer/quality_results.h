#pragma once

#include <string>

#include "abbe/report/customer/customer_report.h"

namespace abbe {

/// A customer report as a QIF document, version 3.0 (ANSI/DMSC QIF 3.0, ISO 23952:2020), with its section Results: for
/// every state the measured characteristics with values, combined standard uncertainties, statuses and limits, the
/// machine, the instruments and who measured for whom.
///
/// Figures in a length or an angle are characteristics; those in other units are attributes of the results. Drawings
/// and tables are not in it. Its identifier follows from its contents: the same report has the same bytes.
/// Source: QIFDocument.xsd and the files it includes, namespace http://qifstandards.org/xsd/qif3, version 3.0.0.
/// @param report  of measured states; what is predicted has to be left out
std::string qif_results(const CustomerReport& report);

}  // namespace abbe
