#include "abbe/formats/shapes/mesh_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "abbe/formats/files/temporary_file_for_test.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/shapes/obj_file.h"
#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/shapes/stl_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/formats/text/text_blocks.h"
#include "abbe/geometry/surface/mesh_check.h"
#include "abbe/geometry/surface/meshes_for_test.h"

namespace abbe {
namespace {

const Eigen::Vector3d kLower(-1.5, 2, 0.25), kUpper(4, 7.125, 3);

void expect_block(const MeshFile& file, double factor = 1) {
  const MeshCheck check = check_mesh(file.mesh);
  EXPECT_EQ(check.triangles, 12U);
  EXPECT_EQ(check.vertices, 8U);
  EXPECT_TRUE(check.encloses_volume());
  EXPECT_NEAR(check.volume, std::pow(factor, 3) * (kUpper - kLower).prod(), 1e-9 * check.volume);
  EXPECT_EQ(check.lower, factor * kLower);
  EXPECT_EQ(check.upper, factor * kUpper);
}

std::string ascii_stl(const TriangleMesh& mesh) {
  std::string text = "solid a block made for a test\n";
  for (Eigen::Index i = 0; i < mesh.size(); ++i) {
    text += "  facet normal 0 0 0\n    outer loop\n";
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d corner = mesh.corner(i, k);
      text += "      vertex";
      for (int axis = 0; axis < 3; ++axis) text += " " + std::to_string(corner[axis]);
      text += "\n";
    }
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid a block made for a test\n";
}

TEST(StlFile, BinaryAndAsciiGiveTheSameWeldedBlock) {
  const TriangleMesh block = block_for_test(kLower, kUpper);
  const MeshFile binary = parse_mesh(stl_bytes(block), "block.stl");
  EXPECT_EQ(binary.format, "STL, binary");
  expect_block(binary);
  const MeshFile ascii = parse_mesh(ascii_stl(block), "BLOCK.STL");
  EXPECT_EQ(ascii.format, "STL, ascii");
  expect_block(ascii);
  EXPECT_EQ(ascii.mesh.vertices, binary.mesh.vertices);
  EXPECT_EQ(ascii.mesh.triangles, binary.mesh.triangles);
}

TEST(StlFile, ABinaryHeaderThatSaysSolidIsStillBinary) {
  std::string bytes = stl_bytes(block_for_test(kLower, kUpper));
  bytes.replace(0, 20, "solid facet normal 0");
  std::fill(bytes.begin() + 20, bytes.begin() + 80, ' ');
  const MeshFile file = parse_mesh(bytes, "block.stl");
  EXPECT_EQ(file.format, "STL, binary");
  expect_block(file);
  // Cut off in the middle: not taken for a text either.
  const std::string cut = bytes.substr(0, 400);
  EXPECT_EQ(message_of([&] { parse_mesh(cut, "block.stl"); }),
            "block.stl: number of triangles: at byte 80: 12 triangles are stated in a file of 400 bytes; expected a "
            "file of 684 bytes: 84 and 50 for each triangle");
}

TEST(StlFile, ContentsCountWithoutTheExtension) {
  expect_block(parse_mesh(stl_bytes(block_for_test(kLower, kUpper)), "scan"));
  expect_block(parse_mesh(ascii_stl(block_for_test(kLower, kUpper)), "scan.txt"));
}

TEST(StlFile, TheUnitIsGivenOrAssumedAndSaidEitherWay) {
  const std::string bytes = stl_bytes(block_for_test(kLower, kUpper));
  EXPECT_EQ(unit_words(parse_mesh(bytes, "a.stl").unit), "mm (assumed: the file states no unit)");
  MeshFileOptions options;
  options.unit = FileLength::inch;
  const MeshFile inches = parse_mesh(bytes, "a.stl", options);
  EXPECT_EQ(unit_words(inches.unit), "inch (as given)");
  expect_block(inches, 25.4);
  options.unit = FileLength::metre;
  expect_block(parse_mesh(bytes, "a.stl", options), 1000);
}

TEST(StlFile, NormalsThatContradictTheCornersAreNoted) {
  std::string bytes = stl_bytes(block_for_test(kLower, kUpper));
  EXPECT_TRUE(parse_mesh(bytes, "a.stl").notes.empty());
  // Facet 0 looks along -z; the sign of its normal's z is in the last byte of the third float.
  float z = 0;
  std::memcpy(&z, bytes.data() + 84 + 8, 4);
  ASSERT_EQ(std::abs(z), 1.0F);
  z = -z;
  std::memcpy(bytes.data() + 84 + 8, &z, 4);
  const MeshFile file = parse_mesh(bytes, "a.stl");
  ASSERT_EQ(file.notes.size(), 1U);
  EXPECT_EQ(file.notes[0], "the normals of 1 facets contradict the order of their corners, which counts");
  expect_block(file);
}

TEST(StlFile, ASphereSurvivesWritingAndReading) {
  const TriangleMesh sphere = sphere_for_test({10, -20, 30}, 12.703, 40);
  const MeshFile file = parse_mesh(stl_bytes(sphere), "sphere.stl");
  ASSERT_EQ(file.mesh.triangles.cols(), sphere.triangles.cols());
  EXPECT_EQ(file.mesh.vertices.cols(), sphere.vertices.cols());
  for (Eigen::Index i = 0; i < sphere.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      ASSERT_EQ(file.mesh.corner(i, k), sphere.corner(i, k).cast<float>().cast<double>());
    }
  }
  EXPECT_TRUE(check_mesh(file.mesh).encloses_volume());
}

TEST(StlFile, DoesNotDependOnTheNumberOfThreads) {
  // Several blocks of both forms; the text in two solids, words in capitals, one with the name of a word.
  const TriangleMesh sphere = sphere_for_test({10, -20, 30}, 12.703, 100);
  std::string text = ascii_stl(sphere), second = ascii_stl(block_for_test(kLower, kUpper));
  second.replace(0, 5, "SOLID facet normal\t");
  for (std::size_t at = second.find("outer"); at != std::string::npos; at = second.find("outer", at)) {
    second.replace(at, 5, "OUTER");
  }
  text += second + ascii_stl(sphere);
  ASSERT_GT(text.size(), std::size_t{3} << 20);
  MeshFileOptions one, three;
  one.threads = 1;
  three.threads = 3;
  const MeshFile ascii = parse_mesh(text, "a.stl", one), again = parse_mesh(text, "a.stl", three);
  EXPECT_EQ(ascii.mesh.size(), 2 * sphere.size() + 12);
  EXPECT_EQ(ascii.mesh.vertices.cols(), sphere.vertices.cols() + 8);
  EXPECT_EQ(again.mesh.vertices, ascii.mesh.vertices);
  EXPECT_EQ(again.mesh.triangles, ascii.mesh.triangles);
  // The same triangles as in the file, in its order.
  for (Eigen::Index i = 0; i < sphere.size(); ++i) {
    ASSERT_EQ(ascii.mesh.triangles.col(i), ascii.mesh.triangles.col(sphere.size() + 12 + i)) << i;
    for (int k = 0; k < 3; ++k) ASSERT_LT((ascii.mesh.corner(i, k) - sphere.corner(i, k)).norm(), 1e-6) << i;
  }
  std::string bytes = stl_bytes(sphere);
  const MeshFile binary = parse_mesh(bytes, "a.stl", one), binary_again = parse_mesh(bytes, "a.stl", three);
  EXPECT_EQ(binary.mesh.vertices.cols(), sphere.vertices.cols());
  EXPECT_EQ(binary_again.mesh.vertices, binary.mesh.vertices);
  EXPECT_EQ(binary_again.mesh.triangles, binary.mesh.triangles);
  // Two things wrong in different blocks: the first one is said, with its place in the file.
  const std::size_t late = text.rfind("endloop"), early = text.rfind("vertex", text.size() / 2);
  std::string broken = text;
  broken[late] = 'x';
  const std::string at_late = fmt::format("a.stl:{}:5: 'xndloop'; expected 'endloop'", text_line(text, late));
  EXPECT_EQ(message_of([&] { parse_mesh(broken, "a.stl", three); }), at_late);
  broken[early] = 'x';
  EXPECT_EQ(message_of([&] { parse_mesh(broken, "a.stl", three); }),
            fmt::format("a.stl:{}:7: 'xertex'; expected 'vertex'", text_line(text, early)));
  const float wrong = 3e9F;
  for (const std::size_t facet : {std::size_t{38000}, std::size_t{20000}}) {
    std::memcpy(bytes.data() + 84 + 50 * facet + 16, &wrong, sizeof wrong);
    EXPECT_EQ(message_of([&] { parse_mesh(bytes, "a.stl", three); }),
              fmt::format("a.stl: corner 1 y: at byte {}: triangle {}: 3e+09 is too large; expected a coordinate of at "
                          "most 1e+09 mm",
                          84 + 50 * facet + 16, facet));
  }
  // A solid that ends where the next block would begin, and goes on without a new one.
  const std::size_t gap = text.find("  facet", std::size_t{1} << 20);
  broken = text.substr(0, gap) + "endsolid\n" + text.substr(gap);
  EXPECT_EQ(message_of([&] { parse_mesh(broken, "a.stl", three); }),
            fmt::format("a.stl:{}:3: 'facet'; expected 'solid'", text_line(text, gap) + 1));
}

TEST(PlyFile, BinaryReadsBackToTheSameBits) {
  TriangleMesh sphere = sphere_for_test({1.0 / 3, -2.0 / 7, 1e5 / 3}, 12.703, 12);
  const test::TemporaryFile written("", ".ply");
  write_mesh(written.path(), sphere);
  const MeshFile file = read_mesh(written.path());
  EXPECT_EQ(file.format, "PLY, binary little-endian");
  EXPECT_EQ(unit_words(file.unit), "mm (stated by the file)");
  EXPECT_EQ(file.mesh.vertices, sphere.vertices);
  EXPECT_EQ(file.mesh.triangles, sphere.triangles);
}

TEST(PlyFile, AStatedUnitAndAnotherGivenOneAreAContradiction) {
  const std::string bytes = ply_bytes({block_for_test(kLower, kUpper).vertices});
  EXPECT_EQ(message_of([&] { parse_ply(bytes, "a.ply", FileLength::inch); }),
            "a.ply: unit: the file states mm, but inch was given; expected the unit of the file, or none");
}

TEST(PlyFile, ColoursAndDeviationsStandBesideThePoints) {
  const TriangleMesh block = block_for_test(kLower, kUpper);
  PlyParts parts{block.vertices};
  parts.normals = Eigen::Matrix3Xd::Zero(3, 8);
  parts.normals.row(1).setOnes();
  parts.colours.setConstant(3, 8, std::uint8_t{200});
  const std::vector<double> deviations(8, -0.0125);
  parts.deviation = deviations;
  parts.triangles = block.triangles;
  const std::string bytes = ply_bytes(parts);
  EXPECT_NE(bytes.find("property uchar red\nproperty uchar green\nproperty uchar blue\nproperty double deviation_mm\n"),
            std::string::npos);
  const std::size_t row = bytes.find("end_header\n") + 11;
  EXPECT_EQ(bytes[row + 48], static_cast<char>(200));
  double deviation = 0;
  std::memcpy(&deviation, bytes.data() + row + 51, 8);
  EXPECT_EQ(deviation, -0.0125);
  const PlyContents back = parse_ply(bytes, "a.ply");
  EXPECT_EQ(back.points, block.vertices);
  EXPECT_EQ(back.normals, parts.normals);
  EXPECT_EQ(back.triangles, block.triangles);
}

TEST(PlyFile, InPiecesItHasTheSameBytes) {
  const TriangleMesh block = block_for_test(kLower, kUpper);
  const std::vector<double> deviations = {1, 2, 3, 4, 5, 6, 7, 8};
  PlyParts all{block.vertices};
  all.colours = Eigen::Matrix<std::uint8_t, 3, 8>::Constant(7);
  all.deviation = deviations;
  const Eigen::Matrix3Xd first = block.vertices.leftCols(3), others = block.vertices.rightCols(5);
  PlyParts one{first}, two{others};
  one.colours = all.colours.leftCols(3);
  two.colours = all.colours.rightCols(5);
  one.deviation = std::span(deviations).first(3);
  two.deviation = std::span(deviations).last(5);
  EXPECT_EQ(ply_header(one, 8) + ply_rows(one) + ply_rows(two), ply_bytes(all));
}

template <typename T>
void put_big_endian(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(std::make_reverse_iterator(raw + sizeof(T)), std::make_reverse_iterator(raw));
}

TEST(PlyFile, BigEndianWithOddTypesOtherElementsAndPolygons) {
  std::string bytes =
      "ply\r\nformat binary_big_endian 1.0\r\ncomment made by hand\r\nobj_info nothing\r\n"
      "element camera 1\r\nproperty list short double view\r\nproperty int8 shutter\r\n"
      "element vertex 5\r\nproperty ushort confidence\r\nproperty int16 z\r\nproperty float x\r\nproperty double y\r\n"
      "element face 2\r\nproperty uchar flags\r\nproperty list ushort int16 vertex_index\r\nend_header\r\n";
  put_big_endian(bytes, std::int16_t{2});
  put_big_endian(bytes, 1.5);
  put_big_endian(bytes, 2.5);
  bytes += '\x01';
  const double points[5][3] = {{0, 0, -300}, {4, 0, -300}, {4, 3, -300}, {0, 3, -300}, {-2, 1.5, -300}};
  for (const auto& point : points) {
    put_big_endian(bytes, std::uint16_t{65535});
    put_big_endian(bytes, static_cast<std::int16_t>(point[2]));
    put_big_endian(bytes, static_cast<float>(point[0]));
    put_big_endian(bytes, point[1]);
  }
  for (const std::vector<int>& face : {std::vector<int>{0, 1, 2, 3}, std::vector<int>{0, 3, 4}}) {
    bytes += '\x07';
    put_big_endian(bytes, static_cast<std::uint16_t>(face.size()));
    for (const int corner : face) put_big_endian(bytes, static_cast<std::int16_t>(corner));
  }
  const MeshFile file = parse_mesh(bytes, "a.ply");
  EXPECT_EQ(file.format, "PLY, binary big-endian");
  ASSERT_EQ(file.mesh.triangles.cols(), 3);
  EXPECT_DOUBLE_EQ(check_mesh(file.mesh).area, 12 + 3);
  EXPECT_EQ(file.mesh.vertices.col(4), Eigen::Vector3d(-2, 1.5, -300));
}

TEST(PlyFile, AsciiWithPolygonsAndValuesThatAreNotRead) {
  const MeshFile file = parse_mesh(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "quality\nelement face 1\nproperty list uchar int vertex_indices\nproperty float area\nend_header\n"
      "0 0 1e0 7\n2.5 0 1 7\n2.5 +2 1 7\n0 2 1 7\n4 0 1 2 3 5\n",
      "a.ply");
  EXPECT_EQ(file.format, "PLY, ascii");
  EXPECT_DOUBLE_EQ(check_mesh(file.mesh).area, 5);
}

TEST(ObjFile, ReadsPolygonsAndAllWaysToNameACorner) {
  const MeshFile file = parse_mesh(
      "# a square, a triangle and an arrow\nmtllib a.mtl\no part\nv 0 0 0\nv 2 0 0 1.0\nv 2 2 0 0.1 0.2 0.3\nv 0 2 0\n"
      "vt 0 0\nvn 0 0 1\ng side\nusemtl red\ns off\nf 1/1/1 2/1/1 3/1/1 4/1/1\r\nf -4//1 -3//-1 -2//1\n"
      "v 10 0 0\nv 14 1 0\nv 11 1 0\nv 11 4 0\nf -4/1 -3/1 -2/1 -1/1\n\n",
      "a.obj");
  EXPECT_EQ(file.format, "OBJ");
  ASSERT_EQ(file.mesh.triangles.cols(), 5);
  EXPECT_EQ(file.mesh.triangles.col(2), (Eigen::Matrix<std::uint32_t, 3, 1>(0, 1, 2)));
  const double arrow = 0.5 * std::abs((4 * 1 - 1 * 1) + (1 * 4 - 1 * 1));  // by its diagonal
  EXPECT_NEAR(check_mesh(file.mesh).area, 4 + 2 + arrow, 1e-12);
}

TEST(ObjFile, ObjectsGroupsAndMaterialsAreRegions) {
  const MeshFile file = parse_mesh(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\no blade\ng suction side \r\nf 1 2 4 3\nusemtl steel\nf 1 2 3\n"
      "g pressure\ng suction side\ng root\nf 1 3 2\no blade\ng suction side\nf 2 3 4\n",
      "a.obj");
  EXPECT_EQ(file.face_of_triangle, (std::vector<std::uint32_t>{0, 1, 1, 2, 3, 2}));
  EXPECT_EQ(file.face_names, (std::vector<std::string>{"unnamed", "blade / suction side",
                                                       "blade / suction side / steel", "blade / root / steel"}));
  EXPECT_EQ(file.faces, 4U);
  EXPECT_FALSE(file.has_exact_faces());
  EXPECT_EQ(parse_mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj").faces, 0U);
}

TEST(ObjFile, NamesOfRegionsAreShortAndWholeCharacters) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", a(59, 'a');
  const auto name = [&](const std::string& group) {
    return parse_mesh(corners + "g " + group + "\nf 1 2 3\n", "a.obj").face_names.at(0);
  };
  EXPECT_EQ(name(a + "\xc3\xa4"), a);
  EXPECT_EQ(name("\xc3\xa4\x1b[2J"), "\xc3\xa4.[2J");
  EXPECT_EQ(name(std::string(61, '\x80')), "unnamed") << "bytes that are not text";
  // Names that differ behind the 60th byte are different regions.
  const MeshFile two = parse_mesh(corners + "g " + a + "xx1\nf 1 2 3\ng " + a + "xx2\nf 1 2 3\n", "a.obj");
  EXPECT_EQ(two.faces, 2U);
  // Without a name the group, or the material, ends.
  const MeshFile ended = parse_mesh(corners + "o a\ng b\nusemtl c\nf 1 2 3\nusemtl\nf 1 2 3\ng \nf 1 2 3\n", "a.obj");
  EXPECT_EQ(ended.face_names, (std::vector<std::string>{"a / b / c", "a / b", "a"}));
}

TEST(ObjFile, DoesNotDependOnTheNumberOfThreads) {
  // Several blocks of a megabyte, with references backwards over their borders.
  std::mt19937_64 random(3);
  std::string text;
  std::size_t vertices = 0;
  while (text.size() < (std::size_t{5} << 19)) {
    text += "v " + std::to_string(0.001 * static_cast<double>(random() % 1000000)) + " " +
            std::to_string(random() % 1000) + " " + std::to_string(random() % 1000) + "\n";
    if (vertices % 1000 == 700) text += "g " + std::to_string(vertices / 3000) + "\n";
    if (++vertices >= 4) text += "f -1 -2 -4 -3\n";
  }
  const ObjContents one = parse_obj(text, "a.obj", {}, 1), three = parse_obj(text, "a.obj", {}, 3);
  EXPECT_EQ(one.points, three.points);
  EXPECT_EQ(one.region_of_triangle, three.region_of_triangle);
  EXPECT_EQ(one.regions, three.regions);
  // Every triangle of the third thousand of vertices and behind it up to the next group.
  ASSERT_EQ(one.regions.at(1), "0");
  EXPECT_EQ(one.region_of_triangle.at(2 * (699 - 3)), 0U);
  EXPECT_EQ(one.region_of_triangle.at(2 * (700 - 3)), 1U);
  EXPECT_EQ(one.regions.at(one.region_of_triangle.back()), std::to_string((vertices - 701) / 1000 * 1000 / 3000));
  ASSERT_EQ(one.triangles, three.triangles);
  ASSERT_EQ(static_cast<std::size_t>(one.triangles.cols()), 2 * (vertices - 3));
  const Eigen::Index last = one.triangles.cols() - 1;
  EXPECT_EQ(one.triangles.col(last).maxCoeff(), vertices - 1);
}

TEST(MeshFile, SaysWhatItDoesNotKnow) {
  EXPECT_EQ(message_of([] { parse_mesh("hello", "part.dwg"); }),
            "part.dwg: files with the extension '.dwg' are not known; expected a mesh: STL, PLY, OBJ or STEP");
  EXPECT_EQ(message_of([] { parse_mesh("v 1 2 3\n", "part.obj"); }),
            "part.obj: there are no faces in the file; expected a mesh: STL, PLY, OBJ or STEP");
  EXPECT_EQ(message_of([] { write_mesh("part.obj", TriangleMesh()); }),
            "part.obj: meshes are not written as '.obj'; expected .stl or .ply");
}

}  // namespace
}  // namespace abbe
