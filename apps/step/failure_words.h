#pragma once

#include <Standard_Failure.hxx>
#include <string>

namespace abbe {

/// What an exception of OpenCASCADE says, which in version 7.6 is no std::exception.
inline std::string failure_words(const Standard_Failure& failure) {
  const char* const words = failure.GetMessageString();
  return words != nullptr && *words != '\0' ? words : failure.DynamicType()->Name();
}

}  // namespace abbe
