#include "abbe/study/shared_work.h"

#include "abbe/formats/files/work_checkpoint.h"
#include "abbe/report/version.h"

namespace abbe {
SharedWork::SharedWork(ProcessGroup* processes, const std::string& output,
                       std::function<void(const std::string& sentence)> tell)
    : processes_(processes) {
  if (!is_first() || !WorkCheckpoint::fits(output)) return;
  checkpoint_ =
      std::make_unique<WorkCheckpoint>(output, CheckpointOptions{.version = version_text(), .tell = std::move(tell)});
}

SharedWork::~SharedWork() = default;

Summation SharedWork::summation() const { return processes_ == nullptr ? Summation() : processes_->summation(); }

WorkDriver SharedWork::driver() const {
  WorkDriver inner;
  if (processes_ != nullptr) inner = [processes = processes_](const NumberedWork& work) { processes->work(work); };
  if (!checkpoint_) return inner;
  return [checkpoint = checkpoint_.get(), inner](const NumberedWork& work) { checkpoint->work(work, inner); };
}

JobOptions SharedWork::job(std::function<void(std::size_t done, std::size_t total)> progress) const {
  JobOptions options{.progress = std::move(progress), .work = driver()};
  if (processes_ != nullptr) options.in_step = processes_->in_step();
  return options;
}

void SharedWork::done() {
  if (checkpoint_) checkpoint_->remove();
}

}  // namespace abbe
