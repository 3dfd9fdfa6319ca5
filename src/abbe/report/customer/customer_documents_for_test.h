#pragma once

// For tests of documents for programs (certificates, QIF): facts, and elements of the XML that is written.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "abbe/formats/study/report_facts.h"
#include "abbe/formats/text/xml_tree.h"

namespace abbe {

/// What the schema of certificates requires, a temperature and a remark; without instruments.
inline ReportFacts facts_for_test() {
  ReportFacts facts;
  facts.number = "2026-117";
  facts.customer = "Example & Sons <Tooling>";
  facts.customer_address = "1 Sample Street";
  facts.maker = "Sample Machines";
  facts.model = "SM 1000";
  facts.serial_number = "SM-0417";
  facts.operator_name = "A. Tester";
  facts.date = std::chrono::year{2026} / 11 / 28;
  facts.temperature = 20.3;
  facts.laboratory = "Sample Laboratory";
  facts.laboratory_address = "2 Sample Street";
  facts.laboratory_country = "DE";
  facts.remarks = {"Axis X."};
  return facts;
}

/// The root of a document; names without their namespaces.
inline XmlElement parsed_document(const std::string& text) {
  const XmlTree tree = parse_xml(text, local_xml_name);
  EXPECT_FALSE(tree.problem) << tree.problem->words;
  return tree.root;
}

/// Calls for an element and for all that are in it, in the order of the document.
inline void for_each_element(const XmlElement& element, const std::function<void(const XmlElement&)>& call) {
  call(element);
  for (const XmlElement& child : element.children) for_each_element(child, call);
}

inline std::vector<const XmlElement*> all_elements(const XmlElement& root, const std::string& name) {
  std::vector<const XmlElement*> found;
  for_each_element(root, [&](const XmlElement& element) {
    if (element.name == name) found.push_back(&element);
  });
  return found;
}

inline std::vector<std::string> child_names(const XmlElement& element) {
  std::vector<std::string> names;
  for (const XmlElement& child : element.children) names.push_back(child.name);
  return names;
}

}  // namespace abbe
