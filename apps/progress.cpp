#include "progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <utility>

#include "messages.h"

namespace abbe {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

Progress::Progress(std::string what)
    : what_(std::move(what)), terminal_(!is_quiet() && isatty(STDERR_FILENO) == 1), start_(now()) {}

Progress::~Progress() {
  if (drawn_) draw("\r\x1b[K");
}

void Progress::operator()(std::size_t done, std::size_t total) {
  if (!terminal_ || total == 0) return;
  const double time = now();
  if (time - start_ < 1 || time - last_ < 0.1) return;
  last_ = time;
  drawn_ = true;
  const double share = static_cast<double>(done) / static_cast<double>(total);
  // Before anything is done nobody knows how long it takes.
  const std::string left = share > 0 ? fmt::format("  {:.0f} s left", (time - start_) * (1 - share) / share) : "";
  draw(fmt::format("\r\x1b[K{}  {:3.0f} %{}", what_, 100 * share, left));
}

}  // namespace abbe
