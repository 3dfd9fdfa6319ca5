#include "abbe/formats/files/results_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <optional>
#include <system_error>
#include <utility>

#include "abbe/formats/files/existing_output.h"
#include "abbe/formats/files/interruption.h"
#include "abbe/formats/files/kept_inputs.h"
#include "abbe/formats/files/remove_unfinished.h"
#include "abbe/formats/files/results_marker.h"
#include "abbe/formats/files/streamed_file.h"
#include "abbe/formats/files/text_on_disk.h"
#include "abbe/formats/files/unfinished_output.h"
#include "abbe/formats/files/write_error.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

/// @param called  what messages call it: its name when all is done
void write_and_flush(const fs::path& path, std::string_view contents, const fs::path& called) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (!file.is_open()) fail_to_write(called, errno);
  if (const int error = write_all(file.number(), contents)) fail_to_write(called, error);
  if (::fsync(file.number()) != 0) fail_to_write(called, errno);
  if (const int error = file.close()) fail_to_write(called, error);
}

/// Exchanges two names in one step where the file system can. @returns errno, 0 if done
int exchange(const fs::path& a, const fs::path& b) {
  return ::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0 ? 0 : errno;
}

bool is_empty_folder(const fs::path& folder) {
  std::error_code error;
  return fs::directory_iterator(folder, error) == fs::directory_iterator() && !error;
}

/// Older results that were taken out of the place of `newer`. @returns false if files of others had to stay with them
bool clear_away(const fs::path& older, const fs::path& newer) {
  if (!move_foreign_files(older, newer)) return false;
  remove_results(older);
  return true;
}

/// What killed writers of these results left behind.
void clear_abandoned(const fs::path& path) {
  for_abandoned(path, kOlder, [&](const fs::path& older) {
    if (rename_to_new(older, path) != 0) clear_away(older, path);
  });
  for_abandoned(path, kUnfinished, [&](const fs::path& unfinished) {
    std::error_code ignored;
    if (fs::exists(unfinished / kBeingWritten, ignored)) {
      remove_unfinished(unfinished);
    } else if (fs::is_directory(unfinished, ignored)) {
      clear_away(unfinished, path);
    }
  });
}

void check_folder(const fs::path& name, const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status)) throw InputError({name.string(), 0, 0, ""}, "is a file", "a folder for results");
  refuse_input_as_output(path);
  // Results replace a folder: what somebody else keeps there must not go with it.
  if (!ResultsMarker::read(path) && !is_empty_folder(path)) {
    throw InputError({name.string(), 0, 0, ""}, "holds files that are not results of abbe",
                     "a new or empty folder, or one with results, which are replaced");
  }
}

}  // namespace

void check_results_folder(const fs::path& name) {
  const fs::path path = resolved_output(name);
  check_folder(name, path);
  // The folders on its way are made with it.
  check_folder_to_write_in(existing_folder_above(path), name);
}

ResultsFolder::ResultsFolder(fs::path name) : name_(std::move(name)), path_(resolved_output(name_)) {
  if (name_.filename().empty()) name_ = name_.parent_path();
  check_folder(name_, path_);
  std::error_code error;
  fs::create_directories(path_.parent_path(), error);
  if (error) fail_to_write(name_, error.value());
  clear_abandoned(path_);
  unfinished_ = std::make_unique<UnfinishedOutput>(path_, UnfinishedOutput::Kind::folder, name_);
  write_and_flush(unfinished_->path() / kBeingWritten, "", name_);
}

ResultsFolder::~ResultsFolder() = default;

/// Where a new file of the folder is written; the folders on its way are made.
fs::path ResultsFolder::place_of(const fs::path& relative) {
  const fs::path plain = relative.lexically_normal(), called = name_ / plain;
  if (plain.empty() || plain.is_absolute() || *plain.begin() == ".." || plain.filename().empty()) {
    throw InputError({called.string(), 0, 0, ""}, "does not lie in the folder of the results", "a name within it");
  }
  if (!files_.insert(plain.generic_string()).second) {
    throw InputError({called.string(), 0, 0, ""}, "is written twice", "results with different names");
  }
  const fs::path path = unfinished_->path() / plain;
  std::error_code error;
  {
    const UninterruptedSteps steps;
    fs::create_directories(path.parent_path(), error);
  }
  if (error) fail_to_write(called.parent_path(), error.value());
  return path;
}

void ResultsFolder::write(const fs::path& relative, std::string_view contents) {
  write_and_flush(place_of(relative), contents, name_ / relative.lexically_normal());
}

void ResultsFolder::write(const fs::path& relative, TextOnDisk text) {
  text.put_at(place_of(relative), name_ / relative.lexically_normal());
}

void ResultsFolder::refuse_to_lose_files() const {
  check_folder(name_, path_);
  const std::optional<ResultsMarker> older = ResultsMarker::read(path_);
  if (!older) return;
  for (const std::string& file : files_) {
    // The file, and before it the folders on the way, of which none may be a link or a file.
    fs::path relative;
    for (const fs::path& part : fs::path(file)) {
      relative /= part;
      std::error_code error;
      const fs::file_status status = fs::symlink_status(path_ / relative, error);
      if (!fs::exists(status)) break;
      const bool is_file = relative == fs::path(file);
      if (is_file ? older->lists(file) : fs::is_directory(status)) continue;
      throw InputError({(name_ / relative).string(), 0, 0, ""}, "is no result of abbe and would be replaced",
                       "another name for it, or another folder for the results");
    }
  }
}

void ResultsFolder::commit() {
  const fs::path& unfinished = unfinished_->path();
  write_and_flush(unfinished / ResultsMarker::kName, ResultsMarker::text(files_), name_);
  std::error_code error;
  for (fs::recursive_directory_iterator entry(unfinished, error), end; !error && entry != end; entry.increment(error)) {
    if (!entry->is_directory()) continue;
    if (const int problem = flush_folder(entry->path())) fail_to_write(name_, problem);
  }
  if (error) fail_to_write(name_, error.value());
  const UninterruptedSteps steps;
  if (::unlink((unfinished / kBeingWritten).c_str()) != 0) fail_to_write(name_, errno);
  if (const int problem = flush_folder(unfinished)) fail_to_write(name_, problem);
  put_in_place();
  if (const int problem = flush_folder(path_.parent_path())) fail_to_write(name_, problem);
  note_complete_output(name_);
}

void ResultsFolder::put_in_place() {
  const fs::path unfinished = unfinished_->path();
  refuse_to_lose_files();
  int problem = rename_to_new(unfinished, path_);
  fs::path older;
  if (problem == EEXIST || problem == ENOTEMPTY) {
    problem = exchange(unfinished, path_);
    older = unfinished;
    if (problem == 0 && !ResultsMarker::read(older) && !is_empty_folder(older)) {
      // Somebody has put it there since it was looked at.
      if (exchange(unfinished, path_) != 0) {
        unfinished_->release();
        throw InputError({older.string(), 0, 0, ""},
                         "was in the place of " + name_.string() + " and could not be moved back",
                         "it to be moved by hand");
      }
      problem = EEXIST;
    }
  }
  if (problem == EINVAL || problem == ENOSYS) {
    older = name_beside(path_, kOlder);
    const Descriptor locked(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    if (locked.is_open()) ::flock(locked.number(), LOCK_EX);
    problem = ::rename(path_.c_str(), older.c_str()) == 0 ? 0 : errno;
    if (problem == 0 && ::rename(unfinished.c_str(), path_.c_str()) != 0) {
      problem = errno;
      ::rename(older.c_str(), path_.c_str());
    }
  }
  if (problem != 0) fail_to_write(name_, problem);
  unfinished_->release();
  if (!older.empty() && !clear_away(older, path_)) {
    throw InputError({older.string(), 0, 0, ""},
                     "holds files that are not results and could not be moved to " + name_.string(),
                     "them to be moved by hand");
  }
}

void write_result_files(const fs::path& folder, const std::vector<std::pair<std::string, std::string>>& files) {
  ResultsFolder results(folder);
  for (const auto& [name, contents] : files) results.write(name, contents);
  results.commit();
}

void write_file_atomically(const fs::path& name, std::string_view contents) {
  StreamedFile file(name);
  file.append(contents);
  file.commit();
}

}  // namespace abbe
