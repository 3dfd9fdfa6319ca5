#include "abbe/formats/files/streamed_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "abbe/formats/files/existing_output.h"
#include "abbe/formats/files/interruption.h"
#include "abbe/formats/files/kept_inputs.h"
#include "abbe/formats/files/unfinished_output.h"
#include "abbe/formats/files/write_error.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {

namespace fs = std::filesystem;

StreamedFile::StreamedFile(const fs::path& name) : name_(name), path_(file_to_write(name)) {
  refuse_input_as_output(path_);
  refuse_existing_output(name_);
  for_abandoned(path_, kUnfinished, [](const fs::path& abandoned) { ::unlink(abandoned.c_str()); });
  nameless_ = std::make_unique<Descriptor>(nameless_file(path_.parent_path()));
  if (nameless_->is_open()) return;
  nameless_.reset();
  unfinished_ = std::make_unique<UnfinishedOutput>(path_, UnfinishedOutput::Kind::file, name_);
}

StreamedFile::~StreamedFile() = default;

int StreamedFile::file() const { return nameless_ ? nameless_->number() : unfinished_->descriptor(); }

void StreamedFile::append(std::string_view contents) {
  if (const int error = write_all(file(), contents)) fail_to_write(name_, error);
}

void StreamedFile::overwrite(std::size_t offset, std::string_view contents) {
  while (!contents.empty()) {
    const ssize_t written = ::pwrite(file(), contents.data(), contents.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(name_, errno);
    contents.remove_prefix(static_cast<std::size_t>(written));
    offset += static_cast<std::size_t>(written);
  }
}

void StreamedFile::commit() {
  if (::fsync(file()) != 0) fail_to_write(name_, errno);
  const UninterruptedSteps steps;
  if (nameless_) {
    // A file without a name cannot take the place of another one: it gets a name first. Locked, so that it is nobody's
    // to remove as abandoned.
    lock_if_free(*nameless_);
    const fs::path beside = name_beside(path_, kUnfinished);
    if (const int error = give_name(*nameless_, beside)) fail_to_write(name_, error);
    try {
      put_in_place(beside);
    } catch (...) {
      ::unlink(beside.c_str());
      throw;
    }
  } else {
    put_in_place(unfinished_->path());
    unfinished_->release();
  }
}

void StreamedFile::put_in_place(const fs::path& from) {
  // The name may lead elsewhere than when it was resolved.
  refuse_input_as_output(path_);
  if (file_to_write(path_) != path_) {
    throw InputError({name_.string(), 0, 0, ""}, "has become a link since the command was started",
                     "the name of a file to write");
  }
  if (existing_outputs_stay()) {
    const int error = rename_to_new(from, path_);
    if (error == EEXIST) refuse_existing_output(name_);
    if (error != 0) fail_to_write(name_, error);
  } else if (::rename(from.c_str(), path_.c_str()) != 0) {
    fail_to_write(name_, errno);
  }
  if (const int error = flush_folder(path_.parent_path())) fail_to_write(name_, error);
  note_complete_output(name_);
}

}  // namespace abbe
