#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace abbe {

/// Progress of long work: a line on stderr that is redrawn, with the time left; nothing if stderr is no terminal or the
/// work takes less than a second.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  void operator()(std::size_t done, std::size_t total);
  std::function<void(std::size_t, std::size_t)> callback() {
    return [this](std::size_t done, std::size_t total) { (*this)(done, total); };
  }

 private:
  std::string what_;
  bool terminal_ = false;
  bool drawn_ = false;
  double start_ = 0, last_ = 0;
};

/// Progress of work in several steps, one line after the other.
class StepProgress {
 public:
  void show(const std::string& step, std::size_t done, std::size_t total) {
    if (step != step_) {
      progress_.emplace(step);
      step_ = step;
    }
    (*progress_)(done, total);
  }
  /// Removes the line.
  void end() { progress_.reset(); }

 private:
  std::string step_;
  std::optional<Progress> progress_;
};

}  // namespace abbe
