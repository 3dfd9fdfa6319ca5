#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "abbe/formats/study/study.h"

namespace abbe {

/// Study from a `*.study.toml` file and the machine file it names; everything is checked against the machine. @throws
/// InputError
Study read_study(const std::filesystem::path& path);

/// Where readings come from that are not simulated.
enum class ReadingsSource {
  files,       ///< every set-up names its files
  given_later  ///< set-ups may have none; SetupData::readings is set afterwards
};

/// The same from text for a given machine. @param path  name for messages; its folder resolves relative paths
Study parse_study(const std::string& text, const std::filesystem::path& path, const Machine& machine,
                  ReadingsSource source = ReadingsSource::files);

/// Patterns over names: `*` stands for any text, `?` for one character.
bool matches_pattern(std::string_view text, std::string_view pattern);

}  // namespace abbe
