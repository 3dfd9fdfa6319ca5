#include "abbe/report/customer/calibration_certificate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/formats/text/calendar_date.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/identify/distributions.h"
#include "abbe/report/customer/xml_writer.h"
#include "abbe/report/version.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
constexpr double kCoverage = 0.95;
constexpr double kTwoSigmaCoverage = 0.9545;
// Of the largest variance of the correlations: what is below is a direction that a convention sets.
constexpr double kNoVariance = 1e-9;

/// A unit as D-SI writes it.
std::string si_unit(const std::string& shown) {
  static constexpr std::pair<const char*, const char*> kUnits[] = {{"µm", "\\micro\\metre"},
                                                                   {"mm", "\\milli\\metre"},
                                                                   {"µrad", "\\micro\\radian"},
                                                                   {"″", "\\arcsecond"},
                                                                   {"°", "\\degree"},
                                                                   {"m", "\\metre"},
                                                                   {"µm/m", "\\micro\\metre\\per\\metre"},
                                                                   {"ms", "\\milli\\second"},
                                                                   {"min", "\\minute"},
                                                                   {"K", "\\kelvin"},
                                                                   {"K/h", "\\kelvin\\per\\hour"}};
  for (const auto& [name, unit] : kUnits) {
    if (shown == name) return unit;
  }
  return "\\one";
}

/// Without a minus before zero.
std::string decimal_text(double value) { return shortest_text(value + 0.0); }

/// The schema allows no blanks around a text.
std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

const char* conformity_word(Conformity conformity) {
  return conformity == Conformity::proven ? "pass" : conformity == Conformity::nonconformity_proven ? "fail" : "noPass";
}

class CertificateWriter {
 public:
  CertificateWriter(const CustomerReport& report, const std::optional<CertifiedErrors>& errors)
      : report_(report), facts_(report.facts), errors_(errors), language_(language_code(facts_.language)) {}

  std::string document() {
    xml_.open("dcc:digitalCalibrationCertificate",
              {{"xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance"},
               {"xmlns:dcc", "https://ptb.de/dcc"},
               {"xmlns:si", "https://ptb.de/si"},
               {"xsi:schemaLocation", "https://ptb.de/dcc https://ptb.de/dcc/v3.2.1/dcc.xsd"},
               {"schemaVersion", "3.2.1"}});
    write_administrative_data();
    xml_.open("dcc:measurementResults");
    for (std::size_t state = 0; state < report_.states.size(); ++state) write_state(state);
    xml_.close();
    xml_.close();
    return xml_.document();
  }

 private:
  /// <name><dcc:content lang>text</dcc:content></name>
  void text(const std::string& name, const std::string& content) {
    xml_.open(name);
    xml_.element("dcc:content", content, {{"lang", language_}});
    xml_.close();
  }
  void english(const std::string& name, const std::vector<std::string>& sentences) {
    xml_.open(name);
    for (const std::string& sentence : sentences) xml_.element("dcc:content", sentence, {{"lang", "en"}});
    xml_.close();
  }

  void write_contact(const std::string& name, const std::string& who, const std::string& address,
                     const std::string& country) {
    xml_.open(name);
    text("dcc:name", who);
    xml_.open("dcc:location");
    if (!country.empty()) xml_.element("dcc:countryCode", country);
    text("dcc:further", address);
    xml_.close();
    xml_.close();
  }

  void write_identification(const char* issuer, const std::string& value, const char* name) {
    xml_.open("dcc:identification");
    xml_.element("dcc:issuer", issuer);
    xml_.element("dcc:value", trimmed(value));
    english("dcc:name", {name});
    xml_.close();
  }

  void write_administrative_data() {
    xml_.open("dcc:administrativeData");
    xml_.open("dcc:dccSoftware");
    write_software();
    xml_.close();

    xml_.open("dcc:coreData");
    xml_.element("dcc:countryCodeISO3166_1", facts_.laboratory_country);
    xml_.element("dcc:usedLangCodeISO639_1", language_);
    if (language_ != "en") xml_.element("dcc:usedLangCodeISO639_1", "en");
    xml_.element("dcc:mandatoryLangCodeISO639_1", language_);
    xml_.element("dcc:uniqueIdentifier", trimmed(facts_.number));
    xml_.element("dcc:beginPerformanceDate", calendar_date_text(*facts_.date));
    xml_.element("dcc:endPerformanceDate", calendar_date_text(*facts_.date));
    // Machines are calibrated where they stand.
    xml_.element("dcc:performanceLocation", "customer");
    xml_.close();

    xml_.open("dcc:items");
    xml_.open("dcc:item");
    text("dcc:name", facts_.model);
    if (!facts_.maker.empty()) {
      xml_.open("dcc:manufacturer");
      text("dcc:name", facts_.maker);
      xml_.close();
    }
    xml_.element("dcc:model", trimmed(facts_.model));
    xml_.open("dcc:identifications");
    write_identification("manufacturer", facts_.serial_number, "Serial number");
    xml_.close();
    xml_.close();
    xml_.close();

    xml_.open("dcc:calibrationLaboratory");
    write_contact("dcc:contact", facts_.laboratory, facts_.laboratory_address, facts_.laboratory_country);
    xml_.close();
    xml_.open("dcc:respPersons");
    xml_.open("dcc:respPerson");
    xml_.open("dcc:person");
    text("dcc:name", facts_.operator_name);
    xml_.close();
    xml_.close();
    xml_.close();
    write_contact("dcc:customer", facts_.customer, facts_.customer_address, "");
    write_statements();
    xml_.close();
  }

  void write_software() {
    xml_.open("dcc:software");
    english("dcc:name", {"Abbe"});
    xml_.element("dcc:release", version_text());
    xml_.element("dcc:type", "application");
    xml_.close();
  }

  /// What the first sheet of the customer report warns of, and its notes: a program must not miss them.
  void write_statements() {
    std::vector<std::string> warnings = report_.refusals;
    if (report_.is_simulated) warnings.insert(warnings.begin(), "The readings are simulated.");
    if (warnings.empty() && report_.notes.empty() && facts_.remarks.empty()) return;
    xml_.open("dcc:statements");
    const auto statement = [this](const char* name, const std::vector<std::string>& sentences, bool is_english) {
      if (sentences.empty()) return;
      xml_.open("dcc:statement");
      english("dcc:name", {name});
      xml_.open("dcc:declaration");
      for (const std::string& sentence : sentences) {
        xml_.element("dcc:content", sentence, {{"lang", is_english ? "en" : language_}});
      }
      xml_.close();
      xml_.close();
    };
    statement("The result must not be used as it is", warnings, true);
    statement("Conditions and notes of the evaluation", report_.notes, true);
    statement("Remarks", facts_.remarks, false);
    xml_.close();
  }

  void write_method() {
    xml_.open("dcc:usedMethods");
    xml_.open("dcc:usedMethod", {{"refType", "basic_uncertainty"}});
    english("dcc:name", {"Expanded uncertainty"});
    english("dcc:description", {"Standard uncertainty multiplied by the coverage factor that stands beside it."});
    xml_.element("dcc:norm", "JCGM 100:2008");
    xml_.close();
    const std::string stated = trimmed(facts_.standard);
    const std::string standard = stated.empty() ? trimmed(report_.standard) : stated;
    if (!standard.empty()) {
      xml_.open("dcc:usedMethod");
      text("dcc:name", report_.subject);
      xml_.element("dcc:norm", standard);
      xml_.close();
    }
    xml_.close();
  }

  void write_instruments() {
    if (facts_.instruments.empty()) return;
    xml_.open("dcc:measuringEquipments");
    for (const ReportInstrument& instrument : facts_.instruments) {
      xml_.open("dcc:measuringEquipment", {{"refType", "basic_normalUsed"}});
      text("dcc:name", instrument.name);
      const std::string serial_number = trimmed(instrument.serial_number);
      const std::string certificate = trimmed(instrument.certificate);
      if (!serial_number.empty() || !certificate.empty()) {
        xml_.open("dcc:identifications");
        if (!serial_number.empty()) write_identification("manufacturer", serial_number, "Serial number");
        if (!certificate.empty()) {
          write_identification("calibrationLaboratory", certificate, "Calibration certificate");
        }
        xml_.close();
      }
      xml_.close();
    }
    xml_.close();
  }

  void write_temperature() {
    if (!facts_.temperature) return;
    xml_.open("dcc:influenceConditions");
    xml_.open("dcc:influenceCondition", {{"refType", "basic_temperature"}});
    english("dcc:name", {"Mean temperature"});
    xml_.open("dcc:data");
    xml_.open("dcc:quantity");
    write_real(*facts_.temperature, "\\degreecelsius", std::nullopt);
    xml_.close();
    xml_.close();
    xml_.close();
    xml_.close();
  }

  void write_real(double value, const std::string& unit, const std::optional<double>& expanded) {
    xml_.open("si:real");
    xml_.element("si:value", decimal_text(value));
    xml_.element("si:unit", unit);
    if (expanded) {
      xml_.open("si:expandedUnc");
      xml_.element("si:uncertainty", decimal_text(*expanded));
      xml_.element("si:coverageFactor", "2");
      xml_.element("si:coverageProbability", decimal_text(kTwoSigmaCoverage));
      xml_.element("si:distribution", "normal");
      xml_.close();
    }
    xml_.close();
  }

  void write_state(std::size_t state) {
    xml_.open("dcc:measurementResult");
    text("dcc:name", report_.states[state].name);
    write_method();
    xml_.open("dcc:usedSoftware");
    write_software();
    xml_.close();
    write_instruments();
    write_temperature();
    xml_.open("dcc:results");
    xml_.open("dcc:result");
    text("dcc:name", report_.subject);
    xml_.open("dcc:data");
    bool is_empty = true;
    for (std::size_t figure = 0; figure < report_.figures.size(); ++figure) {
      if (!report_.figures[figure].states[state].value) continue;
      write_figure(figure, state);
      is_empty = false;
    }
    if (is_empty) english("dcc:text", {"No figure could be evaluated."});
    xml_.close();
    xml_.close();
    // The errors are those of the machine as it is now: of the last state.
    if (errors_ && state + 1 == report_.states.size()) write_errors();
    xml_.close();
    xml_.close();
  }

  void write_figure(std::size_t index, std::size_t state) {
    const CustomerFigure& figure = report_.figures[index];
    const CustomerValue& value = figure.states[state];
    xml_.open("dcc:quantity");
    text("dcc:name", figure.symbol + ": " + figure.name);
    if (value.is_incomplete) {
      english("dcc:description", {"The uncertainty does not cover all that this figure is made of."});
    }
    write_real(*value.value, si_unit(figure.unit), value.expanded_uncertainty);
    const Conformity conformity = customer_conformity(report_, index, state);
    if (conformity != Conformity::not_judged) {
      xml_.open("dcc:measurementMetaData");
      xml_.open("dcc:metaData", {{"refType", "basic_conformity"}});
      xml_.element("dcc:norm", "ISO 14253-1:2017");
      if (conformity == Conformity::not_proven) {
        english("dcc:declaration", {"Neither conformity nor nonconformity is proven."});
      }
      xml_.element("dcc:conformity", conformity_word(conformity));
      xml_.open("dcc:data");
      xml_.open("dcc:quantity");
      english("dcc:name", {"Largest permitted magnitude"});
      write_real(*figure.tolerance, si_unit(figure.unit), std::nullopt);
      xml_.close();
      xml_.close();
      xml_.close();
      xml_.close();
    }
    xml_.close();
  }

  void write_errors() {
    const std::size_t n = errors_->names.size();
    std::string values, units;
    for (std::size_t i = 0; i < n; ++i) {
      const char* const blank = i == 0 ? "" : " ";
      values += blank + decimal_text(errors_->values[i]);
      units += blank + unit_of(i);
    }
    xml_.open("dcc:result");
    english("dcc:name", {"Identified errors of the machine with their covariance"});
    xml_.open("dcc:data");
    xml_.open("dcc:quantity");
    xml_.open("si:realListXMLList");
    xml_.element("si:labelXMLList", fmt::format("{}", fmt::join(errors_->names, " ")));
    xml_.element("si:valueXMLList", values);
    xml_.element("si:unitXMLList", units);
    xml_.open("si:ellipsoidalRegionXMLList");
    xml_.open("si:covarianceMatrix");
    for (std::size_t j = 0; j < n; ++j) {
      xml_.open("si:column");
      for (std::size_t i = 0; i < n; ++i) {
        xml_.open("si:covariance");
        xml_.element("si:value", decimal_text(errors_->covariance(static_cast<Index>(i), static_cast<Index>(j))));
        xml_.element("si:unit", unit_of(i) + unit_of(j));
        xml_.close();
      }
      xml_.close();
    }
    xml_.close();
    const double factor = std::sqrt(chi_square_quantile(1 - kCoverage, static_cast<double>(rank())));
    xml_.element("si:coverageFactor", fmt::format("{:.6f}", factor));
    xml_.element("si:coverageProbability", decimal_text(kCoverage));
    xml_.element("si:distribution", "normal");
    xml_.close();
    xml_.close();
    xml_.close();
    xml_.close();
    xml_.close();
  }

  std::string unit_of(std::size_t parameter) const {
    return errors_->is_angle[parameter] ? "\\micro\\radian" : "\\micro\\metre";
  }

  /// Of the covariance, one at least.
  std::size_t rank() const {
    Eigen::MatrixXd correlation = errors_->covariance;
    for (Index i = 0; i < correlation.rows(); ++i) {
      const double variance = errors_->covariance(i, i);
      const double scale = variance > 0 ? 1 / std::sqrt(variance) : 0;
      correlation.row(i) *= scale;
      correlation.col(i) *= scale;
    }
    const SymmetricEigen<> modes(correlation, Eigen::EigenvaluesOnly);
    const double largest = modes.eigenvalues().maxCoeff();
    const auto count = (modes.eigenvalues().array() > kNoVariance * largest).count();
    return static_cast<std::size_t>(std::max<Index>(1, count));
  }

  const CustomerReport& report_;
  const ReportFacts& facts_;
  const std::optional<CertifiedErrors>& errors_;
  std::string language_;
  XmlWriter xml_;
};

}  // namespace

std::vector<std::string> missing_for_certificate(const ReportFacts& facts) {
  std::vector<std::string> missing;
  const auto need = [&](const std::string& text, const char* key) {
    if (text.find_first_not_of(" \t\n") == std::string::npos) missing.emplace_back(key);
  };
  need(facts.number, "number");
  need(facts.customer, "customer.name");
  need(facts.customer_address, "customer.address");
  need(facts.model, "machine.model");
  need(facts.serial_number, "machine.serial_number");
  need(facts.operator_name, "operator");
  if (!facts.date) missing.emplace_back("date");
  need(facts.laboratory, "laboratory.name");
  need(facts.laboratory_address, "laboratory.address");
  need(facts.laboratory_country, "laboratory.country");
  return missing;
}

std::string calibration_certificate(const CustomerReport& report, const std::optional<CertifiedErrors>& errors) {
  const std::vector<std::string> missing = missing_for_certificate(report.facts);
  if (!missing.empty()) throw std::invalid_argument(fmt::format("not stated: {}", fmt::join(missing, ", ")));
  return CertificateWriter(report, errors).document();
}

}  // namespace abbe
