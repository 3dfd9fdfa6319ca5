// Descriptions of devices by MTConnect agents (MTConnectDevices): what they state of the axes is shown. docs/import.md
// says why no machine file is made of it.
#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/import/instrument_lines.h"
#include "abbe/formats/import/instrument_readers.h"
#include "abbe/formats/import/instrument_xml.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"

namespace abbe {
namespace {

/// An element Motion and the component that has it.
struct DeviceMotion {
  std::string id, parent, type, component, axis, origin;
  std::size_t line = 0;
};

std::string motion_words(const std::string& type) {
  if (type == "PRISMATIC") return "linear axis";
  if (type == "REVOLUTE") return "rotary axis";
  if (type == "CONTINUOUS") return "endless rotary axis";
  return type == "FIXED" ? "fixed" : shown_text(type);
}

std::string component_name(const XmlElement& component) {
  std::string name = xml_attribute(component, "name");
  if (name.empty()) name = xml_attribute(component, "id");
  return fmt::format("{} {}", component.name, shown_text(name));
}

class DevicesReader {
 public:
  DevicesReader(std::string_view text, const std::string& file)
      : file_(file), root_(instrument_xml(text, file, "a description of devices by an MTConnect agent")) {}

  InstrumentTable read() {
    if (root_.name != "MTConnectDevices") {
      throw InputError({.file = file_, .line = root_.line}, fmt::format("the root is {}", shown_text(root_.name)),
                       "MTConnectDevices");
    }
    walk(root_);
    if (motions_.empty() && axes_.empty()) {
      throw InputError({.file = file_}, "no axes are described", "components Linear and Rotary, or elements Motion");
    }
    for (const DeviceMotion& motion : motions_) {
      std::string words = motion_words(motion.type);
      if (!motion.axis.empty()) words += fmt::format(", along or about {}", motion.axis);
      if (!motion.origin.empty()) words += fmt::format(", at {} mm", motion.origin);
      const DeviceMotion* const parent = parent_of(motion);
      words += parent == nullptr ? ", carried by nothing" : fmt::format(", carried by {}", parent->component);
      table_.facts.push_back({motion.component, words});
    }
    bool has_end = false;
    for (const DeviceMotion& motion : motions_) has_end = state_chain(motion) || has_end;
    if (!motions_.empty() && !has_end) refuse_loop(motions_.front());
    if (!axes_.empty()) table_.facts.push_back({"axes without Motion", fmt::format("{}", fmt::join(axes_, ", "))});
    table_.doubts.emplace_back(
        "it describes a machine and has no readings; the standard does not say where tool and workpiece are, so the "
        "machine file has to be written from what is stated here");
    return std::move(table_);
  }

 private:
  void walk(const XmlElement& element) {
    const XmlElement* const motion = xml_at(element, {"Configuration", "Motion"});
    if (motion != nullptr) {
      take_motion(element, *motion);
    } else if (element.name == "Linear" || element.name == "Rotary") {
      axes_.push_back(component_name(element));
    }
    for (const XmlElement& child : element.children) {
      if (child.name != "Configuration") walk(child);
    }
  }

  void take_motion(const XmlElement& component, const XmlElement& element) {
    DeviceMotion motion;
    motion.id = xml_attribute(element, "id");
    motion.parent = xml_attribute(element, "parentIdRef");
    motion.type = xml_attribute(element, "type");
    motion.component = component_name(component);
    motion.line = element.line;
    motion.axis = three_numbers(element.child("Axis"), "Axis");
    motion.origin = three_numbers(element.child("Origin"), "Origin");
    for (const DeviceMotion& other : motions_) {
      if (motion.id.empty() || other.id != motion.id) continue;
      throw InputError({.file = file_, .line = element.line, .field = "Motion"},
                       fmt::format("the id '{}' is there twice", shown_text(motion.id)), "an id of its own");
    }
    motions_.push_back(std::move(motion));
  }

  std::string three_numbers(const XmlElement* element, const char* name) const {
    if (element == nullptr) return "";
    const std::vector<XmlNumber> numbers = xml_numbers(*element, file_, name, "three numbers");
    if (numbers.size() != 3) {
      throw InputError({.file = file_, .line = element->line, .field = name},
                       "it has " + counted(numbers.size(), "number", "numbers"), "three numbers");
    }
    return fmt::format("({}, {}, {})", numbers[0].text, numbers[1].text, numbers[2].text);
  }

  const DeviceMotion* parent_of(const DeviceMotion& motion) const {
    if (motion.parent.empty()) return nullptr;
    const auto found = std::find_if(motions_.begin(), motions_.end(),
                                    [&](const DeviceMotion& other) { return other.id == motion.parent; });
    if (found != motions_.end()) return &*found;
    throw InputError({.file = file_, .line = motion.line, .field = "parentIdRef"},
                     fmt::format("there is no Motion '{}'", shown_text(motion.parent)), "the id of another Motion");
  }

  [[noreturn]] void refuse_loop(const DeviceMotion& motion) const {
    throw InputError({.file = file_, .line = motion.line, .field = "parentIdRef"}, "the motions carry each other",
                     "a chain that begins with a Motion without parentIdRef");
  }

  /// From the base to a component that carries no other. @returns whether this is one
  bool state_chain(const DeviceMotion& last) {
    const auto is_carried = [&](const DeviceMotion& other) { return !last.id.empty() && other.parent == last.id; };
    if (std::any_of(motions_.begin(), motions_.end(), is_carried)) return false;
    std::string chain = last.component;
    std::size_t length = 1;
    for (const DeviceMotion* at = parent_of(last); at != nullptr; at = parent_of(*at)) {
      chain = at->component + ", " + chain;
      if (++length > motions_.size()) refuse_loop(last);
    }
    table_.facts.push_back({"chain", chain});
    return true;
  }

  const std::string& file_;
  XmlElement root_;
  InstrumentTable table_;
  std::vector<DeviceMotion> motions_;
  std::vector<std::string> axes_;
};

}  // namespace

std::optional<Recognition> recognise_mtconnect_devices(std::string_view text) {
  if (!begins_with_element(text, "MTConnectDevices")) return std::nullopt;
  return Recognition{"XML with the root MTConnectDevices"};
}

InstrumentTable read_mtconnect_devices(std::string_view text, const std::string& file, const ImportHints&) {
  return DevicesReader(text, file).read();
}

}  // namespace abbe
