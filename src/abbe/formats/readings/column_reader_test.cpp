#include "abbe/formats/readings/column_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "abbe/formats/readings/column_file.h"
#include "abbe/formats/text/column_block_for_test.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

/// A script in place of Python, which says what a test wants. python/tests/test_column_files.py has the real one.
class ColumnReaderProcess : public testing::Test {
 protected:
  ColumnReaderProcess() {
    folder_ = std::filesystem::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::create_directories(folder_);
  }
  ~ColumnReaderProcess() override {
    ::unsetenv(kColumnsPython);
    std::filesystem::remove_all(folder_);
  }

  void answer(const std::string& commands) const {
    const std::filesystem::path script = folder_ / "python";
    std::ofstream(script) << "#!/bin/sh\n[ \"$1\" = -c ] || exit 9\n" << commands << "\n";
    std::filesystem::permissions(script, std::filesystem::perms::owner_all);
    ::setenv(kColumnsPython, script.c_str(), 1);
  }
  static std::string refusal() {
    return message_of([] { ColumnReader({"r.parquet"}).columns(0); });
  }

  std::filesystem::path folder_;
};

TEST_F(ColumnReaderProcess, IsAskedForColumnsAndRowsOfFilesByNumber) {
  answer("while read line; do printf 'ok %d\\n%s' ${#line} \"$line\"; done");
  ColumnReader reader({"a.parquet", "b.arrow"});
  EXPECT_EQ(reader.columns(1), "open 1");
  EXPECT_EQ(reader.rows(0, 4096, 8192, {0, 2, 3}), "rows 0 4096 8192 0,2,3");
  answer("read line; printf 'ok %d\\n%s' ${#5} \"$5\"");  // -c, the text, two files and then this one
  EXPECT_EQ(ColumnReader({"a", "b", "c d\n.parquet"}).columns(2), "c d\n.parquet");
}

TEST_F(ColumnReaderProcess, SaysWhatIsWrongWithTheFile) {
  answer("read line; printf 'refused 13\\ncolumn X is b'");
  EXPECT_EQ(refusal(),
            "r.parquet: cannot be read: column X is b; expected an undamaged Parquet or Arrow IPC file that does not "
            "change until the end of the run");
}

TEST_F(ColumnReaderProcess, SaysHowToGetPyarrow) {
  answer("read line; printf 'missing 10\\nno pyarrow'");
  EXPECT_THAT(refusal(),
              AllOf(StartsWith("r.parquet: Parquet and Arrow files cannot be read here: no pyarrow; expected"),
                    HasSubstr("python3 -m pip install pyarrow"), HasSubstr(kColumnsPython)));
  ::setenv(kColumnsPython, "/nowhere/python", 1);
  EXPECT_THAT(refusal(), AllOf(HasSubstr("/nowhere/python cannot be started"), HasSubstr("pip install pyarrow")));
}

TEST_F(ColumnReaderProcess, SaysHowTheProcessEnded) {
  answer("read line; kill -BUS $$");
  EXPECT_THAT(refusal(), AllOf(HasSubstr("ended while it read the file (Bus error)"), HasSubstr("an undamaged")));
  answer("echo first >&2; echo 'no module' >&2; exit 1");
  EXPECT_THAT(refusal(), AllOf(HasSubstr("ended while it read the file: no module"), HasSubstr("pip install")));
  answer("read line; printf 'ok 100\\nshort'");
  EXPECT_THAT(refusal(), HasSubstr("ended while it read the file"));
  answer("read line; printf 'what 3\\nabc'; sleep 100");
  EXPECT_THAT(refusal(), HasSubstr("ended while it read the file"));
  answer("printf '%0100d'; sleep 100");
  EXPECT_THAT(refusal(), HasSubstr("ended while it read the file"));
}

TEST_F(ColumnReaderProcess, IsNotAskedAgainOnceItHasEnded) {
  answer("read line; exit 0");
  ColumnReader reader({"r.parquet"});
  for (int i = 0; i < 2; ++i) {
    EXPECT_THAT(message_of([&] { reader.columns(0); }), HasSubstr("ended while it read the file"));
  }
}

TEST_F(ColumnReaderProcess, IsAskedForColumnsThatCanBeReadAndAreNotIgnored) {
  test::ColumnBlockText head(5, 4);
  head.add_head("X_mm", "float", false);
  head.add_head("when", "timestamp[us]", false);
  head.add_head("note", "text", false);
  head.add_head("item", "text", false);
  std::ofstream(folder_ / "head", std::ios::binary) << head.text();
  answer("read line; printf 'ok %d\\n' " + std::to_string(head.text().size()) + "; cat " + (folder_ / "head").string() +
         "; read line; printf 'refused %d\\n%s' ${#line} \"$line\"");
  const ColumnFile file(std::make_shared<ColumnReader>(std::vector<std::filesystem::path>{"r.parquet"}), 0,
                        {{}, {"note"}, ""});
  EXPECT_EQ(file.rows(), 5U);
  EXPECT_THAT(message_of([&] { file.read(1, 3); }), HasSubstr("cannot be read: rows 0 1 3 0,3;"));
}

TEST(ColumnFileName, OrContentSaysWhatItIs) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "column_file_name";
  std::filesystem::create_directories(folder);
  const auto is_one = [&](const char* name, const char* content) {
    std::ofstream(folder / name) << content;
    return is_column_file(folder / name);
  };
  EXPECT_TRUE(is_one("a.csv", "PAR1..."));
  EXPECT_TRUE(is_one("a.dat", "ARROW1.."));
  EXPECT_TRUE(is_one("a.Parquet", ""));
  EXPECT_FALSE(is_one("a.csv", "X_mm\n1\n"));
  EXPECT_FALSE(is_column_file(folder));
  EXPECT_FALSE(is_column_file(folder / "none.parquet"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace abbe
