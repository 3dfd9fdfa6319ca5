#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/toml_table.h"
#include "abbe/report/customer/calibration_certificate.h"
#include "abbe/report/customer/customer_report_file.h"
#include "abbe/report/customer/printed_report.h"
#include "abbe/report/words/evaluation_text.h"
#include "abbe/study/customer/customer_study.h"
#include "abbe/study/evaluations/customer_evaluation.h"
#include "bindings/customer/customer_parts.h"
#include "bindings/evaluate/outputs.h"
#include "bindings/files.h"
#include "bindings/job.h"
#include "bindings/study/campaign_arguments.h"
#include "bindings/study/study_objects.h"
#include "bindings/use/map_parts.h"

namespace abbe::python {
namespace {

/// Text of a table [report], as a dictionary gives it; its lines say nothing to people.
ReportFacts facts_of_text(const std::string& text) {
  if (text.empty()) return {};
  try {
    TomlTable table = TomlTable::parse(text, "facts");
    ReportFacts facts = read_report_facts(table).value_or(ReportFacts{});
    table.finish();
    for (ReportTolerance& tolerance : facts.tolerances)
      tolerance.place = {.field = "facts.tolerances." + tolerance.name};
    return facts;
  } catch (const InputError& error) {
    throw InputError({.field = "facts." + error.place().field}, error.problem(), error.expected());
  }
}

CustomerDocument document_of(const CustomerReport& report) {
  return {report, [report] { return calibration_certificate(report); }};
}

CustomerDocument of_evaluation(const Evaluation& evaluation, const ReportFacts& facts, const Evaluation* before,
                               const std::vector<std::string>& files) {
  return computed([&] {
    Evaluation now = evaluation;
    apply_report_tolerances(facts.tolerances, now.report);
    return document_of(customer_evaluation(facts, now, before, files));
  });
}

/// What was identified before a correction, from an argument. @param machine  of the study
EarlierResult earlier_result(const CampaignArgument& argument, const Study& study) {
  if (const auto* const path = file_of_campaign(argument)) {
    Study named = study;
    named.report.before = *path;
    return computed([&] { return read_earlier_result(named); });
  }
  if (const auto* const errors = std::get_if<MachineErrors>(&argument)) {
    require_same_machine(study.machine, errors->machine, "before");
    return {"before", errors->file, false};
  }
  const auto& outcome = std::get<std::shared_ptr<StudyOutcome>>(argument);
  if (!outcome) throw nb::type_error("before is None; expected a path, Errors or a StudyResult");
  const MachineErrors errors = identified_errors(*outcome);
  require_same_machine(study.machine, errors.machine, "before");
  return {outcome->study->name, errors.file, outcome->result.campaign.truth.has_value()};
}

CustomerDocument of_study(const std::shared_ptr<StudyOutcome>& outcome, const std::optional<ReportFacts>& facts,
                          const std::optional<CampaignArgument>& before) {
  const auto study = std::make_shared<Study>(*outcome->study);
  if (facts) study->report.facts = facts;
  if (!study->report.facts) {
    throw InputError({.field = "facts"}, "are missing, and [report] of the study states none",
                     "customer, machine, date and others");
  }
  // A copy only where something is added: readings and covariances may be large.
  std::shared_ptr<const StudyResult> result(outcome, &outcome->result);
  if (before) {
    const auto with_before = std::make_shared<StudyResult>(outcome->result);
    with_before->before = earlier_result(*before, *study);
    result = with_before;
  }
  return computed([&] {
    check_customer_report(*study);
    return CustomerDocument{study_customer_report(*study, *result),
                            [study, result] { return study_certificate(*study, *result); }};
  });
}

std::string certificate_of(const CustomerDocument& document) {
  const std::vector<std::string> missing = missing_for_certificate(document.report.facts);
  if (!missing.empty()) {
    throw InputError({.field = "facts"}, fmt::format("a certificate also needs {}", fmt::join(missing, ", ")),
                     "all facts of a certificate, as docs/customer-report.md lists them");
  }
  return computed(document.certificate);
}

std::string pdf_of(const CustomerDocument& document) {
  const PrintedPage printed =
      stoppable_result([&](const std::stop_token&) { return printed_customer_report(document.report); });
  if (!printed.problem.empty()) throw InputError({.field = "pdf"}, "not printed, " + printed.problem);
  return printed.pdf;
}

void write_document(const CustomerDocument& document, const std::filesystem::path& path, bool overwrite) {
  check_customer_report_name(path.string(), "path");
  const std::string ending = path.extension().string();
  refuse_existing(path, overwrite);
  const std::string contents = ending == ".pdf"    ? pdf_of(document)
                               : ending == ".html" ? customer_page(document.report)
                                                   : certificate_of(document);
  write_text(path, contents, overwrite);
}

nb::bytes bytes_of_pdf(const CustomerDocument& document) {
  const std::string pdf = pdf_of(document);
  return nb::bytes(pdf.data(), pdf.size());
}

}  // namespace

void bind_customer_reports(nb::module_& module) {
  bind_customer_parts(module);
  nb::class_<ReportFacts>(module, "_ReportFacts", "What a customer report states beside its results.")
      .def_static(
          "read", [](const std::filesystem::path& path) { return computed([&] { return read_report_facts(path); }); },
          nb::arg("path"))
      .def_static("parse", &facts_of_text, nb::arg("text"));
  nb::class_<CustomerDocument> bound(
      module, "CustomerReport",
      "Two to four sheets on the test of a machine for its customer, with verdicts by ISO 14253-1; also a digital\n"
      "calibration certificate. Made by customer_report(). Method: docs/customer-report.md.");
  add_page(bound, [](const CustomerDocument& d) { return customer_page(d.report); });
  bound
      .def("pdf", &bytes_of_pdf,
           "The report as PDF, printed by Chromium or, where there is none, by WeasyPrint; it takes some seconds. "
           "Raises\nInputError that says what to install if neither is installed, or no font for the language.")
      .def("certificate_xml", &certificate_of,
           "Digital calibration certificate (DCC 3.2.1), of a study with all identified errors and their covariance; "
           "not\n"
           "signed. Raises InputError that names the facts that are missing.")
      .def("write", &write_document, nb::arg("path"), nb::arg("overwrite") = false,
           "Writes the report by the ending of its name, whole or not at all: *.html, *.pdf, or *.xml, a digital "
           "calibration\ncertificate. Raises InputError as pdf() and certificate_xml().");
  add_customer_parts(bound);
  bound.def("__repr__", [](const CustomerDocument& d) {
    return fmt::format("<abbe.CustomerReport '{}': {} figures>", d.report.subject, d.report.figures.size());
  });
  module.def("_customer_report_of_evaluation", &of_evaluation, nb::arg("evaluation"), nb::arg("facts"),
             nb::arg("before").none(), nb::arg("files"));
  module.def("_customer_report_of_study", &of_study, nb::arg("result"), nb::arg("facts").none(),
             nb::arg("before").none());
}

}  // namespace abbe::python
