// Tables of other programs and files of instruments: any bytes give a table or an InputError. The mapping that was
// proposed gives the same bytes again, and readers of Abbe take them (import_table() reads them back itself).
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/input_error.h"
#include "abbe/study/imports/imported_file.h"
#include "fuzz_machine_data.h"

namespace {

/// What an input says before the bytes of its table.
struct Choice {
  std::uint8_t known = 0;  ///< the first byte: what is known of the table
  std::uint8_t form = 0;   ///< the second one where the first does not say the form
  std::size_t bytes = 1;
};

constexpr unsigned kByContents = 2, kSecondByte = 7;  // of the three highest bits

Choice choice_of(const std::uint8_t* data, std::size_t size) {
  Choice choice{data[0]};
  if (data[0] >> 5U == kSecondByte && size > 1) {
    choice.form = data[1];
    choice.bytes = 2;
  }
  return choice;
}

abbe::ImportRequest request_of(const Choice& asked) {
  const std::uint8_t choice = asked.known;
  abbe::ImportRequest request;
  request.file = "fuzz.txt";
  request.threads = 1;
  if ((choice & 1U) != 0) request.machine = fuzz_machine();
  if ((choice & 2U) != 0) request.kind = abbe::ImportKind::points;
  if ((choice & 4U) != 0) request.hints.layout.decimal = abbe::DecimalMark::comma;
  if ((choice & 8U) != 0) request.hints.length_unit = "inch";
  if ((choice & 16U) != 0) request.hints.angle_unit = "gon";
  const unsigned form = choice >> 5U;
  const std::vector<std::string> names = abbe::import_format_names();
  if (form == kSecondByte) {
    request.format = names[asked.form % names.size()];
  } else if (form != kByContents) {
    request.format = names[form < kByContents ? form : form - 1];
  }
  return request;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Choice choice = choice_of(data, size);
  const std::string_view bytes(reinterpret_cast<const char*>(data) + choice.bytes, size - choice.bytes);
  abbe::ImportRequest request = request_of(choice);
  std::optional<abbe::ImportedTable> found;
  try {
    abbe::ForeignTextOptions options;
    options.largest_unpacked = std::size_t{1} << 16;
    request.text = abbe::decode_foreign_text(bytes, request.file, options);
    found = abbe::import_table(request);
  } catch (const abbe::InputError&) {
  }
  if (found) {
    if (abbe::imported_table_text(*found).empty()) std::abort();
    request.kind.reset();
    request.format.clear();
  }
  if (found && found->has_readings()) {
    try {
      request.mapping = abbe::parse_import_mapping(abbe::imported_mapping_text(*found), "fuzz.import.toml");
      if (abbe::import_table(request).rows.csv != found->rows.csv) std::abort();
    } catch (const abbe::InputError&) {
      std::abort();
    }
  }
  try {
    request.mapping = abbe::parse_import_mapping(std::string(bytes), "fuzz.import.toml");
  } catch (const abbe::InputError&) {
  }
  return 0;
}
