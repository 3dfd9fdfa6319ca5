#include "abbe/report/customer/quality_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <string_view>
#include <utility>

#include "abbe/formats/text/calendar_date.h"
#include "abbe/report/customer/xml_writer.h"
#include "abbe/report/version.h"

namespace abbe {
namespace {

constexpr const char* kNoIdentifier = "00000000-0000-0000-0000-000000000000";
constexpr const char* kNoLargestId = "idMax=\"0\"";

/// A unit as it is shown and as QIF has it. The primary ones are um and urad.
struct ShownUnit {
  const char* shown;
  bool is_angle;
  const char* name;
  const char* factor;  ///< of a radian or a metre
};
constexpr ShownUnit kShownUnits[] = {{"µrad", true, "urad", "0.000001"},
                                     {"″", true, "arcsec", "0.0000048481368110953599"},
                                     {"°", true, "degree", "0.017453292519943296"},
                                     {"µm", false, "um", "0.000001"},
                                     {"mm", false, "mm", "0.001"},
                                     {"m", false, "m", "1"}};

/// Null if the unit is of neither a length nor an angle.
const ShownUnit* shown_unit(const CustomerFigure& figure) {
  const auto* const found = std::find_if(std::begin(kShownUnits), std::end(kShownUnits),
                                         [&](const ShownUnit& unit) { return figure.unit == unit.shown; });
  return found == std::end(kShownUnits) ? nullptr : found;
}

bool is_primary(const ShownUnit& unit) { return std::string_view(unit.name).starts_with('u'); }

/// Shortest text that reads back as the same number, without an exponent, which xs:decimal does not know.
std::string plain_decimal(double value) {
  std::array<char, 400> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value + 0.0, std::chars_format::fixed);
  return {text.data(), written.ptr};
}

/// The facts state a day; QIF wants a time with it.
std::string day_text(const CalendarDate& date) { return calendar_date_text(date) + "T00:00:00"; }

/// FNV-1a.
std::uint64_t hash_of(std::string_view text, std::uint64_t start) {
  for (const char c : text) start = (start ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return start;
}

/// UUID of version 8 (RFC 9562): its bits are those of two hashes of a text.
std::string identifier_of(std::string_view text) {
  const std::uint64_t high = hash_of(text, 0xcbf29ce484222325U), low = hash_of(text, ~0xcbf29ce484222325U);
  return fmt::format("{:08x}-{:04x}-8{:03x}-{:04x}-{:012x}", high >> 32U, (high >> 16U) & 0xffffU, high & 0xfffU,
                     ((low >> 48U) & 0x3fffU) | 0x8000U, low & 0xffffffffffffU);
}

const char* status_word(const CustomerReport& report, std::size_t figure, std::size_t state) {
  switch (customer_conformity(report, figure, state)) {
    case Conformity::proven:
      return "PASS";
    case Conformity::nonconformity_proven:
      return "FAIL";
    case Conformity::not_proven:
      return "INDETERMINATE";
    case Conformity::not_judged:
      break;
  }
  const CustomerFigure& judged = report.figures[figure];
  return judged.tolerance && judged.states[state].value ? "UNDEFINED" : "NOT_ANALYZED";
}

/// Of all figures in one state.
const char* inspection_status(const CustomerReport& report, std::size_t state) {
  bool passes = false, is_open = false;
  for (std::size_t i = 0; i < report.figures.size(); ++i) {
    if (!report.figures[i].tolerance) continue;
    const std::string_view status = status_word(report, i, state);
    if (status == "FAIL") return "FAIL";
    passes = passes || status == "PASS";
    is_open = is_open || status != "PASS";
  }
  return is_open ? "UNKNOWN" : passes ? "PASS" : "NOT_CALCULATED";
}

class QifWriter {
 public:
  explicit QifWriter(const CustomerReport& report) : report_(report), facts_(report.facts) {}

  std::string document() {
    xml_.open("QIFDocument", {{"xmlns", "http://qifstandards.org/xsd/qif3"},
                              {"xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance"},
                              {"xsi:schemaLocation", "http://qifstandards.org/xsd/qif3 QIFDocument.xsd"},
                              {"versionQIF", "3.0.0"},
                              {"idMax", "0"}});
    xml_.element("QPId", kNoIdentifier);
    write_head();
    write_standards();
    write_units();
    write_instruments();
    write_machine();
    write_characteristics();
    write_results();
    xml_.close();
    std::string text = xml_.document();
    const auto put = [&](std::string_view place, const std::string& value) {
      text.replace(text.find(place), place.size(), value);
    };
    put(kNoLargestId, fmt::format("idMax=\"{}\"", last_id_));
    put(kNoIdentifier, identifier_of(text));
    return text;
  }

 private:
  struct Attribute {
    const char* kind;  ///< "Str", "D1", "D2", "Bool", "Time"
    std::string name, value;
  };
  using Ids = std::vector<std::string>;

  std::string new_id() { return std::to_string(++last_id_); }
  static std::string count(std::size_t n) { return std::to_string(n); }

  void write_attributes(const std::vector<Attribute>& attributes) {
    if (attributes.empty()) return;
    xml_.open("Attributes", {{"n", count(attributes.size())}});
    for (const Attribute& one : attributes) {
      xml_.element(std::string("Attribute") + one.kind, "", {{"name", one.name}, {"value", one.value}});
    }
    xml_.close();
  }

  void write_ids(const char* name, const Ids& ids) {
    if (ids.empty()) return;
    xml_.open(name, {{"n", count(ids.size())}});
    for (const std::string& id : ids) xml_.element("Id", id);
    xml_.close();
  }

  void write_stated(const char* name, const std::string& text) {
    if (!text.empty()) xml_.element(name, text);
  }

  void write_head() {
    if (facts_.date) {
      xml_.open("Version");
      xml_.element("TimeCreated", day_text(*facts_.date));
      xml_.close();
    }
    xml_.open("Header");
    xml_.open("Application");
    xml_.element("Name", fmt::format("Abbe {}", version_text()));
    xml_.close();
    xml_.element("Description", report_.subject);
    xml_.element("Scope", "Results");
    xml_.close();
  }

  /// "ISO 230-1:2012, ISO 230-7:2015" are two, each a designator of ISO with a year.
  void write_standards() {
    std::vector<std::string> standards;
    for (std::string_view left = facts_.standard.empty() ? report_.standard : facts_.standard; !left.empty();) {
      const std::size_t end = std::min(left.find(", ISO "), left.size());
      standards.emplace_back(left.substr(0, end));
      left.remove_prefix(std::min(end + 2, left.size()));
    }
    if (standards.empty()) return;
    xml_.open("StandardsDefinitions", {{"n", count(standards.size())}});
    for (const std::string& standard : standards) {
      const std::string id = new_id();
      if (formal_standard_.empty()) formal_standard_ = id;
      const bool is_iso = standard.starts_with("ISO ");
      const std::string designator = is_iso ? standard.substr(4) : standard;
      const std::size_t colon = designator.rfind(':');
      const bool has_year = colon != std::string::npos && designator.size() == colon + 5 &&
                            designator.find_first_not_of("0123456789", colon + 1) == std::string::npos;
      xml_.open("Standard", {{"id", id}});
      xml_.open("Organization");
      xml_.element(is_iso ? "StandardsOrganizationEnum" : "OtherStandardsOrganization", is_iso ? "ISO" : "");
      xml_.close();
      xml_.element("Designator", has_year ? designator.substr(0, colon) : designator);
      if (has_year) xml_.element("Year", designator.substr(colon + 1));
      xml_.close();
    }
    xml_.close();
  }

  void write_unit(const ShownUnit& unit) {
    xml_.open(unit.is_angle ? "AngularUnit" : "LinearUnit");
    xml_.element("SIUnitName", unit.is_angle ? "radian" : "meter");
    xml_.element("UnitName", unit.name);
    xml_.open("UnitConversion");
    xml_.element("Factor", unit.factor);
    xml_.close();
    xml_.close();
  }

  void write_units() {
    std::vector<const ShownUnit*> others;
    xml_.open("FileUnits");
    xml_.open("PrimaryUnits");
    for (const ShownUnit& unit : kShownUnits) {
      if (is_primary(unit)) write_unit(unit);
      const bool is_used = std::any_of(report_.figures.begin(), report_.figures.end(),
                                       [&](const CustomerFigure& figure) { return shown_unit(figure) == &unit; });
      if (is_used && !is_primary(unit)) others.push_back(&unit);
    }
    xml_.close();
    if (!others.empty()) {
      xml_.open("OtherUnits", {{"n", count(others.size())}});
      for (const ShownUnit* unit : others) write_unit(*unit);
      xml_.close();
    }
    xml_.close();
  }

  void write_instruments() {
    if (facts_.instruments.empty()) return;
    xml_.open("MeasurementResources");
    xml_.open("MeasurementDevices", {{"n", count(facts_.instruments.size())}});
    for (const ReportInstrument& instrument : facts_.instruments) {
      devices_.push_back(new_id());
      xml_.open("MeasurementDevice", {{"id", devices_.back()}});
      xml_.element("Name", instrument.name);
      write_stated("SerialNumber", instrument.serial_number);
      std::vector<Attribute> attributes;
      if (!instrument.certificate.empty())
        attributes.push_back({"Str", "CalibrationCertificate", instrument.certificate});
      if (instrument.valid_until) {
        attributes.push_back({"Time", "CalibrationValidUntil", day_text(*instrument.valid_until)});
      }
      write_attributes(attributes);
      xml_.close();
    }
    xml_.close();
    xml_.close();
  }

  void write_machine() {
    if (facts_.model.empty()) return;
    xml_.open("Product");
    xml_.open("PartSet", {{"n", "1"}});
    xml_.open("Part", {{"id", new_id()}});
    xml_.element("ModelNumber", facts_.model);
    xml_.close();
    xml_.close();
    xml_.close();
  }

  std::vector<std::size_t> characteristics() const {
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < report_.figures.size(); ++i) {
      if (shown_unit(report_.figures[i]) != nullptr) chosen.push_back(i);
    }
    return chosen;
  }

  static std::string aspect(const ShownUnit& unit, const char* what) {
    return fmt::format("UserDefined{}Characteristic{}", unit.is_angle ? "Angular" : "Linear", what);
  }

  static XmlWriter::Attributes unit_attribute(const ShownUnit& unit) {
    if (is_primary(unit)) return {};
    return {{unit.is_angle ? "angularUnit" : "linearUnit", unit.name}};
  }

  void write_characteristics() {
    const std::vector<std::size_t> chosen = characteristics();
    if (chosen.empty()) return;
    const XmlWriter::Attributes n = {{"n", count(chosen.size())}};
    xml_.open("Characteristics");
    write_stated("FormalStandardId", formal_standard_);
    xml_.open("CharacteristicDefinitions", n);
    Ids definitions, nominals;
    for (const std::size_t i : chosen) {
      definitions.push_back(new_id());
      write_definition(report_.figures[i], definitions.back());
    }
    xml_.close();
    xml_.open("CharacteristicNominals", n);
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      nominals.push_back(new_id());
      xml_.open(aspect(*shown_unit(report_.figures[chosen[k]]), "Nominal"), {{"id", nominals.back()}});
      xml_.element("CharacteristicDefinitionId", definitions[k]);
      xml_.close();
    }
    xml_.close();
    xml_.open("CharacteristicItems", n);
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const CustomerFigure& figure = report_.figures[chosen[k]];
      items_.push_back(new_id());
      xml_.open(aspect(*shown_unit(figure), "Item"), {{"id", items_.back()}});
      xml_.element("Description", figure.name);
      xml_.element("Name", figure.symbol);
      write_ids("MeasurementDeviceIds", devices_);
      xml_.element("CharacteristicNominalId", nominals[k]);
      xml_.close();
    }
    xml_.close();
    xml_.close();
  }

  /// A tolerance is a largest magnitude: limits on both sides of zero.
  void write_definition(const CustomerFigure& figure, const std::string& id) {
    const ShownUnit& unit = *shown_unit(figure);
    xml_.open(aspect(unit, "Definition"), {{"id", id}});
    xml_.element("Name", figure.symbol);
    if (figure.tolerance) {
      xml_.open("Tolerance");
      xml_.element("MaxValue", plain_decimal(*figure.tolerance), unit_attribute(unit));
      xml_.element("MinValue", plain_decimal(-*figure.tolerance), unit_attribute(unit));
      xml_.element("DefinedAsLimit", "true");
      xml_.close();
    } else {
      xml_.element("NonTolerance", "MEASURED");
    }
    xml_.element("WhatToMeasure", figure.name);
    xml_.close();
  }

  void write_results() {
    const std::string component = new_id();
    xml_.open("Results");
    xml_.open("MeasurementResultsSet", {{"n", count(report_.states.size())}});
    for (std::size_t state = 0; state < report_.states.size(); ++state) write_state(state, component);
    xml_.close();
    xml_.open("ActualComponentSets", {{"n", "1"}});
    xml_.open("ActualComponentSet", {{"n", "1"}});
    xml_.open("ActualComponent", {{"id", component}});
    if (!facts_.maker.empty()) write_attributes({{"Str", "Manufacturer", facts_.maker}});
    write_stated("SerialNumber", facts_.serial_number);
    xml_.open("Status");
    // The last state is how the machine is now.
    xml_.element("InspectionStatusEnum", inspection_status(report_, report_.states.size() - 1));
    xml_.close();
    xml_.close();
    xml_.close();
    xml_.close();
    write_traceability();
    xml_.close();
  }

  void write_state(std::size_t state, const std::string& component) {
    xml_.open("MeasurementResults", {{"id", new_id()}});
    std::vector<Attribute> attributes = {{"Str", "State", report_.states[state].name},
                                         {"Str", "DecisionRule", "ISO 14253-1:2017, conformance probability 95 %"}};
    if (!report_.states[state].no_verdict.empty()) {
      attributes.push_back({"Str", "NoVerdict", report_.states[state].no_verdict});
    }
    for (const CustomerFigure& figure : report_.figures) add_other_figure(figure, state, attributes);
    write_attributes(attributes);
    const std::vector<std::size_t> chosen = characteristics();
    if (!chosen.empty()) {
      xml_.open("MeasuredCharacteristics");
      xml_.open("CharacteristicMeasurements", {{"n", count(chosen.size())}});
      for (std::size_t k = 0; k < chosen.size(); ++k) write_measurement(chosen[k], state, items_[k], component);
      xml_.close();
      xml_.close();
    }
    xml_.open("InspectionStatus");
    xml_.element("InspectionStatusEnum", inspection_status(report_, state));
    xml_.close();
    write_ids("ActualComponentIds", {component});
    xml_.close();
  }

  /// A figure whose unit QIF has no characteristic for.
  static void add_other_figure(const CustomerFigure& figure, std::size_t state, std::vector<Attribute>& attributes) {
    const CustomerValue& value = figure.states[state];
    if (shown_unit(figure) != nullptr || !value.value) return;
    const auto add = [&](const char* what, double number) {
      attributes.push_back({"D1", fmt::format("{}{} / {}", figure.symbol, what, figure.unit), plain_decimal(number)});
    };
    add("", *value.value);
    if (value.expanded_uncertainty) add(" ExpandedUncertainty", *value.expanded_uncertainty);
    if (figure.tolerance) add(" Tolerance", *figure.tolerance);
  }

  void write_measurement(std::size_t index, std::size_t state, const std::string& item, const std::string& component) {
    const CustomerFigure& figure = report_.figures[index];
    const CustomerValue& value = figure.states[state];
    const ShownUnit& unit = *shown_unit(figure);
    const bool has_uncertainty = value.value && value.expanded_uncertainty;
    xml_.open(aspect(unit, "Measurement"), {{"id", new_id()}});
    std::vector<Attribute> attributes;
    if (has_uncertainty) {
      attributes = {{"D1", "ExpandedUncertainty", plain_decimal(*value.expanded_uncertainty)},
                    {"D1", "CoverageFactor", "2"}};
      if (value.is_incomplete) attributes.push_back({"Bool", "UncertaintyIsIncomplete", "true"});
    }
    write_attributes(attributes);
    xml_.open("Status");
    xml_.element("CharacteristicStatusEnum", status_word(report_, index, state));
    xml_.close();
    xml_.element("CharacteristicItemId", item);
    xml_.element("ActualComponentId", component);
    write_ids("MeasurementDeviceIds", devices_);
    if (value.value) {
      XmlWriter::Attributes of_value = unit_attribute(unit);
      if (has_uncertainty) {
        of_value.emplace_back("combinedUncertainty", plain_decimal(*value.expanded_uncertainty / 2));
        // The values are corrected for what is known.
        of_value.emplace_back("meanError", "0");
      }
      xml_.element("Value", plain_decimal(*value.value), of_value);
    }
    xml_.close();
  }

  void write_organization(const char* name, const std::string& who, const std::string& address,
                          const std::string& country, bool is_customer) {
    if (who.empty() && address.empty()) return;
    xml_.open(name);
    xml_.element("Name", who);
    if (!address.empty() || !country.empty()) {
      xml_.open("Address");
      write_stated("Street", address);
      write_stated("Country", country);
      xml_.close();
    }
    // Required, and not among the facts.
    if (is_customer) xml_.element("CustomerNumber", "");
    xml_.close();
  }

  void write_traceability() {
    xml_.open("InspectionTraceability");
    write_organization("InspectingOrganization", facts_.laboratory, facts_.laboratory_address,
                       facts_.laboratory_country, false);
    write_organization("CustomerOrganization", facts_.customer, facts_.customer_address, "", true);
    write_stated("ReportNumber", facts_.number);
    if (facts_.date) {
      xml_.element("InspectionStart", day_text(*facts_.date));
      xml_.element("InspectionEnd", day_text(*facts_.date));
    }
    if (!facts_.operator_name.empty()) {
      xml_.open("InspectionOperator");
      xml_.element("Name", facts_.operator_name);
      xml_.close();
    }
    if (!facts_.place.empty()) {
      xml_.open("PlantLocation", {{"id", new_id()}});
      xml_.element("LocationDescription", facts_.place);
      xml_.close();
    }
    std::vector<Attribute> attributes;
    if (report_.is_simulated) attributes.push_back({"Bool", "ReadingsAreSimulated", "true"});
    add_sentences("MustNotBeUsed", report_.refusals, attributes);
    if (facts_.temperature) {
      attributes.push_back({"D1", "MeanTemperature_degC", plain_decimal(*facts_.temperature)});
    }
    if (const auto& range = facts_.temperature_range) {
      attributes.push_back(
          {"D2", "TemperatureRange_degC", plain_decimal((*range)[0]) + " " + plain_decimal((*range)[1])});
    }
    add_sentences("Condition", report_.conditions, attributes);
    add_sentences("Note", report_.notes, attributes);
    add_sentences("Remark", facts_.remarks, attributes);
    add_sentences("File", report_.files, attributes);
    write_attributes(attributes);
    xml_.close();
  }

  /// The names of attributes of one element differ.
  static void add_sentences(const char* name, const std::vector<std::string>& sentences,
                            std::vector<Attribute>& attributes) {
    for (std::size_t i = 0; i < sentences.size(); ++i) {
      attributes.push_back({"Str", fmt::format("{} {}", name, i + 1), sentences[i]});
    }
  }

  const CustomerReport& report_;
  const ReportFacts& facts_;
  XmlWriter xml_;
  std::uint32_t last_id_ = 0;
  std::string formal_standard_;  ///< id
  Ids devices_, items_;
};

}  // namespace

std::string qif_results(const CustomerReport& report) { return QifWriter(report).document(); }

}  // namespace abbe
