#pragma once

// Internal to report: XML with an indent for every level.
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe {

/// Elements one after the other and in each other.
class XmlWriter {
 public:
  using Attributes = std::vector<std::pair<std::string, std::string>>;

  void open(const std::string& name, const Attributes& attributes = {});
  void close();
  /// An element with text.
  void element(const std::string& name, std::string_view text, const Attributes& attributes = {});
  /// The document, after everything is closed.
  std::string document() const;

 private:
  void begin(const std::string& name, const Attributes& attributes);

  std::string text_;
  std::vector<std::string> open_;
};

}  // namespace abbe
