#include "check_frozen.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "abbe/formats/files/standard_input.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/study/frozen_file.h"
#include "exit_code.h"

namespace abbe {

bool is_frozen_file(const std::string& file) {
  if (file == kStandardInput)
    return MappedFile(file).text().starts_with(
        "\x89"
        "ABBEC");
  return std::filesystem::path(file).extension() == ".abbec";
}

int check_frozen(const std::string& file, bool json) {
  const CheckedFrozenFile frozen = check_frozen_file(read_text_file(file), file);
  fmt::print("{}", json ? json_text(frozen_file_json(frozen)) : frozen_file_text(frozen));
  return kDone;
}

}  // namespace abbe
