#include "abbe/study/scans/piece_deviations.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "abbe/formats/shapes/deviation_rows.h"
#include "abbe/geometry/numbered_work.h"

namespace abbe {
namespace {

/// Normals among which the next one is looked for.
constexpr std::size_t kRecentNormals = 1024;
constexpr std::uint32_t kNone = 0xffffffffU;

/// Every list of a piece, in the order of the message.
template <typename Piece, typename Visit>
void for_each_list(Piece& piece, const Visit& visit) {
  visit(piece.deviation_mm);
  visit(piece.faces);
  visit(piece.points);
  visit(piece.feet);
  visit(piece.normals);
  visit(piece.normal_of);
  visit(piece.rows);
}

}  // namespace

void PieceDeviations::reserve(std::size_t about, const PieceQuestion& question) {
  constexpr std::size_t kBytesOfRow = 72;
  deviation_mm.reserve(about);
  if (!question.face_of_triangle.empty()) faces.reserve(about);
  if (!question.with_points) return;
  points.reserve(3 * about);
  feet.reserve(3 * about);
  normal_of.reserve(about);
  rows.reserve(kBytesOfRow * about);
}

void PieceDeviations::add(const Eigen::Matrix3Xd& all, std::span<const SurfacePoint> closest,
                          const PieceQuestion& question) {
  const std::size_t before = deviation_mm.size();
  counts[0] += closest.size();
  for (std::size_t i = 0; i < closest.size(); ++i) {
    const SurfacePoint& foot = closest[i];
    const bool far = question.largest_mm > 0 && !(std::abs(foot.distance) <= question.largest_mm);
    if (foot.on_border || far) {
      ++counts[foot.on_border ? 2 : 3];
      continue;
    }
    deviation_mm.push_back(foot.distance);
    if (!question.face_of_triangle.empty()) faces.push_back(question.face_of_triangle[foot.triangle]);
    if (!question.with_points) continue;
    const double* const point = all.col(static_cast<Eigen::Index>(i)).data();
    points.insert(points.end(), point, point + 3);
    feet.insert(feet.end(), foot.point.data(), foot.point.data() + 3);
    normal_of.push_back(number_of_normal(foot.normal));
  }
  if (!question.with_points) return;
  append_deviation_rows(std::span(points).subspan(3 * before), std::span(deviation_mm).subspan(before), rows);
}

std::uint32_t PieceDeviations::number_of_normal(const Eigen::Vector3d& normal) {
  if (recent_normals_.empty()) recent_normals_.assign(kRecentNormals, kNone);
  std::uint64_t mixed = 0;
  for (const double value : normal) mixed = (mixed ^ std::bit_cast<std::uint64_t>(value)) * 0x9e3779b97f4a7c15U;
  std::uint32_t& recent = recent_normals_[mixed >> 54U];
  // Bits are compared: the sign of a zero counts too.
  if (recent == kNone || std::memcmp(&normals[3 * std::size_t{recent}], normal.data(), 3 * sizeof(double)) != 0) {
    recent = static_cast<std::uint32_t>(normals.size() / 3);
    normals.insert(normals.end(), normal.data(), normal.data() + 3);
  }
  return recent;
}

void PieceDeviations::pack(std::vector<std::byte>& bytes) const {
  const auto put = [&bytes](std::span<const std::byte> part) { bytes.insert(bytes.end(), part.begin(), part.end()); };
  std::size_t all = sizeof counts;
  for_each_list(*this, [&](const auto& list) { all += sizeof(std::uint64_t) + std::as_bytes(std::span(list)).size(); });
  if (bytes.capacity() < bytes.size() + all) bytes.reserve(std::max(2 * bytes.size(), bytes.size() + all));
  put(std::as_bytes(std::span(counts)));
  for_each_list(*this, [&](const auto& list) {
    const std::uint64_t size = list.size();
    put(std::as_bytes(std::span(&size, 1)));
    put(std::as_bytes(std::span(list)));
  });
}

void PieceDeviations::unpack(std::span<const std::byte> bytes) {
  const auto take = [&bytes](std::span<std::byte> into) {
    if (bytes.size() < into.size()) throw WorkError("deviations of a piece of the scan are cut off");
    if (!into.empty()) std::memcpy(into.data(), bytes.data(), into.size());
    bytes = bytes.subspan(into.size());
  };
  take(std::as_writable_bytes(std::span(counts)));
  for_each_list(*this, [&](auto& list) {
    std::uint64_t size = 0;
    take(std::as_writable_bytes(std::span(&size, 1)));
    if (size > bytes.size() / sizeof(list.front())) throw WorkError("deviations of a piece of the scan are cut off");
    list.resize(size);
    take(std::as_writable_bytes(std::span(list)));
  });
  require_unpacked(bytes);
  const std::size_t n = deviation_mm.size();
  const bool fits = (faces.empty() || faces.size() == n) &&
                    (normal_of.empty() ? points.empty() && feet.empty()
                                       : normal_of.size() == n && points.size() == 3 * n && feet.size() == 3 * n);
  const auto has_normal = [&](std::uint32_t normal) { return normal < normals.size() / 3; };
  if (!fits || !std::all_of(normal_of.begin(), normal_of.end(), has_normal)) {
    throw WorkError("deviations of a piece of the scan do not fit together");
  }
}

}  // namespace abbe
