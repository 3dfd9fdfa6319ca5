#include "abbe/report/customer/quality_results.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>

#include "abbe/report/customer/customer_documents_for_test.h"

namespace abbe {
namespace {

using testing::ElementsAre;

ReportFacts some_facts() {
  ReportFacts facts = facts_for_test();
  facts.place = "Hall 3";
  facts.temperature_range = {19.9, 20.8};
  facts.instruments = {
      {.name = "Laser", .serial_number = "L-1", .certificate = "K-1", .valid_until = std::chrono::year{2027} / 5 / 31},
      {.name = "Level", .serial_number = "", .certificate = "", .valid_until = {}}};
  return facts;
}

/// A length, an angle, a position, and a figure in a unit that QIF has no characteristic for.
CustomerReport some_report() {
  CustomerReport report;
  report.facts = some_facts();
  report.subject = "Positioning";
  report.standard = "ISO 230-1:2012, ISO 230-7:2015";
  report.states = {{"before", ""}, {"after", ""}};
  CustomerFigure accuracy{.symbol = "A↑", .name = "accuracy", .unit = "µm", .states = {}, .tolerance = 10};
  accuracy.states = {{12.340000000000002, 1.0, false}, {5.25, 0.1, false}};
  CustomerFigure turn{.symbol = "E", .name = "pitch", .unit = "µrad", .states = {}, .tolerance = {}};
  turn.states = {{-1e-7, 3e-7, true}, {std::nullopt, std::nullopt, false}};
  CustomerFigure place{.symbol = "X_0", .name = "position", .unit = "mm", .states = {}, .tolerance = 1};
  place.states = {{0.99, 0.1, false}, {0.5, std::nullopt, false}};
  CustomerFigure scale{.symbol = "s", .name = "scale", .unit = "µm/m", .states = {}, .tolerance = 3};
  scale.states = {{1.5, 0.25, false}, {std::nullopt, std::nullopt, false}};
  report.figures = {accuracy, turn, place, scale};
  report.notes = {"Two poses were left out."};
  report.files = {"after.csv"};
  return report;
}

const std::string& attribute_of(const XmlElement& element, const std::string& name) {
  for (const XmlElement& one : element.child("Attributes")->children) {
    if (*one.attribute("name") == name) return *one.attribute("value");
  }
  throw std::out_of_range(name);
}

double exact(const std::string& text) { return std::strtod(text.c_str(), nullptr); }

TEST(QifResults, HasTheElementsInTheOrderOfTheSchema) {
  const std::string text = qif_results(some_report());
  EXPECT_THAT(text, testing::HasSubstr("<QIFDocument xmlns=\"http://qifstandards.org/xsd/qif3\""));
  const XmlElement root = parsed_document(text);
  EXPECT_EQ(root.name, "QIFDocument");
  EXPECT_EQ(*root.attribute("versionQIF"), "3.0.0");
  EXPECT_THAT(child_names(root), ElementsAre("QPId", "Version", "Header", "StandardsDefinitions", "FileUnits",
                                             "MeasurementResources", "Product", "Characteristics", "Results"));
  EXPECT_THAT(
      child_names(*root.child("Characteristics")),
      ElementsAre("FormalStandardId", "CharacteristicDefinitions", "CharacteristicNominals", "CharacteristicItems"));
  EXPECT_THAT(child_names(*all_elements(root, "UserDefinedLinearCharacteristicDefinition")[0]),
              ElementsAre("Name", "Tolerance", "WhatToMeasure"));
  EXPECT_THAT(child_names(*all_elements(root, "Tolerance")[0]), ElementsAre("MaxValue", "MinValue", "DefinedAsLimit"));
  EXPECT_THAT(child_names(*all_elements(root, "UserDefinedAngularCharacteristicDefinition")[0]),
              ElementsAre("Name", "NonTolerance", "WhatToMeasure"));
  EXPECT_THAT(child_names(*all_elements(root, "UserDefinedLinearCharacteristicItem")[0]),
              ElementsAre("Description", "Name", "MeasurementDeviceIds", "CharacteristicNominalId"));
  EXPECT_THAT(child_names(*root.child("Results")),
              ElementsAre("MeasurementResultsSet", "ActualComponentSets", "InspectionTraceability"));
  EXPECT_THAT(child_names(*all_elements(root, "MeasurementResults")[0]),
              ElementsAre("Attributes", "MeasuredCharacteristics", "InspectionStatus", "ActualComponentIds"));
  EXPECT_THAT(child_names(*all_elements(root, "UserDefinedLinearCharacteristicMeasurement")[0]),
              ElementsAre("Attributes", "Status", "CharacteristicItemId", "ActualComponentId", "MeasurementDeviceIds",
                          "Value"));
  EXPECT_THAT(child_names(*all_elements(root, "InspectionTraceability")[0]),
              ElementsAre("InspectingOrganization", "CustomerOrganization", "ReportNumber", "InspectionStart",
                          "InspectionEnd", "InspectionOperator", "PlantLocation", "Attributes"));
  EXPECT_THAT(child_names(*all_elements(root, "CustomerOrganization")[0]),
              ElementsAre("Name", "Address", "CustomerNumber"));
  EXPECT_THAT(child_names(*all_elements(root, "MeasurementDevice")[0]),
              ElementsAre("Name", "SerialNumber", "Attributes"));
  EXPECT_THAT(child_names(*all_elements(root, "ActualComponent")[0]),
              ElementsAre("Attributes", "SerialNumber", "Status"));
  EXPECT_THAT(child_names(*all_elements(root, "PrimaryUnits")[0]), ElementsAre("AngularUnit", "LinearUnit"));
  EXPECT_THAT(child_names(*all_elements(root, "OtherUnits")[0]), ElementsAre("LinearUnit"));
}

TEST(QifResults, IdsAreUniqueAndEveryReferenceHasItsTarget) {
  const XmlElement root = parsed_document(qif_results(some_report()));
  std::map<std::string, std::string> names;
  for_each_element(root, [&](const XmlElement& element) {
    if (const std::string* const id = element.attribute("id")) {
      EXPECT_TRUE(names.emplace(*id, element.name).second) << *id;
    }
    if (const std::string* const n = element.attribute("n")) {
      EXPECT_EQ(*n, std::to_string(element.children.size())) << element.name;
    }
  });
  unsigned long largest = 0;
  for (const auto& [id, name] : names) largest = std::max(largest, std::strtoul(id.c_str(), nullptr, 10));
  EXPECT_EQ(*root.attribute("idMax"), std::to_string(largest));
  const auto refers = [&](const XmlElement& from, const char* child, const std::string& target) {
    EXPECT_EQ(names.at(from.child(child)->text), target) << from.name;
  };
  for (const std::string kind : {"UserDefinedLinearCharacteristic", "UserDefinedAngularCharacteristic"}) {
    for (const XmlElement* nominal : all_elements(root, kind + "Nominal")) {
      refers(*nominal, "CharacteristicDefinitionId", kind + "Definition");
    }
    for (const XmlElement* item : all_elements(root, kind + "Item")) {
      refers(*item, "CharacteristicNominalId", kind + "Nominal");
    }
    for (const XmlElement* measurement : all_elements(root, kind + "Measurement")) {
      refers(*measurement, "CharacteristicItemId", kind + "Item");
      refers(*measurement, "ActualComponentId", "ActualComponent");
      for (const XmlElement& id : measurement->child("MeasurementDeviceIds")->children) {
        EXPECT_EQ(names.at(id.text), "MeasurementDevice");
      }
    }
  }
  refers(*root.child("Characteristics"), "FormalStandardId", "Standard");
  EXPECT_EQ(names.at(all_elements(root, "ActualComponentIds")[1]->child("Id")->text), "ActualComponent");
}

TEST(QifResults, GivesBackValuesUncertaintiesAndLimitsToTheLastDigit) {
  const XmlElement root = parsed_document(qif_results(some_report()));
  const auto lengths = all_elements(root, "UserDefinedLinearCharacteristicMeasurement");
  const auto angles = all_elements(root, "UserDefinedAngularCharacteristicMeasurement");
  ASSERT_EQ(lengths.size(), 4U);  // A and X_0, before and after
  ASSERT_EQ(angles.size(), 2U);
  EXPECT_EQ(exact(lengths[0]->child("Value")->text), 12.340000000000002);
  EXPECT_EQ(exact(*lengths[0]->child("Value")->attribute("combinedUncertainty")), 0.5);
  EXPECT_EQ(exact(attribute_of(*lengths[0], "ExpandedUncertainty")), 1.0);
  EXPECT_EQ(exact(attribute_of(*lengths[0], "CoverageFactor")), 2.0);
  EXPECT_EQ(lengths[0]->child("Value")->attribute("linearUnit"), nullptr) << "the primary unit";
  EXPECT_EQ(*lengths[1]->child("Value")->attribute("linearUnit"), "mm");
  EXPECT_EQ(angles[0]->child("Value")->text, "-0.0000001") << "xs:decimal has no exponent";
  EXPECT_EQ(exact(*angles[0]->child("Value")->attribute("combinedUncertainty")), 1.5e-7);
  EXPECT_EQ(attribute_of(*angles[0], "UncertaintyIsIncomplete"), "true");
  EXPECT_EQ(angles[1]->child("Value"), nullptr);
  EXPECT_EQ(lengths[3]->child("Value")->attribute("combinedUncertainty"), nullptr);
  const XmlElement& tolerance = *all_elements(root, "Tolerance")[1];
  EXPECT_EQ(tolerance.child("MaxValue")->text, "1");
  EXPECT_EQ(tolerance.child("MinValue")->text, "-1");
  EXPECT_EQ(*tolerance.child("MinValue")->attribute("linearUnit"), "mm");
  EXPECT_EQ(tolerance.child("DefinedAsLimit")->text, "true");
  const XmlElement& before = *all_elements(root, "MeasurementResults")[0];
  EXPECT_EQ(attribute_of(before, "s / µm/m"), "1.5");
  EXPECT_EQ(attribute_of(before, "s ExpandedUncertainty / µm/m"), "0.25");
  EXPECT_EQ(attribute_of(before, "s Tolerance / µm/m"), "3");
}

TEST(QifResults, StatusesFollowTheDecisionRule) {
  CustomerReport report = some_report();
  const auto statuses = [&] {
    std::vector<std::string> words;
    const XmlElement root = parsed_document(qif_results(report));
    for (const XmlElement* status : all_elements(root, "CharacteristicStatusEnum")) words.push_back(status->text);
    for (const XmlElement* status : all_elements(root, "InspectionStatusEnum")) words.push_back(status->text);
    return words;
  };
  // A, E and X_0 before and after; both states; the machine as it is now.
  EXPECT_THAT(statuses(), ElementsAre("FAIL", "NOT_ANALYZED", "INDETERMINATE", "PASS", "NOT_ANALYZED", "UNDEFINED",
                                      "FAIL", "UNKNOWN", "UNKNOWN"));
  report.figures.resize(2);
  EXPECT_THAT(statuses(), ElementsAre("FAIL", "NOT_ANALYZED", "PASS", "NOT_ANALYZED", "FAIL", "PASS", "PASS"));
  report.states[1].no_verdict = "simulated";
  EXPECT_THAT(statuses(),
              ElementsAre("FAIL", "NOT_ANALYZED", "UNDEFINED", "NOT_ANALYZED", "FAIL", "UNKNOWN", "UNKNOWN"));
  report.figures.erase(report.figures.begin());
  EXPECT_THAT(statuses(),
              ElementsAre("NOT_ANALYZED", "NOT_ANALYZED", "NOT_CALCULATED", "NOT_CALCULATED", "NOT_CALCULATED"));
}

TEST(QifResults, StatesTheFactsAndWarnings) {
  CustomerReport report = some_report();
  report.is_simulated = true;
  report.refusals = {"The residuals are too large."};
  const XmlElement root = parsed_document(qif_results(report));
  const XmlElement& traceability = *all_elements(root, "InspectionTraceability")[0];
  EXPECT_EQ(traceability.child("CustomerOrganization")->child("Name")->text, "Example & Sons <Tooling>");
  EXPECT_EQ(traceability.child("InspectionOperator")->child("Name")->text, "A. Tester");
  EXPECT_EQ(traceability.child("ReportNumber")->text, "2026-117");
  EXPECT_EQ(traceability.child("InspectionStart")->text, "2026-11-28T00:00:00");
  EXPECT_EQ(attribute_of(traceability, "ReadingsAreSimulated"), "true");
  EXPECT_EQ(attribute_of(traceability, "MustNotBeUsed 1"), "The residuals are too large.");
  EXPECT_EQ(attribute_of(traceability, "TemperatureRange_degC"), "19.9 20.8");
  EXPECT_EQ(attribute_of(traceability, "Note 1"), "Two poses were left out.");
  EXPECT_EQ(attribute_of(traceability, "Remark 1"), "Axis X.");
  EXPECT_EQ(all_elements(root, "SerialNumber")[1]->text, "SM-0417");
  const XmlElement& laser = *all_elements(root, "MeasurementDevice")[0];
  EXPECT_EQ(attribute_of(laser, "CalibrationCertificate"), "K-1");
  EXPECT_EQ(attribute_of(laser, "CalibrationValidUntil"), "2027-05-31T00:00:00");
  const auto standards = all_elements(root, "Standard");
  ASSERT_EQ(standards.size(), 2U);
  EXPECT_EQ(standards[1]->child("Designator")->text, "230-7");
  EXPECT_EQ(standards[1]->child("Year")->text, "2015");
}

TEST(QifResults, WithoutFactsAndFiguresItIsStillADocument) {
  CustomerReport report;
  report.states = {{"now", ""}};
  const XmlElement root = parsed_document(qif_results(report));
  EXPECT_THAT(child_names(root), ElementsAre("QPId", "Header", "FileUnits", "Results"));
  EXPECT_THAT(child_names(*all_elements(root, "MeasurementResults")[0]),
              ElementsAre("Attributes", "InspectionStatus", "ActualComponentIds"));
}

TEST(QifResults, TheIdentifierFollowsFromTheContents) {
  const std::string first = qif_results(some_report());
  EXPECT_EQ(first, qif_results(some_report()));
  EXPECT_THAT(parsed_document(first).child("QPId")->text,
              testing::MatchesRegex("[0-9a-f]{8}-[0-9a-f]{4}-8[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}"));
  CustomerReport other = some_report();
  other.figures[0].states[0].value = 12.34;
  EXPECT_NE(parsed_document(first).child("QPId")->text, parsed_document(qif_results(other)).child("QPId")->text);
}

}  // namespace
}  // namespace abbe
