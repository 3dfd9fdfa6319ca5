#include "abbe/formats/files/mapped_inputs.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

/// Fixed in size and without a lock: read by the handler of a signal.
struct Place {
  std::atomic<bool> is_taken = false;
  std::atomic<std::uintptr_t> begin = 0, end = 0;  // end is 0 while the name is being written
  std::array<char, 1024> name{};
};
constexpr std::size_t kPlaces = 64;
std::array<Place, kPlaces> places;
std::atomic<int> exit_code_when_cut = 2;

void say(std::string_view text) {
  // What cannot be said is told by the exit code.
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
}

void end(int /*signal*/, siginfo_t* about, void* /*context*/) {
  const auto at = reinterpret_cast<std::uintptr_t>(about->si_addr);
  const auto found =
      std::find_if(places.begin(), places.end(), [&](const Place& p) { return at >= p.begin && at < p.end; });
  say("abbe: ");
  say(found != places.end() ? std::string_view(found->name.data()) : std::string_view("an input"));
  say(": was truncated while it was read; expected a file that does not change meanwhile\n");
  ::_exit(exit_code_when_cut);
}

}  // namespace

void end_where_an_input_was_cut_short(int exit_code) {
  exit_code_when_cut = exit_code;
  struct sigaction action {};
  action.sa_sigaction = end;
  action.sa_flags = SA_SIGINFO;
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGBUS, &action, nullptr);
}

MappedInput::MappedInput(const char* begin, std::size_t size, const std::string& name) : place_(kPlaces) {
  for (std::size_t i = 0; i < kPlaces && place_ == kPlaces; ++i) {
    if (!places[i].is_taken.exchange(true)) place_ = i;
  }
  if (place_ == kPlaces) return;
  Place& place = places[place_];
  const std::string shown = printable(name, place.name.size(), LineFeeds::escaped);
  const std::size_t length = std::min(shown.size(), place.name.size() - 1);
  std::memcpy(place.name.data(), shown.data(), length);
  place.name[length] = '\0';
  place.begin = reinterpret_cast<std::uintptr_t>(begin);
  place.end = place.begin + size;
}

MappedInput::~MappedInput() {
  if (place_ == kPlaces) return;
  places[place_].end = 0;
  places[place_].is_taken = false;
}

}  // namespace abbe
