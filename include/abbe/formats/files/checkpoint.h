#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe {

class Descriptor;

/// What a checkpoint belongs to: names and values of everything on which the results depend ("scan, bytes", "1200"), in
/// lines without line ends.
using CheckpointFacts = std::vector<std::pair<std::string, std::string>>;

/// The state of a long job, in a file beside its output: OUTPUT.unfinished. After the process was killed, the same job
/// goes on from there.
///
/// A lock (flock) on the file says that a job works on the output; a second one is refused. Every state is written
/// whole, or the one before stays. The file stays when the object goes, if a state was saved; remove() ends that.
class Checkpoint {
 public:
  /// Finds the state that a job with the same facts has left behind, and locks the output.
  /// @param output  file or folder that the job will write; folders on its way are made
  /// @throws InputError if another process works on it, if the state is one of other facts or is damaged, and if the
  ///   file cannot be written
  Checkpoint(const std::filesystem::path& output, CheckpointFacts facts);
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  /// What was found; empty: nothing.
  const std::string& found() const { return found_; }
  /// @throws InputError if it cannot be written whole; the state before is then still there
  void save(std::string_view state);
  /// The job is done.
  void remove();

 private:
  void open_and_lock();
  void read_state();
  std::string header() const;

  std::filesystem::path called_, path_;
  CheckpointFacts facts_;
  std::unique_ptr<Descriptor> held_;
  std::string found_;
  bool has_state_ = false;
};

}  // namespace abbe
