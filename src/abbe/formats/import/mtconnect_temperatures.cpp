// Temperatures in answers of MTConnect agents; docs/import.md has the source.
#include <fmt/format.h>

#include "abbe/formats/import/instrument_lines.h"
#include "abbe/formats/import/instrument_readers.h"
#include "abbe/formats/import/instrument_xml.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"
#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

class TemperatureReader {
 public:
  TemperatureReader(std::string_view text, const std::string& file)
      : file_(file), root_(instrument_xml(text, file, "an answer of an MTConnect agent")) {}

  InstrumentTable read() {
    walk(root_, "");
    if (table_.lines.empty()) {
      throw InputError({.file = file_}, "there are no temperatures", "elements Temperature with a number");
    }
    table_.kind = ImportKind::temperatures;
    table_.columns = {{"timestamp", "time", "", true, "its time"},
                      {"component and dataItemId", "sensor", "", true, "where it was measured"},
                      {"Temperature", "temperature_degC", "", true, "CELSIUS, as the standard has it for TEMPERATURE"}};
    table_.reasons.push_back(counted(table_.lines.size(), "temperature", "temperatures"));
    for (const std::string& name : counted_names(not_read_)) table_.not_read.push_back(name);
    return std::move(table_);
  }

 private:
  void walk(const XmlElement& element, std::string component) {
    if (element.name == "ComponentStream" || element.name == "DeviceStream") {
      component = xml_attribute(element, "name");
      if (component.empty()) component = xml_attribute(element, "componentId");
    }
    const bool holds = element.name == "Samples" || element.name == "Events" || element.name == "Condition";
    for (const XmlElement& child : element.children) {
      if (holds && child.name == "Temperature") {
        take(child, component);
      } else if (holds) {
        ++not_read_[child.name];
      } else {
        walk(child, component);
      }
    }
  }

  void take(const XmlElement& element, const std::string& component) {
    if (xml_text_at(element, {}) == "UNAVAILABLE") {
      ++not_read_["Temperature UNAVAILABLE"];
      return;
    }
    const std::string expected = "a temperature in degrees Celsius, or UNAVAILABLE";
    const std::vector<XmlNumber> numbers = xml_numbers(element, file_, "Temperature", expected);
    const std::string time = xml_attribute(element, "timestamp");
    if (numbers.size() != 1 || time.empty()) {
      throw InputError({.file = file_, .line = element.line, .field = "Temperature"},
                       time.empty() ? "it has no timestamp" : "it has " + counted(numbers.size(), "number", "numbers"),
                       time.empty() ? "the time of the observation" : expected);
    }
    const std::string sensor = fmt::format("{} {}", component, xml_attribute(element, "dataItemId"));
    table_.rows += fmt::format("{},{},{}\n", csv_field(printable(time, 60, LineFeeds::escaped)),
                               csv_field(printable(sensor, 120, LineFeeds::escaped)), numbers[0].text);
    table_.lines.push_back(element.line);
  }

  const std::string& file_;
  XmlElement root_;
  InstrumentTable table_;
  std::map<std::string, std::size_t> not_read_;
};

}  // namespace

bool has_only_temperatures(std::string_view text) {
  return text.find("<PathPosition") == std::string_view::npos && text.find(":PathPosition") == std::string_view::npos &&
         (text.find("<Temperature ") != std::string_view::npos || text.find(":Temperature ") != std::string_view::npos);
}

std::optional<Recognition> recognise_mtconnect_temperatures(std::string_view text) {
  if (!begins_with_element(text, "MTConnectStreams") || !has_only_temperatures(text)) return std::nullopt;
  return Recognition{"XML with the root MTConnectStreams, with temperatures and without positions"};
}

InstrumentTable read_mtconnect_temperatures(std::string_view text, const std::string& file, const ImportHints&) {
  return TemperatureReader(text, file).read();
}

}  // namespace abbe
