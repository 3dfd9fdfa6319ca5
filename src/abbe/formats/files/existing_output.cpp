#include "abbe/formats/files/existing_output.h"

#include <atomic>
#include <mutex>
#include <system_error>

#include "abbe/formats/files/unfinished_output.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

struct OutputRule {
  std::atomic<bool> kept = false;      // a KeptOutputs lives
  std::atomic<bool> replaced = false;  // and replace_existing_outputs() was called
  std::mutex list;
  std::vector<std::string> complete;
};

/// Never destroyed: a signal may come while the process ends, and its handler tells which outputs are complete.
OutputRule& output_rule() {
  static auto* const one = new OutputRule;
  return *one;
}

}  // namespace

KeptOutputs::KeptOutputs() {
  const std::lock_guard<std::mutex> locked(output_rule().list);
  output_rule().complete.clear();
  output_rule().kept = true;
}

KeptOutputs::~KeptOutputs() {
  output_rule().kept = false;
  output_rule().replaced = false;
}

void replace_existing_outputs() { output_rule().replaced = true; }

bool existing_outputs_stay() { return output_rule().kept && !output_rule().replaced; }

void refuse_existing_output(const std::filesystem::path& name) {
  if (!existing_outputs_stay()) return;
  std::error_code error;
  // A link that leads nowhere is somebody's too.
  if (!std::filesystem::exists(std::filesystem::symlink_status(name, error))) return;
  throw InputError({.file = name.string()}, "the file exists", "another name, or --force to replace it");
}

void note_complete_output(const std::filesystem::path& name) {
  if (!output_rule().kept) return;
  const std::lock_guard<std::mutex> locked(output_rule().list);
  output_rule().complete.push_back(name.string());
}

std::vector<std::string> complete_outputs() {
  const std::lock_guard<std::mutex> locked(output_rule().list);
  return output_rule().complete;
}

void check_output_file(const std::filesystem::path& name) {
  const std::filesystem::path path = file_to_write(name);
  refuse_existing_output(name);
  check_folder_to_write_in(path.parent_path(), name);
}

}  // namespace abbe
