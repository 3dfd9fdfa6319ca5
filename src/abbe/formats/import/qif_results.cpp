// Points of QIF results (ANSI QIF 2 and 3, ISO 23952); docs/import.md has the sources.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/import/instrument_lines.h"
#include "abbe/formats/import/instrument_points.h"
#include "abbe/formats/import/instrument_readers.h"
#include "abbe/formats/import/instrument_xml.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"

namespace abbe {
namespace {

/// A unit and what it is in metres.
struct QifUnit {
  const char* name;
  double metres;
};
constexpr std::array<QifUnit, 6> kQifUnits = {
    {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"um", 1e-6}, {"inch", 0.0254}, {"foot", 0.3048}}};

class QifReader {
 public:
  QifReader(std::string_view text, const std::string& file, const ImportHints& hints)
      : file_(file), hints_(hints), root_(instrument_xml(text, file, "a document of QIF")) {}

  InstrumentTable read() {
    if (root_.name != "QIFDocument") {
      throw InputError({.file = file_, .line = root_.line}, fmt::format("the root is {}", shown_text(root_.name)),
                       "QIFDocument");
    }
    if (const XmlElement* const items = xml_at(root_, {"Features", "FeatureItems"})) {
      for (const XmlElement& item : items->children)
        names_[xml_attribute(item, "id")] = xml_text_at(item, {"FeatureName"});
    }
    take_facts();
    const PointUnit unit = linear_unit();
    walk(root_);
    if (points_.empty()) take_point_sets();
    if (points_.empty()) {
      throw InputError({.file = file_}, "there are no measured points",
                       "PointFeatureMeasurement with Location, or MeasuredPointSet with Points");
    }
    points_.write(unit, {"FeatureName", "X", "Y", "Z"}, table_);
    say_what_was_found();
    return std::move(table_);
  }

 private:
  void take_facts() {
    const auto take = [&](const char* name, const std::vector<std::string_view>& path) {
      std::string value = xml_text_at(root_, path);
      if (!value.empty()) table_.facts.push_back({name, std::move(value)});
    };
    if (const std::string version = xml_attribute(root_, "versionQIF"); !version.empty()) {
      table_.facts.push_back({"versionQIF", version});
    }
    take("TimeCreated", {"Version", "TimeCreated"});
    take("Application", {"Header", "Application", "Name"});
  }

  PointUnit linear_unit() const {
    const XmlElement* const unit = xml_at(root_, {"FileUnits", "PrimaryUnits", "LinearUnit"});
    if (unit == nullptr) {
      if (!hints_.length_unit.empty()) return {hints_.length_unit, true, hints_.length_unit + " as given", ""};
      return {"m", false, "FileUnits states no unit of lengths",
              "states no unit; metres are assumed, as the consortium's own programs do (--length-unit)"};
    }
    const std::string si = xml_text_at(*unit, {"SIUnitName"});
    const XmlElement* const factor = xml_at(*unit, {"UnitConversion", "Factor"});
    double metres = 1;
    if (factor != nullptr) {
      const std::string text = xml_text_at(*unit, {"UnitConversion", "Factor"});
      metres = instrument_number(text, file_, factor->line, "Factor", "a number of metres");
    }
    for (const QifUnit& known : kQifUnits) {
      if (si != "meter" || std::abs(metres / known.metres - 1) > 1e-9) continue;
      return {known.name, true, fmt::format("LinearUnit of FileUnits, {} m", known.metres), ""};
    }
    throw InputError({.file = file_, .line = factor != nullptr ? factor->line : unit->line, .field = "LinearUnit"},
                     fmt::format("'{}' of {} {} is not read", shown_text(xml_text_at(*unit, {"UnitName"})), metres,
                                 si.empty() ? "no SI unit" : shown_text(si)),
                     "a unit of 1, 0.01, 0.001, 0.000001, 0.0254 or 0.3048 meter");
  }

  /// All elements in their order; features are told by their names.
  void walk(const XmlElement& element) {
    if (element.name == "MeasurementResults") ++results_;
    if (element.name == "MeasuredPointSet") {
      sets_.push_back(&element);
      return;
    }
    if (element.name == "PointFeatureMeasurement" || element.name == "PointFeatureActual") return take_point(element);
    if (element.name.ends_with("FeatureMeasurement") || element.name.ends_with("FeatureActual") ||
        element.name.ends_with("CharacteristicMeasurement") || element.name.ends_with("CharacteristicActual")) {
      ++not_read_[element.name];
      return;
    }
    for (const XmlElement& child : element.children) walk(child);
  }

  void take_point(const XmlElement& element) {
    const std::string id = xml_text_at(element, {"FeatureItemId"});
    const auto known = names_.find(id);
    const std::string name = known == names_.end() ? "" : known->second;
    const XmlElement* const location = element.child("Location");
    if (location == nullptr) {
      ++not_read_["point without a Location"];
      return;
    }
    const std::vector<XmlNumber> numbers =
        xml_numbers(*location, file_, "Location", "three coordinates in the LinearUnit of the file");
    if (numbers.size() != 3) {
      throw InputError({.file = file_, .line = location->line, .field = "Location"},
                       "it has " + counted(numbers.size(), "number", "numbers"),
                       "three coordinates in the LinearUnit of the file");
    }
    points_.add(name.empty() ? id : name, {numbers[0].text, numbers[1].text, numbers[2].text}, numbers[0].line);
  }

  void take_point_sets() {
    for (const XmlElement* const set : sets_) {
      const XmlElement* const points = set->child("Points");
      const std::string id = xml_attribute(*set, "id");
      if (points == nullptr) {
        ++not_read_["MeasuredPointSet without Points"];
        continue;
      }
      const std::vector<XmlNumber> numbers =
          xml_numbers(*points, file_, "Points", "coordinates in the LinearUnit of the file");
      const std::string count = xml_attribute(*set, "count");
      if (numbers.size() % 3 != 0 || (!count.empty() && count != std::to_string(numbers.size() / 3))) {
        throw InputError({.file = file_, .line = points->line, .field = "Points"},
                         fmt::format("{}, and the count is {}", counted(numbers.size(), "number", "numbers"),
                                     count.empty() ? "not given" : shown_text(count)),
                         "three coordinates for each point");
      }
      for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) {
        points_.add(id.empty() ? "" : "set " + id, {numbers[i].text, numbers[i + 1].text, numbers[i + 2].text},
                    numbers[i].line);
      }
      if (xml_text_at(*set, {"Compensated"}) != "false") continue;
      const std::string radius = xml_text_at(*set, {"ProbeRadius"});
      table_.doubts.push_back(
          fmt::format("the points of set {} are centres of a probe of radius {}, not on the surface", shown_text(id),
                      radius.empty() ? "unknown" : shown_text(radius)));
    }
    sets_.clear();
  }

  void say_what_was_found() {
    table_.reasons.push_back(counted(points_.count(), "measured point", "measured points"));
    if (!sets_.empty()) not_read_["MeasuredPointSet"] = sets_.size();
    const std::vector<std::string> names = counted_names(not_read_);
    table_.not_read.insert(table_.not_read.end(), names.begin(), names.end());
    if (results_ > 1) {
      table_.doubts.push_back(
          fmt::format("the points are of {} MeasurementResults, which need not be of one part", results_));
    }
  }

  const std::string& file_;
  const ImportHints& hints_;
  XmlElement root_;
  InstrumentTable table_;
  InstrumentPoints points_;
  std::map<std::string, std::string> names_;
  std::map<std::string, std::size_t> not_read_;
  std::vector<const XmlElement*> sets_;
  std::size_t results_ = 0;
};

}  // namespace

std::optional<Recognition> recognise_qif_results(std::string_view text) {
  if (!begins_with_element(text, "QIFDocument")) return std::nullopt;
  return Recognition{"XML with the root QIFDocument"};
}

InstrumentTable read_qif_results(std::string_view text, const std::string& file, const ImportHints& hints) {
  return QifReader(text, file, hints).read();
}

}  // namespace abbe
