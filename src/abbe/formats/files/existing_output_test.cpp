#include "abbe/formats/files/existing_output.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/files/streamed_file.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

std::size_t entries_of(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(ExistingOutput, StaysUnlessItsReplacementWasAskedFor) {
  const fs::path folder = test::empty_folder("existing_output"), file = folder / "map.csv";
  write_file_atomically(file, "mine");
  {
    const KeptOutputs kept;
    EXPECT_NE(
        message_of([&] { write_file_atomically(file, "new"); }).find("the file exists; expected another name, or"),
        std::string::npos);
    EXPECT_THROW(check_output_file(file), InputError);
    EXPECT_EQ(read_text_file(file), "mine");
    EXPECT_NO_THROW(write_file_atomically(folder / "other.csv", "new"));
    replace_existing_outputs();
    EXPECT_NO_THROW(check_output_file(file));
    EXPECT_NO_THROW(write_file_atomically(file, "new"));
  }
  EXPECT_EQ(read_text_file(file), "new");
  // The library without a command replaces.
  EXPECT_NO_THROW(write_file_atomically(file, "newer"));
}

TEST(ExistingOutput, OfSomebodyElseMeanwhileStays) {
  const fs::path folder = test::empty_folder("existing_output_meanwhile"), file = folder / "map.csv";
  const KeptOutputs kept;
  {
    StreamedFile stream(file);
    stream.append("new");
    std::ofstream(file) << "of somebody";
    EXPECT_NE(message_of([&] { stream.commit(); }).find("the file exists"), std::string::npos);
  }
  EXPECT_EQ(read_text_file(file), "of somebody");
  EXPECT_EQ(entries_of(folder), 1U) << "something is left behind";
}

TEST(ExistingOutput, ThatIsCompleteIsKnownUntilAnotherCommandBegins) {
  const fs::path folder = test::empty_folder("existing_output_complete"), file = folder / "map.csv";
  {
    const KeptOutputs kept;
    EXPECT_TRUE(complete_outputs().empty());
    write_file_atomically(file, "new");
  }
  // The process may be interrupted while it ends.
  EXPECT_EQ(complete_outputs(), std::vector<std::string>{file.string()});
  write_file_atomically(file, "newer");
  EXPECT_EQ(complete_outputs().size(), 1U);
  const KeptOutputs other;
  EXPECT_TRUE(complete_outputs().empty());
}

}  // namespace
}  // namespace abbe
