#pragma once

// For tests: a locale of the system with a decimal comma.
#include <gtest/gtest.h>
#include <unistd.h>

#include <clocale>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace abbe::test {

/// Of this process alone: tests run at the same time.
inline std::filesystem::path locale_folder() {
  return std::filesystem::path(testing::TempDir()) / ("abbe_locale_" + std::to_string(::getpid()));
}

/// Compiles a locale of its own with a decimal comma, so that the test does not depend on what is installed, and sets
/// it.
/// @returns false if there is none
inline bool set_decimal_comma() {
  const std::filesystem::path folder = locale_folder();
  std::filesystem::create_directories(folder);
  std::ofstream source(folder / "comma.src");
  source << "escape_char /\nLC_NUMERIC\ndecimal_point \",\"\nthousands_sep \".\"\ngrouping 3;3\nEND LC_NUMERIC\n";
  for (const char* category : {"LC_CTYPE", "LC_COLLATE", "LC_MONETARY", "LC_TIME", "LC_MESSAGES"}) {
    source << category << "\ncopy \"POSIX\"\nEND " << category << "\n";
  }
  source.close();
  const std::string command = "cd '" + folder.string() +
                              "' && localedef -c --no-archive -i ./comma.src -f ANSI_X3.4-1968 ./comma "
                              ">/dev/null 2>&1";
  static_cast<void>(std::system(command.c_str()));  // missing categories are a warning with an exit code
  ::setenv("LOCPATH", folder.c_str(), 1);
  if (std::setlocale(LC_ALL, "comma") != nullptr) return true;
  ::unsetenv("LOCPATH");
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "nl_NL.UTF-8"}) {
    if (std::setlocale(LC_ALL, name) != nullptr) return true;
  }
  return false;
}

inline void unset_decimal_comma() {
  std::setlocale(LC_ALL, "C");
  ::unsetenv("LOCPATH");
  std::filesystem::remove_all(locale_folder());
}

}  // namespace abbe::test
