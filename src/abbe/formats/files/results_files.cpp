#include "abbe/formats/files/results_files.h"

#include <fmt/format.h>

#include <filesystem>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {

bool is_results_folder(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

void require_results(const std::string& results) {
  if (results.empty() || is_results_folder(results)) return;
  throw InputError({.file = results}, "is not a folder", "results of abbe run");
}

std::string file_or_of_results(const std::string& named, const std::string& results, const char* in_results,
                               const char* option) {
  if (!named.empty()) return named;
  if (results.empty()) {
    throw InputError({.field = option}, "is missing", "this option, or the results folder of abbe run");
  }
  return file_of_results(results, in_results, fmt::format("results of a simulated study, or {} with a file", option));
}

std::string file_of_results(const std::string& results, const char* in_results, const std::string& expected) {
  const std::filesystem::path path = std::filesystem::path(results) / in_results;
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return path.string();
  throw InputError({.file = path.string()}, "these results have no such file", expected);
}

std::string results_summary_text(const std::string& results) {
  if (results.empty()) return {};
  const std::filesystem::path path = std::filesystem::path(results) / "summary.json";
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored) ? read_text_file(path) : std::string();
}

}  // namespace abbe
