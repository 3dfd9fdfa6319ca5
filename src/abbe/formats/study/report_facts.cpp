#include "abbe/formats/study/report_facts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/toml_table.h"

namespace abbe {
namespace {

constexpr std::array<const char*, kReportLanguageCount> kLanguageCodes = {"en", "de", "zh", "ja"};
constexpr const char* kDateExpected = "a day such as \"2026-11-28\"";

/// A table [report] with none of them asks for no customer report.
constexpr const char* kFactKeys[] = {
    "language", "number",   "customer",    "machine",          "laboratory",
    "place",    "operator", "date",        "temperature_degC", "temperature_range_degC",
    "standard", "remarks",  "instruments", "tolerances"};

std::optional<CalendarDate> read_date(TomlTable& table, const char* key) {
  if (!table.has(key)) {
    table.text_or(key, "");  // so that it is among the accepted keys
    return std::nullopt;
  }
  const std::string text = table.text(key);
  const std::optional<CalendarDate> date = parse_calendar_date(text);
  if (!date) table.fail(key, fmt::format("\"{}\" is not a date", text), kDateExpected);
  return date;
}

void read_temperatures(TomlTable& table, ReportFacts& facts) {
  constexpr double kColdest = -50, kHottest = 100;
  constexpr const char* kMean = "temperature_degC";
  constexpr const char* kRange = "temperature_range_degC";
  const std::string expected = fmt::format("degrees Celsius from {:g} to {:g}", kColdest, kHottest);
  facts.temperature = table.optional_number(kMean, Quantity::dimensionless);
  if (facts.temperature && (*facts.temperature < kColdest || *facts.temperature > kHottest)) {
    table.fail(kMean, fmt::format("{:g} is not the temperature of a workshop", *facts.temperature), expected);
  }
  const auto range = table.optional_numbers(kRange, Quantity::dimensionless, 2);
  if (!range) return;
  if (range->front() > range->back()) table.fail(kRange, "is falling", "[smallest, largest]");
  if (range->front() < kColdest || range->back() > kHottest) {
    table.fail(kRange, "is not the range of temperatures of a workshop", expected);
  }
  if (facts.temperature && (*facts.temperature < range->front() || *facts.temperature > range->back())) {
    table.fail(kMean, "is outside temperature_range_degC", "a mean within it");
  }
  facts.temperature_range = {range->front(), range->back()};
}

void read_laboratory(TomlTable& table, ReportFacts& facts) {
  auto laboratory = table.optional_table("laboratory");
  if (!laboratory) return;
  facts.laboratory = laboratory->text_or("name", "");
  facts.laboratory_address = laboratory->text_or("address", "");
  facts.laboratory_country = laboratory->text_or("country", "");
  const std::string& country = facts.laboratory_country;
  const bool is_code =
      country.size() == 2 && std::all_of(country.begin(), country.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
  if (!country.empty() && !is_code) {
    laboratory->fail("country", fmt::format("\"{}\" is not a country code", country),
                     "two letters of ISO 3166-1, such as \"DE\"");
  }
  laboratory->finish();
}

void read_instruments(TomlTable& table, ReportFacts& facts) {
  for (TomlTable& entry : table.tables("instruments")) {
    ReportInstrument instrument;
    instrument.name = entry.text("name");
    instrument.serial_number = entry.text_or("serial_number", "");
    instrument.certificate = entry.text_or("certificate", "");
    instrument.valid_until = read_date(entry, "valid_until");
    entry.finish();
    facts.instruments.push_back(std::move(instrument));
  }
}

void read_tolerances(TomlTable& table, ReportFacts& facts) {
  auto tolerances = table.optional_table("tolerances");
  if (!tolerances) return;
  for (const std::string& name : tolerances->keys()) {
    const double value = tolerances->number(name, Quantity::dimensionless);
    if (!(value > 0)) tolerances->fail(name, fmt::format("{:g} is not above zero", value), "a largest permitted value");
    facts.tolerances.push_back({name, value, tolerances->place(name)});
  }
  tolerances->finish();
}

}  // namespace

const char* language_code(ReportLanguage language) { return kLanguageCodes[static_cast<std::size_t>(language)]; }

std::optional<ReportFacts> read_report_facts(TomlTable& table) {
  const bool are_stated =
      std::any_of(std::begin(kFactKeys), std::end(kFactKeys), [&](const char* key) { return table.has(key); });
  ReportFacts facts;
  const auto language =
      table.word_or("language", 0, {kLanguageCodes[0], kLanguageCodes[1], kLanguageCodes[2], kLanguageCodes[3]});
  facts.language = static_cast<ReportLanguage>(language);
  facts.number = table.text_or("number", "");
  if (auto customer = table.optional_table("customer")) {
    facts.customer = customer->text_or("name", "");
    facts.customer_address = customer->text_or("address", "");
    customer->finish();
  }
  if (auto machine = table.optional_table("machine")) {
    facts.maker = machine->text_or("maker", "");
    facts.model = machine->text_or("model", "");
    facts.serial_number = machine->text_or("serial_number", "");
    machine->finish();
  }
  read_laboratory(table, facts);
  facts.place = table.text_or("place", "");
  facts.operator_name = table.text_or("operator", "");
  facts.date = read_date(table, "date");
  read_temperatures(table, facts);
  facts.standard = table.text_or("standard", "");
  facts.remarks = table.texts_or_none("remarks");
  read_instruments(table, facts);
  read_tolerances(table, facts);
  return are_stated ? std::optional(std::move(facts)) : std::nullopt;
}

ReportFacts read_report_facts(const std::filesystem::path& path) {
  TomlTable root = TomlTable::parse(read_text_file(path), path.string());
  TomlTable table = root.table("report");
  std::optional<ReportFacts> facts = read_report_facts(table);
  table.finish();
  root.finish();
  if (!facts) root.fail("report", "states nothing", "customer, machine, date and other facts");
  return *facts;
}

}  // namespace abbe
