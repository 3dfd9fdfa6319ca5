#pragma once

// For tests: the message of the InputError that an action must throw.
#include <gtest/gtest.h>

#include <string>

#include "abbe/formats/text/input_error.h"

namespace abbe {

template <typename Action>
std::string message_of(Action&& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError was thrown";
  return "";
}

}  // namespace abbe
