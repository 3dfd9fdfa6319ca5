#include "abbe/formats/text/file_unit.h"

#include <fmt/format.h>

#include <array>
#include <cassert>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr std::array kFileLengths = {FileLength::millimetre, FileLength::metre, FileLength::inch};

}  // namespace

std::string_view file_length_name(FileLength length) {
  switch (length) {
    case FileLength::millimetre:
      return "mm";
    case FileLength::metre:
      return "m";
    case FileLength::inch:
      return "inch";
  }
  assert(false);
  return "";
}

std::optional<FileLength> file_length_named(std::string_view name) {
  for (const FileLength length : kFileLengths) {
    if (name == file_length_name(length)) return length;
  }
  return std::nullopt;
}

std::vector<std::string> file_length_names() {
  std::vector<std::string> names;
  for (const FileLength length : kFileLengths) names.emplace_back(file_length_name(length));
  return names;
}

double millimetres(FileLength length) {
  return length == FileLength::millimetre ? 1 : length == FileLength::metre ? 1000 : 25.4;
}

FileUnit agreed_unit(const std::optional<FileLength>& stated, const std::optional<FileLength>& given,
                     const std::string& file) {
  if (stated && given && *stated != *given) {
    throw InputError(
        {file, 0, 0, "unit"},
        fmt::format("the file states {}, but {} was given", file_length_name(*stated), file_length_name(*given)),
        "the unit of the file, or none");
  }
  if (stated) return {*stated, UnitSource::stated};
  if (given) return {*given, UnitSource::given};
  return {};
}

std::string unit_words(const FileUnit& unit) {
  const std::string_view name = file_length_name(unit.length);
  switch (unit.source) {
    case UnitSource::stated:
      return fmt::format("{} (stated by the file)", name);
    case UnitSource::given:
      return fmt::format("{} (as given)", name);
    case UnitSource::assumed:
      return fmt::format("{} (assumed: the file states no unit)", name);
  }
  assert(false);
  return "";
}

}  // namespace abbe
