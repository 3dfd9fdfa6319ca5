#pragma once

#include <Standard_Failure.hxx>
#include <stdexcept>
#include <string>

namespace abbe {

/// Begins the problem of a face that has no triangles.
constexpr const char* kNotDivided = "could not be divided into triangles: ";
/// How it goes on where nothing else is known.
constexpr const char* kNoneFound = "OpenCASCADE finds none";

/// What an exception of OpenCASCADE says, which in version 7.6 is no std::exception.
inline std::string failure_words(const Standard_Failure& failure) {
  const char* const words = failure.GetMessageString();
  return words != nullptr && *words != '\0' ? words : failure.DynamicType()->Name();
}

/// What went wrong in some work with the shape; empty if nothing did. Other exceptions, such as TimeIsUp, pass.
template <typename Work>
std::string problem_of(const Work& work) try {
  work();
  return "";
} catch (const std::runtime_error& error) {
  return error.what();
} catch (const Standard_Failure& failure) {
  return failure_words(failure);
}

}  // namespace abbe
