#pragma once

#include <Message_ProgressIndicator.hxx>
#include <chrono>

namespace abbe {

/// A moment after which work is given up; also tells OpenCASCADE to stop, which it looks at while it inserts points
/// into a face, but neither while it reads a file nor while it divides edges.
class TimeLimit : public Message_ProgressIndicator {
 public:
  using Clock = std::chrono::steady_clock;

  static Clock::time_point after(double seconds) {
    return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }
  explicit TimeLimit(Clock::time_point end) : end_(end) {}

  bool is_over() const { return Clock::now() > end_; }
  Clock::time_point end() const { return end_; }

 protected:
  Standard_Boolean UserBreak() override { return is_over() ? Standard_True : Standard_False; }
  void Show(const Message_ProgressScope& /*scope*/, const Standard_Boolean /*force*/) override {}

 private:
  Clock::time_point end_;
};

/// Thrown where the time was up. What was done so far does not count.
struct TimeIsUp {};

}  // namespace abbe
