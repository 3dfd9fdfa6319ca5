#include "abbe/formats/study/report_facts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/formats/files/temporary_file_for_test.h"
#include "abbe/formats/text/toml_table.h"

namespace abbe {
namespace {

using testing::HasSubstr;

std::optional<ReportFacts> facts_of(const std::string& text) {
  TomlTable table = TomlTable::parse(text, "facts.toml");
  std::optional<ReportFacts> facts = read_report_facts(table);
  table.finish();
  return facts;
}

void expect_refused(const std::string& text, const std::string& message) {
  try {
    facts_of(text);
    ADD_FAILURE() << "no error: " << text;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(message));
  }
}

TEST(ReportFacts, HoldWhatTheTableStates) {
  const std::optional<ReportFacts> facts = facts_of(R"(
language = "ja"
number = "2026-117"
customer = { name = "Customer", address = "Street 1" }
machine = { maker = "Maker", model = "M1", serial_number = "4711" }
place = "Hall 3"
operator = "An Operator"
date = "2026-11-28"
temperature_degC = 20.3
temperature_range_degC = [19.8, 20.9]
standard = "ISO 230-2:2014"
remarks = ["one", "two"]
tolerances = { A_um = 10, "R+_um" = 4.5 }
[[instruments]]
name = "laser"
serial_number = "L1"
certificate = "C-9"
valid_until = "2027-01-31"
[[instruments]]
name = "level"
)");
  ASSERT_TRUE(facts);
  EXPECT_EQ(facts->language, ReportLanguage::japanese);
  EXPECT_EQ(facts->number, "2026-117");
  EXPECT_EQ(facts->customer, "Customer");
  EXPECT_EQ(facts->customer_address, "Street 1");
  EXPECT_EQ(facts->maker + facts->model + facts->serial_number, "MakerM14711");
  EXPECT_EQ(facts->place, "Hall 3");
  EXPECT_EQ(facts->operator_name, "An Operator");
  EXPECT_EQ(facts->date, std::chrono::year{2026} / 11 / 28);
  EXPECT_EQ(facts->temperature, 20.3);
  EXPECT_EQ(facts->temperature_range, (std::array<double, 2>{19.8, 20.9}));
  EXPECT_EQ(facts->standard, "ISO 230-2:2014");
  EXPECT_THAT(facts->remarks, testing::ElementsAre("one", "two"));
  ASSERT_EQ(facts->tolerances.size(), 2U);
  EXPECT_EQ(facts->tolerances[1].name, "R+_um");
  EXPECT_EQ(facts->tolerances[1].value, 4.5);
  EXPECT_EQ(facts->tolerances[1].place.line, 13U);
  ASSERT_EQ(facts->instruments.size(), 2U);
  EXPECT_EQ(facts->instruments[0].valid_until, std::chrono::year{2027} / 1 / 31);
  EXPECT_EQ(facts->instruments[1].certificate, "");
  EXPECT_FALSE(facts->instruments[1].valid_until);
}

TEST(ReportFacts, ATableWithoutAnyIsNoReport) {
  EXPECT_FALSE(facts_of("# nothing\n"));
  EXPECT_TRUE(facts_of("place = \"\""));
}

TEST(ReportFacts, WrongKeysAndValuesAreRefusedWhereTheyStand) {
  expect_refused("place = \"a\"\ncustomr = { name = \"a\" }\n",
                 "facts.toml:2:1: customr: unknown key, did you mean customer?");
  expect_refused("customer = { name = \"a\", street = \"b\" }\n", "customer.street: unknown key");
  expect_refused("language = \"fr\"\n", "language: unknown word \"fr\"; expected \"en\", \"de\", \"zh\" or \"ja\"");
  expect_refused("date = \"28.11.2026\"\n",
                 "date: \"28.11.2026\" is not a date; expected a day such as \"2026-11-28\"");
  expect_refused("temperature_degC = 293\n", "temperature_degC: 293 is not the temperature of a workshop");
  expect_refused("temperature_range_degC = [21, 20]\n", "temperature_range_degC: is falling");
  expect_refused("temperature_degC = 25\ntemperature_range_degC = [19, 21]\n", "is outside temperature_range_degC");
  expect_refused("[[instruments]]\ncertificate = \"C\"\n", "name: missing");
  expect_refused("[[instruments]]\nname = \"a\"\nvalid_until = \"2027-02-29\"\n", "is not a date");
  expect_refused("tolerances = { A_um = 0 }\n", "tolerances.A_um: 0 is not above zero");
  expect_refused("tolerances = { A_um = \"10\" }\n", "tolerances.A_um: is not a number");
}

TEST(ReportFacts, AFileOfTheirOwnHasTheTableAndNothingElse) {
  const test::TemporaryFile file("[report]\nplace = \"Hall 3\"\n", "1.toml");
  EXPECT_EQ(read_report_facts(file.path()).place, "Hall 3");
  const test::TemporaryFile empty("[report]\n", "2.toml");
  EXPECT_THROW(read_report_facts(empty.path()), InputError);
  const test::TemporaryFile more("[report]\nplace = \"a\"\n[setup]\n", "3.toml");
  EXPECT_THROW(read_report_facts(more.path()), InputError);
  const test::TemporaryFile page("[report]\nplace = \"a\"\npage = true\n", "4.toml");
  EXPECT_THROW(read_report_facts(page.path()), InputError) << "of studies only";
}

}  // namespace
}  // namespace abbe
