#include "bindings/files.h"

#include "abbe/formats/files/results_folder.h"

namespace abbe::python {

void refuse_existing(const std::filesystem::path& path, bool overwrite) {
  if (overwrite || !std::filesystem::exists(std::filesystem::symlink_status(path))) return;
  const std::string text = path.string() + " is there already; it is only replaced with overwrite=True";
  PyErr_SetString(PyExc_FileExistsError, text.c_str());
  throw nb::python_error();
}

void write_text(const std::filesystem::path& path, std::string_view text, bool overwrite) {
  refuse_existing(path, overwrite);
  write_file_atomically(path, text);
}

}  // namespace abbe::python
