#pragma once

#include <stdexcept>
#include <stop_token>

namespace abbe {

/// Long work was asked to stop (std::stop_token) and has stopped without a result.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("stopped on request") {}
};

/// @throws Stopped if that was asked for
inline void stop_if_asked(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Stopped();
}

}  // namespace abbe
