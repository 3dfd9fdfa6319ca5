#pragma once

#include <functional>
#include <memory>
#include <string>

#include "abbe/study/job_options.h"
#include "abbe/study/process_group.h"

namespace abbe {

class WorkCheckpoint;

/// Who does the work of a command: this process or several, with finished blocks of long work kept beside the output
/// until it is whole (docs/scale.md).
class SharedWork {
 public:
  /// @param processes  null: this one is alone; must outlive the work
  /// @param output     file or folder that the command writes; empty, a device, a pipe: no blocks are kept
  /// @param tell       gets what the user has to know
  SharedWork(ProcessGroup* processes, const std::string& output, std::function<void(const std::string& sentence)> tell);
  ~SharedWork();
  SharedWork(const SharedWork&) = delete;
  SharedWork& operator=(const SharedWork&) = delete;

  /// False for all other processes: they write nothing, and end when the first one does.
  bool is_first() const { return processes_ == nullptr || processes_->is_first(); }
  /// As RunOptions::summation; empty where there is one process.
  Summation summation() const;
  /// As RunOptions::work. Not to be used after this object has ended.
  WorkDriver driver() const;
  /// Options of a job that shares its numbered work and its work in step. Not to be used after this object has ended.
  JobOptions job(std::function<void(std::size_t done, std::size_t total)> progress) const;
  /// Call when the output is complete: removes the kept blocks.
  void done();

 private:
  ProcessGroup* processes_;
  std::unique_ptr<WorkCheckpoint> checkpoint_;
};

}  // namespace abbe
