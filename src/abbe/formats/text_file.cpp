#include "abbe/formats/text_file.h"

#include <fstream>
#include <system_error>

#include "abbe/formats/input_error.h"

namespace abbe {

std::string read_text_file(const std::filesystem::path& path) {
  const InputError::Place place{path.string(), 0, 0, ""};
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw InputError(place, "there is no such file");
  if (!std::filesystem::is_regular_file(status)) throw InputError(place, "is not a regular file");
  const auto size = std::filesystem::file_size(path, error);
  if (error) throw InputError(place, "cannot be read: " + error.message());
  if (size == 0) throw InputError(place, "the file is empty");
  std::string text(size, '\0');
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(text.data(), static_cast<std::streamsize>(size))) {
    throw InputError(place, "cannot be read: " + std::generic_category().message(errno));
  }
  return text;
}

}  // namespace abbe
