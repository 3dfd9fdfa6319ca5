#include "abbe/formats/shapes/ending.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/shapes/stl_file.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::HasSubstr;

TEST(EndingOfContents, IsToldByTheFirstBytes) {
  EXPECT_EQ(ending_of("ISO-10303-21;\nHEADER;"), ".step");
  EXPECT_EQ(ending_of("ply\nformat ascii 1.0\n"), ".ply");
  EXPECT_EQ(ending_of("solid part\n"), ".stl");
  EXPECT_EQ(ending_of("# a machine\n\nname = \"mill\""), ".toml");
  EXPECT_EQ(ending_of("[axis.X]\n"), ".toml");
  EXPECT_EQ(ending_of("\xEF\xBB\xBFx_mm,y_mm,z_mm\n"), ".csv");
  EXPECT_EQ(ending_of("x,y,z\n"), ".csv");  // without units, which its reader says
  EXPECT_EQ(ending_of("// part\nv 0 0 0\n"), ".obj");
  EXPECT_EQ(ending_of("-1.5e-3 2 3\n"), ".xyz");
  for (const char* const contents :
       {"", "# only a comment", "hello\n", "; a comment of a program\n", "e 1", "[", "= 1"}) {
    EXPECT_EQ(ending_of(contents), "") << contents;
  }
}

TEST(EndingOfContents, EveryBeginningOfABinaryStlFileWithItsNumberOfTrianglesIsOne) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << 0, 120.5, 0, 0, 0, 0.75, 0, 3e-17, 1;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 0, 1, 2, 2, 1;
  const std::string whole = stl_bytes(mesh);
  ASSERT_EQ(whole.size(), 184U);
  for (std::size_t length = 84; length <= whole.size(); ++length) {
    EXPECT_EQ(ending_of(whole.substr(0, length)), ".stl") << length;
  }
  EXPECT_EQ(ending_of(whole.substr(0, 83)), "");
  std::string solid = whole.substr(0, 150);
  std::memcpy(solid.data(), "solid", 5);
  EXPECT_EQ(ending_of(solid), ".stl");
  solid[87] = '\x7f';  // a first number beyond all coordinates
  solid[86] = '\x7f';
  EXPECT_EQ(ending_of(solid), "");
}

TEST(EndingOfContents, OtherBinaryFilesAreOfNoKind) {
  // As a frozen compensation, a picture and a program begin; then what an STL file could go on with.
  for (const char* const start : {"\x89"
                                  "ABBEC",
                                  "\x89PNG",
                                  "\x7f"
                                  "ELF"}) {
    std::string contents(150, '\0');
    std::memcpy(contents.data(), start, std::strlen(start));
    contents[80] = '\2';
    contents[98] = '\x80';
    contents[99] = '\x3f';
    EXPECT_EQ(ending_of(contents), "") << start + 1;
  }
  // Whole numbers.
  std::string numbers(300, '\0');
  for (std::size_t i = 0; i < numbers.size(); i += 4) numbers[i] = static_cast<char>(i / 4 + 1);
  numbers[0] = 'n';
  EXPECT_EQ(ending_of(numbers), "");
  EXPECT_EQ(ending_of(std::string(300, '\0')), "");
}

TEST(EndingOfContents, ARefusalSaysWhatItIsAndWhatTheRightKindsBeginWith) {
  const auto message = [](std::string_view contents) {
    return message_of([&] { refuse_contents("<stdin>", contents, "a mesh", {".ply", ".obj"}); });
  };
  EXPECT_EQ(message("hello"),
            "<stdin>: its kind cannot be recognised from its contents; expected a mesh that begins like a PLY file "
            "('ply') or an OBJ file ('v X Y Z'); or give the name of a file, whose extension shows its kind");
  EXPECT_THAT(message("1 2 3"), HasSubstr("<stdin>: begins like an XYZ file; expected a mesh"));
}

TEST(CanBeProgram, ExceptForOtherKindsAndWords) {
  for (const char* const contents : {"%\nG0 X1\n", "(comment)\n", "; 1\n", "g 0 x1", "GO X1", "C2=30 G1", "f 100"}) {
    EXPECT_TRUE(can_be_program(contents)) << contents;
  }
  for (const char* const contents : {"solid\n", "ply\n", "1 2 3\n", "hello\n", "name = 1", "[axis]"}) {
    EXPECT_FALSE(can_be_program(contents)) << contents;
  }
}

}  // namespace
}  // namespace abbe
