// Customer reports of `abbe evaluate` and `abbe run`, as pages and printed by the programs that are installed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <thread>
#include <tuple>

#include "abbe/formats/files/printed_page.h"
#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const std::string kCustomerExamples = ABBE_SOURCE_DIR "/examples/customer_report/";

class CustomerReportCommand : public CommandTest {
 protected:
  /// Words of the evaluation before and after a correction. @param language  of the report
  std::vector<std::string> evaluation(const std::string& language, const std::string& output) const {
    std::string facts = text_of(kCustomerExamples + "facts.toml");
    const std::string english = "language = \"en\"";
    facts.replace(facts.find(english), english.size(), "language = \"" + language + "\"");
    folder.write("facts.toml", facts);
    return {"evaluate",
            "positioning",
            kCustomerExamples + "after.csv",
            "--before",
            kCustomerExamples + "before.csv",
            "--instrument-um-per-m",
            "0.4",
            "--environment-um",
            "0.3",
            "--facts",
            "facts.toml",
            "--customer-report",
            output};
  }

  static std::string text_of(const std::string& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
};

TEST_F(CustomerReportCommand, EvaluationsWriteAPageInTheLanguageOfItsFacts) {
  const CommandResult result = abbe(evaluation("de", "report.html"));
  ASSERT_EQ(result.exit_code, done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("customer report: report.html"));
  const std::string page = folder.read("report.html");
  for (const char* text : {"<html lang=\"de\">", "Example Tooling Ltd", "SM-0417", "28.11.2026", "K-2026-0815",
                           "beidseitige Positioniergenauigkeit", "Die Nichtkonformität mit der Spezifikation ist",
                           "Die Konformität mit der Spezifikation ist nachgewiesen: A, R, B.", "21,03 ± 0,54"}) {
    EXPECT_THAT(page, HasSubstr(text));
  }
}

TEST_F(CustomerReportCommand, ToleranceOfTheFactsDecideTheExitCode) {
  folder.write("tight.toml", "[report]\ntolerances = { A_um = 2 }\n");
  const std::vector<std::string> words = {"evaluate",   "positioning", kCustomerExamples + "after.csv",
                                          "--facts",    "tight.toml",  "--customer-report",
                                          "report.html"};
  const CommandResult result = abbe(words);
  EXPECT_EQ(result.exit_code, computation_says_no);
  const std::string page = folder.read("report.html");
  EXPECT_THAT(page, HasSubstr("Beyond the tolerance, or not evaluated: A."));
  EXPECT_THAT(page, HasSubstr("No verdict: the measurement uncertainty is not known (A)."));
  EXPECT_EQ(abbe(words).exit_code, bad_input) << "the file exists";
}

TEST_F(CustomerReportCommand, WrongFactsFilesAndNamesAreRefusedBeforeAnythingIsWritten) {
  folder.write("facts.toml", "[report]\nplace = \"a\"\n\ntolerances = { Q_um = 2 }\n");
  const std::string readings = kCustomerExamples + "after.csv";
  CommandResult result =
      abbe({"evaluate", "positioning", readings, "--facts", "facts.toml", "--customer-report", "a.html"});
  EXPECT_EQ(result.exit_code, bad_input);
  EXPECT_THAT(result.err, HasSubstr("facts.toml:4:16: report.tolerances.Q_um: there is no such figure"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.html"));
  result = abbe({"evaluate", "positioning", readings, "--customer-report", "a.txt"});
  EXPECT_EQ(result.exit_code, bad_input);
  EXPECT_THAT(result.err, HasSubstr("expected a name that ends in .pdf, .html, or .xml"));
  EXPECT_EQ(abbe({"evaluate", "positioning", readings, "--facts", "facts.toml"}).exit_code, bad_input)
      << "without a report to write";
  result = abbe({"evaluate", "positioning", readings, "--before", ABBE_SOURCE_DIR "/examples/evaluate/rotary.csv",
                 "--customer-report", "a.html"});
  EXPECT_EQ(result.exit_code, bad_input);
  EXPECT_THAT(result.err, HasSubstr("--before: the readings are of another test or of other axes"));
}

TEST_F(CustomerReportCommand, CertificatesNeedTheFactsOfTheirSchema) {
  std::vector<std::string> arguments = evaluation("de", "certificate.xml");
  const CommandResult result = abbe(arguments);
  ASSERT_EQ(result.exit_code, done) << result.err;
  const std::string certificate = folder.read("certificate.xml");
  for (const char* text : {"schemaVersion=\"3.2.1\"", "<dcc:uniqueIdentifier>2026-117</dcc:uniqueIdentifier>",
                           "<dcc:content lang=\"de\">A: beidseitige Positioniergenauigkeit</dcc:content>",
                           "<si:unit>\\micro\\metre</si:unit>", "<dcc:conformity>fail</dcc:conformity>",
                           "<dcc:conformity>pass</dcc:conformity>", "<dcc:value>K-2026-0815</dcc:value>"}) {
    EXPECT_THAT(certificate, HasSubstr(text));
  }
  std::string facts = folder.read("facts.toml");
  facts = std::regex_replace(facts, std::regex("laboratory = [^\n]*\n"), "");
  folder.write("facts.toml", std::regex_replace(facts, std::regex("number = \"2026-117\"\n"), ""));
  arguments.back() = "other.xml";
  arguments.insert(arguments.end(), {"--qif", "other.qif"});
  const CommandResult missing = abbe(arguments);
  EXPECT_EQ(missing.exit_code, bad_input);
  EXPECT_THAT(missing.err, HasSubstr("other.xml: a certificate also needs number, laboratory.name, laboratory.address, "
                                     "laboratory.country in [report]"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "other.xml"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "other.qif"));
}

TEST_F(CustomerReportCommand, EvaluationsWriteTheirFiguresInQif) {
  std::vector<std::string> words = evaluation("de", "report.html");
  words.insert(words.end(), {"--qif", "results.qif"});
  const CommandResult result = abbe(words);
  ASSERT_EQ(result.exit_code, done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("QIF: results.qif"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "report.html"));
  const std::string qif = folder.read("results.qif");
  for (const char* text :
       {"versionQIF=\"3.0.0\"", "<MeasurementResultsSet n=\"2\">", "<SerialNumber>SM-0417</SerialNumber>",
        "<CharacteristicStatusEnum>FAIL</CharacteristicStatusEnum>",
        "<CharacteristicStatusEnum>PASS</CharacteristicStatusEnum>",
        "<InspectionStart>2026-11-28T00:00:00</InspectionStart>",
        "<WhatToMeasure>beidseitige Positioniergenauigkeit</WhatToMeasure>"}) {
    EXPECT_THAT(qif, HasSubstr(text));
  }
  // The value of A after the correction is that of the evaluation.
  const CommandResult json = abbe({"evaluate", "positioning", kCustomerExamples + "after.csv", "--json"});
  std::smatch value;
  ASSERT_TRUE(std::regex_search(json.out, value, std::regex("\"A\": \\{[^}]*\"value_um\": ([0-9.]+)"))) << json.out;
  EXPECT_THAT(qif, HasSubstr(">" + value[1].str() + "</Value>"));
  const CommandResult alone =
      abbe({"evaluate", "positioning", kCustomerExamples + "after.csv", "--qif", "alone.qif", "--json"});
  EXPECT_EQ(alone.exit_code, done) << alone.err;
  EXPECT_THAT(folder.read("alone.qif"), HasSubstr("<InspectionStatusEnum>NOT_CALCULATED</InspectionStatusEnum>"));
  EXPECT_EQ(abbe({"evaluate", "positioning", kCustomerExamples + "after.csv", "--qif", "alone.qif"}).exit_code,
            bad_input)
      << "the file exists";
  const CommandResult name = abbe({"evaluate", "positioning", kCustomerExamples + "after.csv", "--qif", "a.xml"});
  EXPECT_EQ(name.exit_code, bad_input);
  EXPECT_THAT(name.err, HasSubstr("expected a name that ends in .qif"));
}

TEST_F(CustomerReportCommand, QifIsRecognisedByTheImport) {
  ASSERT_EQ(abbe({"evaluate", "positioning", kCustomerExamples + "after.csv", "--qif", "a.qif"}).exit_code, done);
  const CommandResult result = abbe({"import", "a.qif", "-o", "points.csv"});
  EXPECT_EQ(result.exit_code, bad_input);
  EXPECT_THAT(result.err, HasSubstr("there are no measured points")) << "figures are no points";
}

TEST_F(CustomerReportCommand, StudiesWriteTheirFiguresInQif) {
  const CommandResult result = abbe({"run", kCustomerExamples + "mill.study.toml", "-o", "out", "--qif", "mill.qif"});
  ASSERT_EQ(result.exit_code, done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("QIF:       mill.qif"));
  const std::string qif = folder.read("mill.qif");
  EXPECT_THAT(qif, HasSubstr("<MeasurementResultsSet n=\"1\">")) << "a prediction is no measurement";
  EXPECT_THAT(qif, HasSubstr("<Name>EC0Y</Name>"));
  EXPECT_THAT(qif, HasSubstr("<CharacteristicStatusEnum>INDETERMINATE</CharacteristicStatusEnum>"));
  const CommandResult without =
      abbe({"run", ABBE_SOURCE_DIR "/examples/three_axis/dials.study.toml", "-o", "other", "--qif", "dials.qif"});
  EXPECT_EQ(without.exit_code, bad_input);
  EXPECT_THAT(without.err, HasSubstr("states no facts of a customer report"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "other"));
}

TEST_F(CustomerReportCommand, EveryKindOfEvaluationHasOne) {
  const std::string examples = ABBE_SOURCE_DIR "/examples/";
  const std::string engraver = examples + "laser_engraver/";
  folder.write("facts.toml", "[report]\nlanguage = \"de\"\nnumber = \"7\"\n");
  struct Kind {
    std::vector<std::string> words;
    const char *subject, *table;
  };
  const Kind kinds[] = {
      {{"circular", examples + "evaluate/circular.csv", "--radius-mm", "150", "--u-reading-um", "0.2", "--tolerance",
        "G_b_um=15"},
       "Kreisformprüfung",
       "Radialabweichungen der Messwerte"},
      {{"rotation", examples + "evaluate/rotation.csv", "--plane-distance-mm", "80", "--u-reading-um", "0.02"},
       "Bewegungsabweichungen einer Drehachse",
       "Synchrone Bewegungsabweichungen an Winkeln"},
      {{"straightness", examples + "evaluate/straightness.csv", "--u-reading-um", "0.3"},
       "Geradheit einer Linie",
       "von der Minimumzone / µm"},
      {{"squareness", examples + "evaluate/squareness.csv", "--u-reading-um", "0.3"},
       "Rechtwinkligkeit zweier Linien",
       "Abweichungen von der Bezugsgeraden Y"},
      {{"contour", engraver + "sections.csv", "--u-height-um", "2", "--u-across-um", "1"},
       "Konturabweichung einer gravierten Kurve",
       "Konturabweichung der Schnitte"},
      {{"contour", engraver + "engraved.csv", "--curve", engraver + "table-a4.csv"},
       "Konturabweichung einer gravierten Kurve",
       "Abweichungen der Punkte von der Kurve"},
      {{"linkage", engraver + "five-steps.csv", "--exit-to-axis-mm", "120", "--board-mm", "4"},
       "Geometriegrößen einer Lasergraviermaschine",
       "Versatz des Strahls gegen die Achse A"},
      {{"etve", examples + "evaluate/etve.csv", "--u-reading-um", "0.1"},
       "Abweichung durch Änderung der Umgebungstemperatur",
       "ETVE von Z über die Prüfung"},
      {{"spindle-distortion", examples + "evaluate/spindle.csv", "--stop-min", "240"},
       "Thermische Verformung durch die drehende Spindel",
       "Änderungen über der Zeit"},
      {{"axis-distortion", examples + "evaluate/axis_warming.csv"},
       "Thermische Verformung durch die bewegte Achse",
       "P1 = 50 mm, P2 = 250 mm, P3 = 450 mm"},
      {{"location-distortion", examples + "warm_up/r-test.study.toml", "--stop-min", "240"},
       "Thermische Änderung der Lageabweichungen",
       "Spanne von EZ0A über die Dauer der Erwärmung"},
  };
  int number = 0;
  for (const Kind& kind : kinds) {
    const std::string name = "report-" + std::to_string(++number);
    std::vector<std::string> words = {"evaluate"};
    words.insert(words.end(), kind.words.begin(), kind.words.end());
    words.insert(words.end(), {"--facts", "facts.toml", "--customer-report", name + ".html", "--qif", name + ".qif"});
    const CommandResult result = abbe(words);
    ASSERT_EQ(result.exit_code, done) << kind.subject << ": " << result.err;
    const std::string page = folder.read(name + ".html");
    EXPECT_THAT(page, HasSubstr(std::string("<p>") + kind.subject + "</p>"));
    EXPECT_THAT(page, HasSubstr(kind.table));
    EXPECT_THAT(folder.read(name + ".qif"), HasSubstr("<CharacteristicMeasurements"));
  }
  EXPECT_THAT(folder.read("report-1.html"), HasSubstr("Die Konformität mit der Spezifikation ist nachgewiesen: G_b."));
}

TEST_F(CustomerReportCommand, WithoutAProgramThatPrintsThePageIsWrittenAndTheExitCodeSaysSo) {
  const CommandResult result = abbe(evaluation("en", "report.pdf"), {"PATH=/nowhere", "ABBE_BROWSER="});
  EXPECT_EQ(result.exit_code, bad_input);
  EXPECT_THAT(result.err, HasSubstr("report.pdf: not written, no program that prints pages is installed: install "
                                    "chromium or weasyprint"));
  EXPECT_THAT(result.err, HasSubstr("complete before that: report.html"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "report.pdf"));
  EXPECT_THAT(folder.read("report.html"), HasSubstr("Example Tooling Ltd"));
}

TEST_F(CustomerReportCommand, StudiesWriteAPageAmongTheirResults) {
  const CommandResult result = abbe({"run", kCustomerExamples + "mill.study.toml", "-o", "out"});
  ASSERT_EQ(result.exit_code, done) << result.err;
  EXPECT_THAT(result.out, HasSubstr("customer:  out/customer-report.html"));
  const std::string page = folder.read("out/customer-report.html");
  EXPECT_THAT(page, HasSubstr("Neither conformity nor nonconformity is proven: V_max."));
  EXPECT_THAT(page, HasSubstr("Errors of axis Z at positions"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out/customer-report.pdf"));
}

TEST_F(CustomerReportCommand, StudiesThatNameALaboratoryWriteACertificate) {
  const CommandResult result = abbe({"run", kCustomerExamples + "mill.study.toml", "-o", "results"});
  ASSERT_NE(result.exit_code, bad_input) << result.err;
  const std::string certificate = folder.read("results/calibration-certificate.xml");
  const auto has = [&](const char* text) { return certificate.find(text) != std::string::npos; };
  EXPECT_TRUE(has("Machine as measured"));
  EXPECT_TRUE(has("EC0Y: orientation of axis Y about Z"));
  EXPECT_TRUE(has("<si:ellipsoidalRegionXMLList>"));
  EXPECT_FALSE(has("Predicted after correction")) << "a prediction is no measurement";
}

TEST_F(CustomerReportCommand, StudiesWithoutABrowserKeepTheirOtherResults) {
  const CommandResult result =
      abbe({"run", kCustomerExamples + "mill.study.toml", "-o", "out", "--pdf"}, {"PATH=/nowhere", "ABBE_BROWSER="});
  EXPECT_EQ(result.exit_code, bad_input);
  EXPECT_THAT(result.err, HasSubstr("out/customer-report.pdf: not written"));
  EXPECT_THAT(folder.read("out/customer-report.html"), HasSubstr("Example Tooling Ltd"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out/errors.toml"));
}

TEST_F(CustomerReportCommand, AStudyOutOfToleranceEndsWithExitCodeOne) {
  std::filesystem::copy(ABBE_SOURCE_DIR "/examples/machines", folder.path() / "machines");
  std::filesystem::copy(kCustomerExamples, folder.path() / "study");
  std::string study = folder.read("study/mill.study.toml");
  const std::string wide = "EXX_um = 10";
  study.replace(study.find(wide), wide.size(), "EXX_um = 1");
  folder.write("study/mill.study.toml", study);
  const CommandResult result = abbe({"run", "study/mill.study.toml", "-o", "out"});
  EXPECT_EQ(result.exit_code, computation_says_no);
  EXPECT_THAT(result.err, HasSubstr("out of tolerance: EXX"));
  EXPECT_THAT(folder.read("out/customer-report.html"),
              HasSubstr("Nonconformity with the specification is proven: EXX."));
}

TEST_F(CustomerReportCommand, StudiesShowResultsBeforeACorrection) {
  const std::string study = kCustomerExamples + "mill.study.toml";
  ASSERT_EQ(abbe({"run", study, "-o", "first"}).exit_code, done);
  for (const char* before : {"first", "first/errors.toml"}) {
    ASSERT_EQ(abbe({"run", study, "-o", "second", "--before", before}).exit_code, done);
    const std::string page = folder.read("second/customer-report.html");
    EXPECT_THAT(page, HasSubstr("<b>Before correction: </b>Conformity"));
    EXPECT_THAT(page, HasSubstr("<b>After correction: </b>Conformity"));
    const std::string certificate = folder.read("second/calibration-certificate.xml");
    const std::size_t after = certificate.find("After correction");
    ASSERT_NE(after, std::string::npos);
    EXPECT_LT(certificate.find("Before correction"), after);
    EXPECT_LT(after, certificate.find("<si:ellipsoidalRegionXMLList>")) << "the errors are those of the machine now";
  }
  EXPECT_EQ(abbe({"run", study, "-o", "third", "--before", "nowhere"}).exit_code, bad_input);
  const CommandResult without =
      abbe({"run", ABBE_SOURCE_DIR "/examples/three_axis/dials.study.toml", "-o", "third", "--before", "first"});
  EXPECT_EQ(without.exit_code, bad_input);
  EXPECT_THAT(without.err, HasSubstr("before: is of a customer report, whose facts are missing"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "third"));
}

TEST_F(CustomerReportCommand, AStudyWithoutFactsHasNoneToPrint) {
  const CommandResult result =
      abbe({"run", ABBE_SOURCE_DIR "/examples/three_axis/dials.study.toml", "-o", "out", "--pdf"});
  EXPECT_EQ(result.exit_code, bad_input);
  EXPECT_THAT(result.err, HasSubstr("states no facts of a customer report"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST_F(CustomerReportCommand, AnInterruptionEndsTheBrowserAndLeavesNothing) {
  // It writes again and again to its folder, as a browser does to its profile.
  folder.write("browser",
               "#!/bin/sh\nfor word; do case $word in --user-data-dir=*) profile=${word#*=};; esac; done\n"
               "while true; do mkdir -p $profile; echo > $profile/written; done\n");
  std::filesystem::permissions(folder.path() / "browser", std::filesystem::perms::owner_all);
  const std::filesystem::path temporary = folder.path() / "temporary";
  std::filesystem::create_directory(temporary);
  const auto is_printing = [&](pid_t) {
    for (const auto& entry : std::filesystem::directory_iterator(temporary)) {
      if (std::filesystem::exists(entry.path() / "profile" / "written")) return true;
    }
    return false;
  };
  const std::string browser = "ABBE_BROWSER=" + (folder.path() / "browser").string();
  const CommandResult result =
      run_and_signal("/usr/bin/env",
                     {browser, "TMPDIR=" + temporary.string(), ABBE_COMMAND, "evaluate", "positioning",
                      kCustomerExamples + "after.csv", "--customer-report", "report.pdf"},
                     folder.path(), SIGTERM, is_printing);
  EXPECT_TRUE(result.signalled);
  EXPECT_EQ(result.exit_code, 128 + SIGTERM);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_TRUE(std::filesystem::is_empty(temporary)) << "the browser still runs";
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "report.pdf"));
}

/// Programs that print, by their command.
const char* const kPrinters[] = {"chromium", "weasyprint"};

/// Where a program is; empty: it is not installed.
std::string installed_printer(const std::string& command) {
  const std::string path = "/usr/bin/" + command;
  return std::filesystem::exists(path) ? path : "";
}

/// Printed by a program in a language; skipped, visibly, without the program and without fonts of the language.
class PrintedCustomerReport : public CustomerReportCommand,
                              public testing::WithParamInterface<std::tuple<const char*, const char*>> {
 protected:
  void SetUp() override {
    printer_ = installed_printer(std::get<0>(GetParam()));
    if (printer_.empty()) GTEST_SKIP() << std::get<0>(GetParam()) << " is not installed";
  }

  std::string language() const { return std::get<1>(GetParam()); }

  CommandResult print(const std::vector<std::string>& words) { return abbe(words, {"ABBE_BROWSER=" + printer_}); }

  /// @returns whether it was printed; else the test is skipped for lack of fonts, or failed
  bool printed(const CommandResult& result) {
    if (result.exit_code == done) return true;
    has_no_font_ = result.err.find("no font with the letters") != std::string::npos;
    EXPECT_TRUE(has_no_font_) << result.err;
    return false;
  }

  /// Checks the sheets, and the text where pdftotext is installed. @param words  that have to be in it
  void expect_report(const std::string& name, const std::vector<std::string>& words) {
    const std::string pdf = folder.read(name);
    EXPECT_TRUE(pdf.starts_with("%PDF-"));
    const std::size_t pages = pdf_page_count(pdf);
    EXPECT_GE(pages, 2U);
    EXPECT_LE(pages, 4U);
    EXPECT_THAT(pdf, HasSubstr("/CreationDate (D:20261128000000"));
    if (!std::filesystem::exists("/usr/bin/pdftotext")) return;
    const CommandResult text = run_program("/usr/bin/pdftotext", {name, "-"}, folder.path());
    ASSERT_EQ(text.exit_code, 0) << text.err;
    for (const std::string& word : words) EXPECT_NE(text.out.find(word), std::string::npos) << word;
    EXPECT_TRUE(std::regex_search(text.out, std::regex("1 ?/ ?" + std::to_string(pages)))) << "number of the sheet";
  }

  std::string printer_;
  bool has_no_font_ = false;
};

std::string name_of_accuracy(const std::string& language) {
  if (language == "de") return "beidseitige Positioniergenauigkeit";
  if (language == "zh") return "双向定位精度";
  if (language == "ja") return "両方向位置決めの正確さ";
  return "bidirectional accuracy of positioning";
}

TEST_P(PrintedCustomerReport, OfAnEvaluationHasTwoToFourSheetsWithText) {
  if (!printed(print(evaluation(language(), "report.pdf")))) {
    if (has_no_font_) GTEST_SKIP() << "no font for " << language();
    return;
  }
  expect_report("report.pdf", {name_of_accuracy(language()), "Example Tooling Ltd", "SM-0417", "K-2026-0815"});
}

TEST_P(PrintedCustomerReport, OfAStudyHasTwoToFourSheetsWithText) {
  std::filesystem::copy(ABBE_SOURCE_DIR "/examples/machines", folder.path() / "machines");
  std::filesystem::copy(kCustomerExamples, folder.path() / "study");
  const std::string study = std::regex_replace(folder.read("study/mill.study.toml"), std::regex("language = \"en\""),
                                               "language = \"" + language() + "\"");
  folder.write("study/mill.study.toml", study);
  if (!printed(print({"run", "study/mill.study.toml", "-o", "out", "--pdf"}))) {
    if (has_no_font_) GTEST_SKIP() << "no font for " << language();
    return;
  }
  expect_report("out/customer-report.pdf", {"Example Tooling Ltd", "SM-0418", "EXX", "EC0Y", "V_max"});
}

std::vector<std::tuple<const char*, const char*>> printers_and_languages() {
  std::vector<std::tuple<const char*, const char*>> all;
  for (const char* const language : {"en", "de", "zh", "ja"}) all.emplace_back("chromium", language);
  // WeasyPrint 57 takes 20 s of a processor to reduce a font with Chinese or Japanese letters.
  for (const char* const language : {"en", "de"}) all.emplace_back("weasyprint", language);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Languages, PrintedCustomerReport, testing::ValuesIn(printers_and_languages()),
                         [](const auto& tested) {
                           return std::string(std::get<0>(tested.param)) + "_" + std::get<1>(tested.param);
                         });

class CustomerReportPrinter : public CustomerReportCommand, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    printer_ = installed_printer(GetParam());
    if (printer_.empty()) GTEST_SKIP() << GetParam() << " is not installed";
  }

  std::string printer_;
};

TEST_P(CustomerReportPrinter, PrintsTwiceTheSameBytes) {
  for (const char* name : {"first.pdf", "second.pdf"}) {
    // The clock has to go on between the two.
    if (*name == 's') std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    const CommandResult result = abbe(evaluation("en", name), {"ABBE_BROWSER=" + printer_});
    ASSERT_EQ(result.exit_code, done) << result.err;
  }
  const std::string first = folder.read("first.pdf"), second = folder.read("second.pdf");
  const auto differ = std::mismatch(first.begin(), first.end(), second.begin(), second.end()).first;
  EXPECT_TRUE(first == second) << first.size() << " and " << second.size() << " bytes, different from "
                               << differ - first.begin() << ": "
                               << std::string(differ, differ + std::min<std::ptrdiff_t>(80, first.end() - differ));
}

TEST_P(CustomerReportPrinter, LeavesNothingWhenInterrupted) {
  const std::filesystem::path temporary = folder.path() / "temporary";
  std::filesystem::create_directory(temporary);
  const auto is_printing = [&](pid_t) {
    for (const auto& entry : std::filesystem::directory_iterator(temporary)) {
      if (std::filesystem::exists(entry.path() / "page.html")) return true;
    }
    return false;
  };
  const CommandResult result =
      run_and_signal("/usr/bin/env",
                     {"ABBE_BROWSER=" + printer_, "TMPDIR=" + temporary.string(), ABBE_COMMAND, "evaluate",
                      "positioning", kCustomerExamples + "after.csv", "--customer-report", "report.pdf"},
                     folder.path(), SIGTERM, is_printing);
  EXPECT_TRUE(result.signalled);
  EXPECT_EQ(result.exit_code, 128 + SIGTERM);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_TRUE(std::filesystem::is_empty(temporary));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "report.pdf"));
}

INSTANTIATE_TEST_SUITE_P(Printers, CustomerReportPrinter, testing::ValuesIn(kPrinters),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace abbe
