#include "abbe/formats/files/file_stamp.h"

#include <sys/stat.h>

#include "abbe/formats/files/standard_input.h"

namespace abbe {

FileStamp file_stamp(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path_to_open(path).c_str(), &status) != 0) return {};
  return {static_cast<std::uint64_t>(status.st_size), status.st_mtim.tv_sec, status.st_mtim.tv_nsec};
}

}  // namespace abbe
