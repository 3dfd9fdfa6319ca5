#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "abbe/formats/text/named_columns.h"
#include "abbe/identify/linkage/linkage_steps.h"

namespace abbe {

/// Reads a CSV of the five steps by which a laser engraver measures its linkage; columns and signs in
/// docs/linkage-steps.md. Exit to axis, board thickness and convention are not in the file and stay as they are by
/// default.
/// @param mapping  of a file whose columns have other names
/// @throws InputError naming file, line, column and unit for what is missing, twice there or in the wrong place
LinkageReadings read_linkage(const std::filesystem::path& path, const ColumnMapping& mapping = {});
/// The same from text. @param file  name for messages
LinkageReadings parse_linkage(std::string_view text, const std::string& file, const ColumnMapping& mapping = {});
/// The same from columns in memory, named with their units as in a file. @throws InputError
LinkageReadings parse_linkage(const NamedColumns& columns);

/// Text of such a file, exact.
std::string linkage_text(const LinkageReadings& readings);

}  // namespace abbe
