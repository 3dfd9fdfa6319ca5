#include "abbe/formats/evaluations/section_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "abbe/formats/import/readable_table.h"
#include "abbe/formats/text/placed_table.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

enum SectionColumn { kSection, kAcross, kHeight, kAlong, kBeamTilt };

const std::vector<CsvColumn>& section_columns() {
  static const std::vector<CsvColumn> wanted = {{"section", Quantity::dimensionless, true},
                                                {"across", Quantity::length},
                                                {"height", Quantity::length},
                                                {"along", Quantity::length, false, false},
                                                {"beam_tilt", Quantity::angle, false, false}};
  return wanted;
}

/// What a whole section has in common: the first row says it, the others repeat it.
void enter_common(const PlacedTable& csv, const CsvValues& column, std::size_t row, const std::string& section,
                  std::optional<double>& value) {
  if (!column.present) return;
  const double here = column.numbers[row];
  if (value && *value != here) {
    throw InputError(csv.place(row, column.header),
                     "not that of the rows of section '" + section.substr(0, 40) + "' before",
                     "the same on all rows of a section");
  }
  value = here;
}

std::vector<SectionReadings> sections_of(const PlacedTable& csv) {
  const CsvValues& names = csv.columns[kSection];
  std::vector<SectionReadings> sections(names.names.size());
  std::vector<Eigen::Index> count(sections.size(), 0);
  for (const std::uint32_t word : names.words) ++count[word];
  for (std::size_t s = 0; s < sections.size(); ++s) {
    sections[s].name = names.names[s];
    sections[s].points.resize(2, count[s]);
    count[s] = 0;
  }
  for (std::size_t row = 0; row < csv.rows; ++row) {
    const std::size_t s = names.words[row];
    SectionReadings& section = sections[s];
    section.points.col(count[s]++) << csv.columns[kAcross].numbers[row], csv.columns[kHeight].numbers[row];
    enter_common(csv, csv.columns[kAlong], row, section.name, section.along);
    enter_common(csv, csv.columns[kBeamTilt], row, section.name, section.beam_tilt);
  }
  return sections;
}

}  // namespace

std::vector<SectionReadings> read_sections(const std::filesystem::path& path, const ColumnMapping& mapping) {
  return read_readable_table(path, section_columns(), mapping,
                             [&](std::string_view text) { return parse_sections(text, path.string(), mapping); });
}

std::vector<SectionReadings> parse_sections(std::string_view text, const std::string& file,
                                            const ColumnMapping& mapping) {
  return sections_of({text, file, section_columns(), mapping});
}

std::vector<SectionReadings> parse_sections(const NamedColumns& columns) {
  return sections_of({columns, section_columns()});
}

std::string sections_csv(const std::vector<SectionReadings>& sections) {
  // A column is there for all sections or for none: an empty field would be read as an error, and zero is a value.
  const auto column = [&](std::optional<double> SectionReadings::*value, const char* name) {
    const auto stated =
        static_cast<std::size_t>(std::count_if(sections.begin(), sections.end(), [&](const SectionReadings& section) {
          return (section.*value).has_value();
        }));
    if (stated != 0 && stated != sections.size()) {
      throw std::invalid_argument(fmt::format("{} of {} sections state their {}", stated, sections.size(), name));
    }
    return stated != 0;
  };
  const bool along = column(&SectionReadings::along, "place along the curve");
  const bool tilt = column(&SectionReadings::beam_tilt, "beam's tilt");
  std::string text =
      std::string("section,across_mm,height_mm") + (along ? ",along_mm" : "") + (tilt ? ",beam_tilt_deg" : "") + "\n";
  for (const SectionReadings& section : sections) {
    std::string common;
    if (along) common += fmt::format(",{:.6f}", *section.along);
    if (tilt) common += fmt::format(",{:.9f}", *section.beam_tilt / kDegree);
    for (Eigen::Index i = 0; i < section.points.cols(); ++i) {
      fmt::format_to(std::back_inserter(text), "{},{:.6f},{:.6f}{}\n", csv_field(section.name), section.points(0, i),
                     section.points(1, i), common);
    }
  }
  return text;
}

}  // namespace abbe
