// Reading meshes of 1,000,000 triangles: this project's reader against Open3D's in the same run, one after the other.
// The files are in the page cache, so that what is measured is the reading. Exit code 1 below three times in one
// format.
//
//   read_mesh [repetitions]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>

#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/shapes/stl_file.h"
#ifdef BENCHMARK_OPEN3D
#include "read_mesh_open3d.h"
#endif

namespace {

using abbe::TriangleMesh;

/// A bumpy sphere, so that coordinates have all their digits.
TriangleMesh bumpy_sphere() {
  constexpr int kRings = 501, kMeridians = 2 * kRings;
  TriangleMesh mesh;
  mesh.vertices.resize(3, kMeridians * (kRings - 1) + 2);
  mesh.triangles.resize(3, 2 * kMeridians * (kRings - 1));
  const auto at = [](int ring, int meridian) -> std::uint32_t {
    if (ring == 0 || ring == kRings) return ring == 0 ? 0 : 1;
    return static_cast<std::uint32_t>(2 + (ring - 1) * kMeridians + meridian % kMeridians);
  };
  Eigen::Index next = 0;
  for (int ring = 0; ring <= kRings; ++ring) {
    const double theta = std::numbers::pi * ring / kRings;
    for (int meridian = 0; meridian < kMeridians; ++meridian) {
      const double phi = 2 * std::numbers::pi * meridian / kMeridians;
      const double radius = 50 + std::sin(5 * theta) * std::sin(theta) * std::cos(7 * phi);
      mesh.vertices.col(at(ring, meridian)) =
          radius * Eigen::Vector3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      if (ring == kRings) continue;
      const std::uint32_t a = at(ring, meridian), b = at(ring + 1, meridian), c = at(ring + 1, meridian + 1),
                          d = at(ring, meridian + 1);
      if (b != c) mesh.triangles.col(next++) << a, b, c;
      if (a != d) mesh.triangles.col(next++) << a, c, d;
    }
  }
  return mesh;
}

/// Triangles that share no corner: each a little smaller about its middle.
std::string loose_stl(const TriangleMesh& mesh) {
  TriangleMesh loose;
  loose.vertices.resize(3, 3 * mesh.size());
  loose.triangles.resize(3, mesh.size());
  for (Eigen::Index i = 0; i < mesh.size(); ++i) {
    const Eigen::Vector3d middle = (mesh.corner(i, 0) + mesh.corner(i, 1) + mesh.corner(i, 2)) / 3;
    for (int k = 0; k < 3; ++k) {
      loose.vertices.col(3 * i + k) = middle + 0.9 * (mesh.corner(i, k) - middle);
      loose.triangles(k, i) = static_cast<std::uint32_t>(3 * i + k);
    }
  }
  return abbe::stl_bytes(loose);
}

std::string ascii_stl(const TriangleMesh& mesh) {
  std::string text = "solid\n";
  for (Eigen::Index i = 0; i < mesh.size(); ++i) {
    const Eigen::Vector3d a = mesh.corner(i, 0);
    const Eigen::Vector3d ab = mesh.corner(i, 1) - a, ac = mesh.corner(i, 2) - a;
    Eigen::Vector3d normal(ab.y() * ac.z() - ab.z() * ac.y(), ab.z() * ac.x() - ab.x() * ac.z(),
                           ab.x() * ac.y() - ab.y() * ac.x());
    normal /= normal.norm();
    fmt::format_to(std::back_inserter(text), "facet normal {:.6e} {:.6e} {:.6e}\nouter loop\n", normal.x(), normal.y(),
                   normal.z());
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d p = mesh.corner(i, k);
      fmt::format_to(std::back_inserter(text), "vertex {:.6e} {:.6e} {:.6e}\n", p.x(), p.y(), p.z());
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid\n";
}

std::string ascii_ply(const TriangleMesh& mesh) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face "
      "{}\n"
      "property list uchar uint vertex_indices\nend_header\n",
      mesh.vertices.cols(), mesh.size());
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    fmt::format_to(std::back_inserter(text), "{:.9f} {:.9f} {:.9f}\n", mesh.vertices(0, i), mesh.vertices(1, i),
                   mesh.vertices(2, i));
  }
  for (Eigen::Index i = 0; i < mesh.size(); ++i) {
    fmt::format_to(std::back_inserter(text), "3 {} {} {}\n", mesh.triangles(0, i), mesh.triangles(1, i),
                   mesh.triangles(2, i));
  }
  return text;
}

std::string obj(const TriangleMesh& mesh) {
  std::string text;
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    fmt::format_to(std::back_inserter(text), "v {:.9f} {:.9f} {:.9f}\n", mesh.vertices(0, i), mesh.vertices(1, i),
                   mesh.vertices(2, i));
  }
  for (Eigen::Index i = 0; i < mesh.size(); ++i) {
    fmt::format_to(std::back_inserter(text), "f {} {} {}\n", mesh.triangles(0, i) + 1, mesh.triangles(1, i) + 1,
                   mesh.triangles(2, i) + 1);
  }
  return text;
}

std::string binary_ply(const TriangleMesh& mesh) {
  abbe::PlyParts parts{mesh.vertices};
  parts.triangles = mesh.triangles;
  return abbe::ply_bytes(parts);
}

std::size_t abbe_triangles(const std::string& path, int threads) {
  abbe::MeshFileOptions options;
  options.threads = threads;
  return static_cast<std::size_t>(abbe::read_mesh(path, options).mesh.size());
}

/// Seconds of one reading; infinite if triangles are missing.
double seconds(const std::function<std::size_t()>& read, std::size_t expected) {
  const auto begin = std::chrono::steady_clock::now();
  const std::size_t triangles = read();
  const double passed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return triangles == expected ? passed : INFINITY;
}

}  // namespace

int main(int count, char** arguments) {
  const int repetitions = count > 1 ? std::atoi(arguments[1]) : 5;
  const TriangleMesh mesh = bumpy_sphere();
  const auto triangles = static_cast<std::size_t>(mesh.size());
  struct Case {
    const char* name;
    const char* extension;
    std::string (*bytes)(const TriangleMesh&);
  };
  const Case cases[] = {{"STL, binary", ".stl", abbe::stl_bytes}, {"STL, loose", ".stl", loose_stl},
                        {"STL, ascii", ".stl", ascii_stl},        {"PLY, binary", ".ply", binary_ply},
                        {"PLY, ascii", ".ply", ascii_ply},        {"OBJ", ".obj", obj}};
  fmt::print("{} triangles, shortest of {}; MB/s of 2^20 bytes\n{:<12} {:>7} {:>12} {:>12} {:>12} {:>8}\n", triangles,
             repetitions, "", "MB", "1 thread", "2 threads", "Open3D", "ratio");
  bool met = true;
  for (const Case& one : cases) {
    const std::string path =
        (std::filesystem::temp_directory_path() / (std::string("abbe_read_mesh") + one.extension)).string();
    {
      const std::string bytes = one.bytes(mesh);
      std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    }
    const double megabytes = static_cast<double>(std::filesystem::file_size(path)) / (1 << 20);
    double single = INFINITY, both = INFINITY, theirs = INFINITY;
    for (int i = 0; i < repetitions; ++i) {
      single = std::min(single, seconds([&] { return abbe_triangles(path, 1); }, triangles));
      both = std::min(both, seconds([&] { return abbe_triangles(path, 2); }, triangles));
#ifdef BENCHMARK_OPEN3D
      theirs = std::min(theirs, seconds([&] { return abbe::benchmarks::open3d_triangles(path); }, triangles));
#endif
    }
    std::filesystem::remove(path);
    fmt::print("{:<12} {:>7.1f} {:>12.0f} {:>12.0f} ", one.name, megabytes, megabytes / single, megabytes / both);
    if (std::isfinite(theirs)) {
      fmt::print("{:>12.0f} {:>8.1f}\n", megabytes / theirs, theirs / both);
      met = met && theirs >= 3 * both;
    } else {
      fmt::print("{:>12} {:>8}\n", "-", "-");
    }
    std::fflush(stdout);
    met = met && std::isfinite(both) && std::isfinite(single);
  }
  return met ? 0 : 1;
}
