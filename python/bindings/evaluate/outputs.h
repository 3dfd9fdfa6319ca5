#pragma once

// Members that give a result as the command gives it: JSON, a page, the files of a results folder.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/text/json_text.h"
#include "bindings/files.h"
#include "bindings/use/arguments.h"

namespace abbe::python {

using ResultFiles = std::vector<std::pair<std::string, std::string>>;  ///< names and contents

/// {name: bytes}
nb::dict files_by_name(const ResultFiles& files);
/// Writes them as a results folder. @throws FileExistsError of Python
void write_results_folder(const std::filesystem::path& folder, const ResultFiles& files, bool overwrite);

/// Adds json_text() and to_dict(). @param json  of a result
template <class Class, class Json>
void add_json(Class& bound, const Json& json) {
  using Result = typename Class::Type;
  bound
      .def(
          "json_text", [json](const Result& r) { return json_text(json(r)); }, "What the command prints with --json.")
      .def(
          "to_dict", [json](const Result& r) { return python_value(json(r)); },
          nb::sig("def to_dict(self) -> dict[str, typing.Any]"), "The same as a dictionary.");
}

/// Adds page_html() and write_page(). @param page  HTML of a result
template <class Class, class Page>
void add_page(Class& bound, const Page& page) {
  using Result = typename Class::Type;
  bound
      .def(
          "page_html", [page](const Result& r) { return page(r); }, "The page of the command, HTML.")
      .def(
          "write_page",
          [page](const Result& r, const std::filesystem::path& path, bool overwrite) {
            write_text(path, page(r), overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false, "Writes the page (*.html), whole or not at all.");
}

/// Adds files() and write(). @param files  ResultFiles of a result  @param write_words  docstring of write()
template <class Class, class Files>
void add_files(Class& bound, const Files& files, const char* write_words) {
  using Result = typename Class::Type;
  bound
      .def(
          "files", [files](const Result& r) { return files_by_name(files(r)); },
          nb::sig("def files(self) -> dict[str, bytes]"), "The files of the results folder: contents by name.")
      .def(
          "write",
          [files](const Result& r, const std::filesystem::path& folder, bool overwrite) {
            write_results_folder(folder, files(r), overwrite);
          },
          nb::arg("folder"), nb::arg("overwrite") = false, write_words);
}

}  // namespace abbe::python
