#pragma once

#include <fstream>
#include <iterator>
#include <string>

namespace abbe::test {

inline std::string text_of_source(const std::string& name) {
  std::ifstream stream(ABBE_SOURCE_DIR "/" + name);
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

/// A program of tests/install/consumer as it stands in a header, in comments.
inline std::string consumer_as_comment(const std::string& name) {
  const std::string consumer = text_of_source("tests/install/consumer/" + name);
  std::string commented;
  for (std::size_t begin = 0; begin < consumer.size();) {
    const std::size_t end = consumer.find('\n', begin);
    const std::string line = consumer.substr(begin, end - begin);
    commented += line.empty() ? "//\n" : "//   " + line + "\n";
    begin = end + 1;
  }
  return commented;
}

}  // namespace abbe::test
