// Positions in answers of MTConnect agents (MTConnectStreams, ANSI/MTC1.4); docs/import.md has the sources.
#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/import/instrument_lines.h"
#include "abbe/formats/import/instrument_points.h"
#include "abbe/formats/import/instrument_readers.h"
#include "abbe/formats/import/instrument_xml.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"

namespace abbe {
namespace {

constexpr std::string_view kUnavailable = "UNAVAILABLE";

/// The positions of one data item of a device.
struct PositionItem {
  std::string id, subtype, device;
  InstrumentPoints points;
  std::size_t unavailable = 0;

  /// What a probe found says more than where the machine was, and that more than where it was to be.
  int rank() const { return subtype == "PROBE" ? 3 : subtype == "ACTUAL" ? 2 : subtype.empty() ? 1 : 0; }
  std::string words() const {
    return fmt::format("PathPosition '{}'{}", shown_text(id), subtype.empty() ? "" : ", " + shown_text(subtype));
  }
};

class StreamsReader {
 public:
  StreamsReader(std::string_view text, const std::string& file)
      : file_(file), root_(instrument_xml(text, file, "an answer of an MTConnect agent")) {}

  InstrumentTable read() {
    if (root_.name != "MTConnectStreams") {
      throw InputError({.file = file_, .line = root_.line}, fmt::format("the root is {}", shown_text(root_.name)),
                       "MTConnectStreams");
    }
    if (const XmlElement* const header = root_.child("Header")) {
      for (const char* const name : {"creationTime", "sender", "version", "instanceId"}) {
        const std::string value = xml_attribute(*header, name);
        if (!value.empty()) table_.facts.push_back({name, value});
      }
    }
    walk(root_, "");
    write(chosen());
    const std::vector<std::string> names = counted_names(not_read_);
    table_.not_read.insert(table_.not_read.end(), names.begin(), names.end());
    return std::move(table_);
  }

 private:
  void walk(const XmlElement& element, std::string device) {
    if (element.name == "DeviceStream") {
      device = xml_attribute(element, "name");
      if (device.empty()) device = xml_attribute(element, "uuid");
    }
    for (const XmlElement& child : element.children) {
      if (child.name == "PathPosition") {
        take_position(child, device);
      } else if (element.name == "Samples" || element.name == "Events" || element.name == "Condition") {
        ++not_read_[child.name];
      } else {
        walk(child, device);
      }
    }
  }

  void take_position(const XmlElement& element, const std::string& device) {
    const std::string id = xml_attribute(element, "dataItemId"), subtype = xml_attribute(element, "subType");
    const std::string text = xml_text_at(element, {});
    if (text == kUnavailable) {
      ++item(id, subtype, device).unavailable;
      return;
    }
    const std::string expected = "three coordinates in mm, or UNAVAILABLE";
    const std::vector<XmlNumber> numbers = xml_numbers(element, file_, "PathPosition", expected);
    // Some adapters have a data item of this type for each axis, against the standard.
    if (numbers.size() == 1) {
      ++not_read_[fmt::format("PathPosition '{}' of one coordinate", shown_text(id))];
      return;
    }
    if (numbers.size() != 3) {
      throw InputError({.file = file_, .line = element.line, .field = "PathPosition"},
                       "it has " + counted(numbers.size(), "number", "numbers"), expected);
    }
    item(id, subtype, device)
        .points.add(xml_attribute(element, "timestamp"), {numbers[0].text, numbers[1].text, numbers[2].text},
                    numbers[0].line);
  }

  PositionItem& item(const std::string& id, const std::string& subtype, const std::string& device) {
    const auto found = std::find_if(items_.begin(), items_.end(), [&](const PositionItem& one) {
      return one.id == id && one.subtype == subtype && one.device == device;
    });
    if (found != items_.end()) return *found;
    PositionItem& made = items_.emplace_back();
    made.id = id;
    made.subtype = subtype;
    made.device = device;
    return made;
  }

  /// The first of the highest rank that has positions.
  const PositionItem& chosen() {
    const PositionItem* best = nullptr;
    for (const PositionItem& one : items_) {
      if (one.points.empty()) continue;
      if (best == nullptr || one.rank() > best->rank()) best = &one;
    }
    if (best == nullptr) {
      throw InputError(
          {.file = file_}, "there are no positions",
          "elements PathPosition with three coordinates in mm; positions of single axes are not of one time");
    }
    return *best;
  }

  void write(const PositionItem& best) {
    table_.reasons.push_back(fmt::format("{}, device '{}': {} in work coordinates", best.words(),
                                         shown_text(best.device),
                                         counted(best.points.count(), "position", "positions")));
    best.points.write({"mm", true, "MILLIMETER_3D, as the standard has it for PATH_POSITION", ""},
                      {"timestamp", "X", "Y", "Z"}, table_);
    for (const PositionItem& one : items_) {
      if (one.unavailable > 0) not_read_[one.words() + " UNAVAILABLE"] += one.unavailable;
      if (&one == &best || one.points.empty()) continue;
      not_read_[one.words()] += one.points.count();
      if (one.rank() != best.rank()) continue;
      table_.doubts.push_back(fmt::format("{} of '{}' is read, and there is {} of '{}' too", best.words(),
                                          shown_text(best.device), one.words(), shown_text(one.device)));
    }
    if (best.rank() == 0) {
      table_.doubts.push_back(fmt::format("{} is the commanded position, not the actual one", best.words()));
    }
  }

  const std::string& file_;
  XmlElement root_;
  InstrumentTable table_;
  std::vector<PositionItem> items_;
  std::map<std::string, std::size_t> not_read_;
};

}  // namespace

std::optional<Recognition> recognise_mtconnect_streams(std::string_view text) {
  if (!begins_with_element(text, "MTConnectStreams") || has_only_temperatures(text)) return std::nullopt;
  return Recognition{"XML with the root MTConnectStreams"};
}

InstrumentTable read_mtconnect_streams(std::string_view text, const std::string& file, const ImportHints&) {
  return StreamsReader(text, file).read();
}

}  // namespace abbe
