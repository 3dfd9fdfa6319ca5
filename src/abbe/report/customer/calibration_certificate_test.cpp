#include "abbe/report/customer/calibration_certificate.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

#include "abbe/report/customer/customer_documents_for_test.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

ReportFacts complete_facts() {
  ReportFacts facts = facts_for_test();
  facts.model = " SM 1000 ";
  facts.instruments = {{.name = "Laser", .serial_number = "L-1", .certificate = "K-1", .valid_until = {}}};
  return facts;
}

CustomerReport a_report() {
  CustomerReport report;
  report.facts = complete_facts();
  report.subject = "Positioning";
  report.standard = "ISO 230-2:2014";
  report.states = {{"before", ""}, {"after", ""}};
  CustomerFigure accuracy{.symbol = "A", .name = "accuracy", .unit = "µm", .states = {}, .tolerance = 10};
  accuracy.states = {{12.34, 1.0, false}, {5.25, 0.5, false}};
  CustomerFigure turn{.symbol = "E", .name = "pitch", .unit = "µrad", .states = {}, .tolerance = {}};
  turn.states = {{-1e-7, std::nullopt, true}, {std::nullopt, std::nullopt, false}};
  report.figures = {accuracy, turn};
  report.notes = {"Two poses were left out."};
  return report;
}

double number_in(const XmlElement& element, const char* child) {
  return std::strtod(element.child(child)->text.c_str(), nullptr);
}

TEST(CalibrationCertificate, HasTheElementsInTheOrderOfTheSchema) {
  const XmlElement root = parsed_document(calibration_certificate(a_report()));
  EXPECT_EQ(root.name, "digitalCalibrationCertificate");
  EXPECT_EQ(*root.attribute("schemaVersion"), "3.2.1");
  EXPECT_THAT(child_names(root), ElementsAre("administrativeData", "measurementResults"));
  EXPECT_THAT(child_names(*root.child("administrativeData")),
              ElementsAre("dccSoftware", "coreData", "items", "calibrationLaboratory", "respPersons", "customer",
                          "statements"));
  EXPECT_THAT(child_names(*all_elements(root, "coreData")[0]),
              ElementsAre("countryCodeISO3166_1", "usedLangCodeISO639_1", "mandatoryLangCodeISO639_1",
                          "uniqueIdentifier", "beginPerformanceDate", "endPerformanceDate", "performanceLocation"));
  EXPECT_THAT(child_names(*all_elements(root, "item")[0]),
              ElementsAre("name", "manufacturer", "model", "identifications"));
  const std::vector<const XmlElement*> results = all_elements(root, "measurementResult");
  ASSERT_EQ(results.size(), 2U);
  EXPECT_THAT(child_names(*results[0]), ElementsAre("name", "usedMethods", "usedSoftware", "measuringEquipments",
                                                    "influenceConditions", "results"));
}

TEST(CalibrationCertificate, GivesBackFactsFiguresAndVerdicts) {
  const XmlElement root = parsed_document(calibration_certificate(a_report()));
  EXPECT_EQ(all_elements(root, "customer")[0]->child("name")->child("content")->text, "Example & Sons <Tooling>");
  EXPECT_EQ(all_elements(root, "model")[0]->text, "SM 1000");
  EXPECT_EQ(all_elements(root, "beginPerformanceDate")[0]->text, "2026-11-28");
  const std::vector<const XmlElement*> results = all_elements(root, "measurementResult");
  const std::vector<const XmlElement*> before = all_elements(*results[0]->child("results"), "quantity"),
                                       after = all_elements(*results[1]->child("results"), "quantity");
  ASSERT_EQ(before.size(), 3U);  // A, its tolerance, E
  const XmlElement& accuracy = *before[0]->child("real");
  EXPECT_EQ(number_in(accuracy, "value"), 12.34);
  EXPECT_EQ(accuracy.child("unit")->text, "\\micro\\metre");
  EXPECT_EQ(number_in(*accuracy.child("expandedUnc"), "uncertainty"), 1.0);
  EXPECT_EQ(number_in(*accuracy.child("expandedUnc"), "coverageFactor"), 2.0);
  EXPECT_EQ(all_elements(*before[0], "conformity")[0]->text, "fail");
  EXPECT_EQ(number_in(*before[1]->child("real"), "value"), 10.0);
  const XmlElement& turn = *before[2];
  EXPECT_EQ(number_in(*turn.child("real"), "value"), -1e-7);
  EXPECT_EQ(turn.child("real")->child("unit")->text, "\\micro\\radian");
  EXPECT_EQ(turn.child("real")->child("expandedUnc"), nullptr);
  EXPECT_THAT(turn.child("description")->child("content")->text, HasSubstr("does not cover all"));
  // After the correction E was not evaluated, and A is within its tolerance.
  ASSERT_EQ(after.size(), 2U);
  EXPECT_EQ(all_elements(*after[0], "conformity")[0]->text, "pass");
}

TEST(CalibrationCertificate, NamesWhatProgramsLookForAsTheExamplesOfPtbDo) {
  const XmlElement root = parsed_document(calibration_certificate(a_report()));
  const auto reference = [&](const char* element) {
    const std::string* const found = all_elements(root, element)[0]->attribute("refType");
    return found == nullptr ? "" : *found;
  };
  EXPECT_EQ(reference("usedMethod"), "basic_uncertainty");
  EXPECT_EQ(reference("measuringEquipment"), "basic_normalUsed");
  EXPECT_EQ(reference("influenceCondition"), "basic_temperature");
  EXPECT_EQ(reference("metaData"), "basic_conformity");
}

TEST(CalibrationCertificate, HasTheUnitsOfAllKindsOfEvaluations) {
  CustomerReport report = a_report();
  report.figures.resize(1);
  const std::pair<const char*, const char*> kUnits[] = {{"µm/m", "\\micro\\metre\\per\\metre"},
                                                        {"ms", "\\milli\\second"},
                                                        {"mm", "\\milli\\metre"},
                                                        {"″", "\\arcsecond"}};
  for (const auto& [shown, unit] : kUnits) {
    report.figures[0].unit = shown;
    const XmlElement root = parsed_document(calibration_certificate(report));
    EXPECT_EQ(all_elements(*all_elements(root, "measurementResult")[0]->child("results"), "unit")[0]->text, unit);
  }
}

TEST(CalibrationCertificate, WarningsOfTheReportAreStatements) {
  CustomerReport report = a_report();
  report.is_simulated = true;
  report.refusals = {"The residuals are too large."};
  const XmlElement root = parsed_document(calibration_certificate(report));
  const std::vector<const XmlElement*> statements = all_elements(root, "statement");
  ASSERT_EQ(statements.size(), 3U);
  std::vector<std::string> sentences;
  for (const XmlElement& content : statements[0]->child("declaration")->children) sentences.push_back(content.text);
  EXPECT_THAT(sentences, ElementsAre("The readings are simulated.", "The residuals are too large."));
  EXPECT_EQ(statements[2]->child("declaration")->child("content")->text, "Axis X.");
}

TEST(CalibrationCertificate, ErrorsHaveTheirCovarianceAndTheFactorOfTheirRank) {
  CertifiedErrors errors;
  errors.names = {"EXX.1", "EC0Y", "EZ0C"};
  errors.is_angle = {false, true, false};
  errors.values = {12.5, -3e-5, 0};
  errors.covariance = Eigen::MatrixXd::Zero(3, 3);
  errors.covariance.topLeftCorner<2, 2>() << 4, 0.5, 0.5, 0.25;  // the third is set by convention
  const XmlElement root = parsed_document(calibration_certificate(a_report(), errors));
  const XmlElement& list = *all_elements(root, "realListXMLList").at(0);
  EXPECT_EQ(list.child("labelXMLList")->text, "EXX.1 EC0Y EZ0C");
  std::istringstream values(list.child("valueXMLList")->text);
  std::vector<double> read;
  for (double value = 0; values >> value;) read.push_back(value);
  EXPECT_EQ(read, errors.values);
  const std::vector<const XmlElement*> columns = all_elements(list, "column");
  ASSERT_EQ(columns.size(), 3U);
  for (std::size_t j = 0; j < 3; ++j) {
    ASSERT_EQ(columns[j]->children.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(number_in(columns[j]->children[i], "value"),
                errors.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    }
  }
  EXPECT_EQ(columns[0]->children[1].child("unit")->text, "\\micro\\radian\\micro\\metre");
  // Root of the 95 % quantile of chi-square with two degrees of freedom: sqrt(5.991465).
  EXPECT_EQ(list.child("ellipsoidalRegionXMLList")->child("coverageFactor")->text, "2.447747");
  EXPECT_EQ(all_elements(root, "realListXMLList").size(), 1U);
}

TEST(CalibrationCertificate, LeavesOutWhatIsOnlyBlanks) {
  CustomerReport report = a_report();
  report.facts.standard = " ";
  report.facts.instruments[0].serial_number = " ";
  report.facts.instruments[0].certificate = " ";
  const XmlElement root = parsed_document(calibration_certificate(report));
  EXPECT_EQ(all_elements(root, "norm")[1]->text, "ISO 230-2:2014");
  EXPECT_THAT(child_names(*all_elements(root, "measuringEquipment")[0]), ElementsAre("name"));
}

TEST(CalibrationCertificate, NamesTheFactsThatItNeeds) {
  EXPECT_TRUE(missing_for_certificate(complete_facts()).empty());
  ReportFacts facts = complete_facts();
  facts.date.reset();
  facts.serial_number = "  ";
  EXPECT_THAT(missing_for_certificate(facts), ElementsAre("machine.serial_number", "date"));
  EXPECT_THAT(missing_for_certificate({}), testing::SizeIs(10));
  CustomerReport report = a_report();
  report.facts = facts;
  EXPECT_THROW(calibration_certificate(report), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
