#include "abbe/formats/files/kept_inputs.h"

#include <gtest/gtest.h>

#include <fstream>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/files/streamed_file.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

class KeptInputsTest : public testing::Test {
 protected:
  KeptInputsTest() {
    fs::remove_all(folder);
    fs::create_directories(folder / "in");
    std::ofstream(input) << "what was read";
    std::ofstream(folder / "in" / "other.txt") << "not read";
  }
  static void write(const fs::path& output) { write_file_atomically(output, "new"); }
  static std::string refusal(const fs::path& output) {
    return message_of([&] { write(output); });
  }

  const fs::path folder = fs::path(testing::TempDir()) /
                          ("kept_inputs_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  const fs::path input = folder / "in" / "errors.toml";
};

TEST_F(KeptInputsTest, AFileThatWasReadIsNotWrittenOverByAnyOfItsNames) {
  const KeptInputs kept;
  read_text_file(input);
  fs::create_symlink(input, folder / "link");
  fs::create_hard_link(input, folder / "second-name");
  fs::create_directory_symlink(folder / "in", folder / "in-too");
  for (const fs::path& name : {input, folder / "in" / "." / "errors.toml", folder / "in" / ".." / "in" / "errors.toml",
                               folder / "link", folder / "second-name", folder / "in-too" / "errors.toml"}) {
    EXPECT_NE(refusal(name).find("is an input of the command"), std::string::npos) << name;
    EXPECT_THROW(StreamedFile{name}, InputError) << name;
  }
  EXPECT_EQ(read_text_file(input), "what was read");
  EXPECT_NO_THROW(write(folder / "in" / "other.txt"));
  EXPECT_NO_THROW(write(folder / "in" / "new.txt"));
}

TEST_F(KeptInputsTest, AFolderWithAnInputIsNotReplaced) {
  fs::remove(folder / "in" / "other.txt");
  std::ofstream(folder / "in" / ".abbe-results") << "an older result";
  fs::create_directory_symlink(folder / "in", folder / "in-too");
  {
    const KeptInputs kept;
    read_text_file(input);
    for (const fs::path& name : {folder / "in", folder / "in-too", folder / "in" / ""}) {
      const std::string message = message_of([&] { ResultsFolder{name}; });
      EXPECT_NE(message.find("errors.toml lies in it"), std::string::npos) << name << ": " << message;
    }
    // A name that only begins alike is another folder.
    ResultsFolder(folder / "i").commit();
  }
  EXPECT_EQ(read_text_file(input), "what was read");
}

TEST_F(KeptInputsTest, OutsideItsLifeWhatWasReadMayBeWritten) {
  read_text_file(input);
  EXPECT_NO_THROW(write(input));
  {
    const KeptInputs kept;
    // What was read before does not count.
    EXPECT_NO_THROW(write(input));
    read_text_file(input);
    EXPECT_THROW(write(input), InputError);
  }
  EXPECT_NO_THROW(write(input));
  EXPECT_EQ(read_text_file(input), "new");
}

}  // namespace
}  // namespace abbe
