#pragma once

#include <functional>
#include <string>

#include "abbe/report/customer/customer_report.h"
#include "bindings/bindings.h"

namespace abbe::python {

/// A customer report, and how it becomes a certificate.
struct CustomerDocument {
  CustomerReport report;
  std::function<std::string()> certificate;  ///< nothing of it is missing when this is called
};

/// Classes of its figures and states.
void bind_customer_parts(nb::module_& module);

/// Adds properties with the figures and states of a report.
void add_customer_parts(nb::class_<CustomerDocument>& bound);

}  // namespace abbe::python
