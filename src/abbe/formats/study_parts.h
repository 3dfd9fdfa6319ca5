#pragma once

// Internal to formats: the parts of a study file.
#include <filesystem>
#include <string>
#include <vector>

#include "abbe/formats/study.h"
#include "abbe/formats/toml_table.h"

namespace abbe {

Setup read_setup(TomlTable& table, const std::filesystem::path& folder, const Machine& machine, bool simulated);
IdentificationPlan read_identification(TomlTable& table, const std::filesystem::path& folder, const Machine& machine);

/// Table `axis` with one table per axis: `range` and `count`, or `at`. Axes that are not named stay fixed.
std::vector<AxisRange> read_axis_ranges(TomlTable& parent, const Machine& machine, bool with_counts);

/// `*` stands for any text, `?` for one character.
bool matches_pattern(std::string_view text, std::string_view pattern);

}  // namespace abbe
