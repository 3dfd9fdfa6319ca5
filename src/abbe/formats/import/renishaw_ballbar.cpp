// Result files of a Renishaw ball bar (.b5r). Their public description has the figures that the program of the maker
// computed and the parameters of the test, which are shown, and not the readings. See docs/import.md.
#include <fmt/format.h>

#include <array>
#include <utility>

#include "abbe/formats/import/instrument_lines.h"
#include "abbe/formats/import/instrument_readers.h"
#include "abbe/formats/import/instrument_xml.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr std::size_t kLookedAtOfBallbar = std::size_t{1} << 20U;

/// Units of the figures, by their attribute DT.
constexpr std::array<std::pair<std::string_view, std::string_view>, 11> kBallbarUnits = {{{"UT_LENGTH_MM", "mm"},
                                                                                          {"UT_LENGTH_UM", "um"},
                                                                                          {"UT_LENGTH_M", "m"},
                                                                                          {"UT_FEEDRATE", "mm/min"},
                                                                                          {"UT_SQUARENESS", "um/m"},
                                                                                          {"UT_SERVO_MISMATCH", "ms"},
                                                                                          {"UT_ANGLE", "deg"},
                                                                                          {"UT_RANKING", ""},
                                                                                          {"UT_PERCENT", "%"},
                                                                                          {"UT_SCALE_ERROR", "ppm"},
                                                                                          {"UT_SPEED", "mm/s"}}};

/// Byte of the first <FEATURE NAME="..." DT="UT_...">, or npos.
std::size_t ballbar_feature(std::string_view text) {
  text = text.substr(0, kLookedAtOfBallbar);
  for (std::size_t at = text.find("<FEATURE "); at != std::string_view::npos; at = text.find("<FEATURE ", at + 1)) {
    const std::string_view tag = text.substr(at, text.find('>', at) - at);
    if (tag.find("NAME=") != std::string_view::npos && tag.find("DT=\"UT_") != std::string_view::npos) return at;
  }
  return std::string_view::npos;
}

std::string figure_words(const std::string& value, const std::string& type) {
  for (const auto& [known, unit] : kBallbarUnits) {
    if (type == known) return unit.empty() ? value : fmt::format("{} {}", value, unit);
  }
  return type.empty() ? value : fmt::format("{} ({})", value, type);
}

class BallbarReader {
 public:
  InstrumentTable read(const XmlElement& root) {
    table_.kind = ImportKind::circular;
    walk(root);
    table_.facts.insert(table_.facts.end(), figures_.begin(), figures_.end());
    table_.doubts.emplace_back(
        "where such a file has its readings is not publicly described; export them as a table with direction, angle "
        "and deviation or radius (--as circular)");
    return std::move(table_);
  }
  bool has_figures() const { return !figures_.empty(); }

 private:
  void add(const char* name, const std::string& value) {
    if (!value.empty()) table_.facts.push_back({name, shown_text(value)});
  }

  void walk(const XmlElement& element) {
    const std::string text(xml_trimmed(element.text));
    if (element.name == "FEATURE") {
      figures_.push_back(
          {shown_text(xml_attribute(element, "NAME")), shown_text(figure_words(text, xml_attribute(element, "DT")))});
    } else if (element.name == "PLANE") {
      add("plane", xml_attribute(element, "TEST_PLANE"));
    } else if (element.name == "TEST_SPEC") {
      add("test", xml_attribute(element, "NAME"));
    } else if (element.name == "MACHINE_TESTED") {
      add("machine", xml_attribute(element, "NAME"));
    } else if (element.name == "OPERATOR") {
      add("operator", text);
    } else if (element.name == "DATE_STARTED") {
      add("date", text);
    } else if (element.name == "SERIAL_NUMBER") {
      add("serial number", text);
    } else if (element.name == "LAST_CALIBRATED") {
      add("calibrated", text);
    } else if (element.name == "PART_NUMBER") {
      add("part number", text);
    }
    for (const XmlElement& child : element.children) walk(child);
  }

  InstrumentTable table_;
  std::vector<InstrumentFact> figures_;
};

}  // namespace

std::optional<Recognition> recognise_renishaw_ballbar(std::string_view text) {
  if (!csv_trimmed(text.substr(0, 100)).starts_with('<')) return std::nullopt;
  const std::size_t at = ballbar_feature(text);
  if (at == std::string_view::npos) return std::nullopt;
  return Recognition{"XML with elements FEATURE"};
}

InstrumentTable read_renishaw_ballbar(std::string_view text, const std::string& file, const ImportHints&) {
  BallbarReader reader;
  InstrumentTable table = reader.read(instrument_xml(text, file, "results of a Renishaw ball bar"));
  if (!reader.has_figures()) {
    throw InputError({.file = file, .field = "FEATURE"}, "there are no figures", "elements FEATURE with NAME and DT");
  }
  return table;
}

}  // namespace abbe
