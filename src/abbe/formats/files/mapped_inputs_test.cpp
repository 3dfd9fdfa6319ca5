#include "abbe/formats/files/mapped_inputs.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <memory>
#include <numeric>
#include <vector>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/files/text_file.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

int read_all(const MappedFile& file) {
  const std::string_view text = file.text();
  return std::accumulate(text.begin(), text.end(), 0);
}

TEST(MappedInputs, AFileThatIsCutShortIsNamedAndEndsTheProcess) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const fs::path name = test::empty_folder("abbe_cut") / "a.csv";
  const auto cut = [&] {
    std::ofstream(name) << std::string(100000, 'x');
    end_where_an_input_was_cut_short(2);
    const MappedFile file(name);
    if (::truncate(name.c_str(), 0) == 0) ::_exit(read_all(file) == 0 ? 8 : 9);
  };
  EXPECT_EXIT(cut(), testing::ExitedWithCode(2),
              "a.csv: was truncated while it was read; expected a file that does not change meanwhile");
}

TEST(MappedInputs, FilesBeyondThoseThatHaveANameAreReadToo) {
  const fs::path name = test::empty_folder("abbe_many") / "a.csv";
  std::ofstream(name) << "x";
  std::vector<std::unique_ptr<MappedFile>> files;
  for (int i = 0; i < 100; ++i) files.push_back(std::make_unique<MappedFile>(name));
  for (const auto& file : files) EXPECT_EQ(file->text(), "x");
}

}  // namespace
}  // namespace abbe
