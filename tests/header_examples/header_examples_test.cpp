// The examples with which headers begin (write_examples.py) print what the headers say.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/runtime/freeze.h"

namespace abbe::test {
namespace {

/// A folder of that name with what examples find where they run: examples/ as they are in the sources, and what
/// `abbe compensate freeze` makes of a mill.
std::filesystem::path folder_for_example(const std::string& name) {
  const std::filesystem::path source = ABBE_SOURCE_DIR, folder = empty_folder(name.c_str());
  std::filesystem::create_directory_symlink(source / "examples", folder / "examples");
  const Machine mill = read_machine(source / "examples/machines/three-axis-mill.machine.toml");
  const ErrorsFile errors = read_errors(source / "examples/compensate/mill.errors.toml", mill);
  FreezeOptions options;
  options.poses = 100;
  options.covariance = covariance_of(errors);
  const FrozenCompensation frozen = freeze(mill, errors.errors, options);
  std::ofstream(folder / "mill.abbec", std::ios::binary)
      .write(reinterpret_cast<const char*>(frozen.bytes.data()), static_cast<std::streamsize>(frozen.bytes.size()));
  return folder;
}

/// What a program of one function prints where it finds its files; its exit code is checked.
std::string printed_by(int (*example)(), const std::string& name) {
  const std::filesystem::path folder = folder_for_example("abbe_example_" + name);
  const std::filesystem::path here = std::filesystem::current_path();
  std::filesystem::current_path(folder);
  testing::internal::CaptureStdout();
  EXPECT_EQ(example(), 0);
  std::fflush(stdout);
  std::filesystem::current_path(here);
  return testing::internal::GetCapturedStdout();
}

}  // namespace

#define EXAMPLE(name, prints)      \
  extern "C" int example_##name(); \
  TEST(HeaderExample, name) { EXPECT_EQ(printed_by(example_##name, #name), prints); }
#include "examples.inc"
#undef EXAMPLE

}  // namespace abbe::test
