#pragma once

#include <array>
#include <compare>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/text/calendar_date.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {

class TomlTable;

/// Language of a customer report: its words, numbers and dates.
enum class ReportLanguage { english, german, chinese, japanese };
inline constexpr int kReportLanguageCount = 4;

/// "en", "de", "zh", "ja".
const char* language_code(ReportLanguage language);

/// An instrument with the certificate of its calibration; empty texts are not stated.
struct ReportInstrument {
  std::string name, serial_number, certificate;
  std::optional<CalendarDate> valid_until;
};

/// A tolerance as it was stated: "A_um", 10.
struct ReportTolerance {
  std::string name;  ///< figure and unit
  double value = 0;  ///< in the unit that the name says, above zero
  InputError::Place place;
};

/// What a customer report states beside its results. Empty texts and absent values were not stated, and the report says
/// so: nothing is made up.
struct ReportFacts {
  ReportLanguage language = ReportLanguage::english;
  std::string number;  ///< of the report
  std::string customer, customer_address;
  std::string maker, model, serial_number;  ///< of the machine
  std::string place, operator_name;
  std::string laboratory, laboratory_address, laboratory_country;  ///< who calibrated; two letters of ISO 3166-1
  std::optional<CalendarDate> date;                                ///< of the measurement
  std::optional<double> temperature;                               ///< mean, degC
  std::optional<std::array<double, 2>> temperature_range;          ///< smallest and largest, degC
  std::string standard;                                            ///< applied; empty: that of the evaluation
  std::vector<std::string> remarks;
  std::vector<ReportInstrument> instruments;
  std::vector<ReportTolerance> tolerances;
};

/// Reads the facts of a table [report], if it states any. Its other keys stay for their reader, and finish() too.
std::optional<ReportFacts> read_report_facts(TomlTable& table);

/// Facts from a file of their own that has the table [report] and nothing else. @throws InputError
ReportFacts read_report_facts(const std::filesystem::path& path);

}  // namespace abbe
