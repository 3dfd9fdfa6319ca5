#pragma once

// Internal to formats: the only header that includes toml++.
#include <toml++/toml.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/input_error.h"

namespace abbe {

/// A parsed TOML file with its text, so that numbers can be read as they were written.
class TomlDocument {
 public:
  /// @throws InputError with toml++'s explanation and the place
  TomlDocument(std::string text, std::string file);

  const std::string& file() const { return file_; }
  const toml::table& root() const { return root_; }

  InputError::Place place(const toml::source_position& position, std::string field) const;
  /// The number as written at that place, without underscores; empty if it is no plain decimal number.
  std::string number_text(const toml::source_position& position) const;

 private:
  std::string file_;
  std::string text_;
  std::vector<std::size_t> line_starts_;
  toml::table root_;
};

}  // namespace abbe
