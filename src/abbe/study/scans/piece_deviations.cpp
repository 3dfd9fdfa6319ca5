#include "abbe/study/scans/piece_deviations.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "abbe/formats/shapes/deviation_rows.h"
#include "abbe/geometry/numbered_work.h"

namespace abbe {
namespace {

/// Every list of a piece, in the order of the message.
template <typename Piece, typename Visit>
void for_each_list(Piece& piece, const Visit& visit) {
  visit(piece.deviation_mm);
  visit(piece.faces);
  visit(piece.points);
  visit(piece.rows);
  visit(piece.colours);
  visit(piece.drawn);
}

}  // namespace

PieceComparison::PieceComparison(const PieceQuestion& question, std::size_t about)
    : question_(question), sums_(question.places != nullptr ? question.places->count() : 0), drawn_(question.measured) {
  // Room for about so many points, so that nothing is copied as they come.
  constexpr std::size_t kBytesOfRow = 72;
  found_.deviation_mm.reserve(about);
  if (!question.face_of_triangle.empty()) found_.faces.reserve(about);
  if (question.places == nullptr) return;
  found_.points.reserve(3 * about);
  found_.rows.reserve(kBytesOfRow * about);
}

void PieceComparison::add(const Eigen::Matrix3Xd& points, std::span<const SurfacePoint> closest) {
  const std::size_t before = found_.deviation_mm.size();
  found_.counts[0] += closest.size();
  for (std::size_t i = 0; i < closest.size(); ++i) {
    const SurfacePoint& foot = closest[i];
    const bool far = question_.largest_mm > 0 && !(std::abs(foot.distance) <= question_.largest_mm);
    if (foot.on_border || far) {
      ++found_.counts[foot.on_border ? 2 : 3];
      continue;
    }
    found_.deviation_mm.push_back(foot.distance);
    if (!question_.face_of_triangle.empty()) found_.faces.push_back(question_.face_of_triangle[foot.triangle]);
    if (question_.places == nullptr) continue;
    const double* const point = points.col(static_cast<Eigen::Index>(i)).data();
    found_.points.insert(found_.points.end(), point, point + 3);
    question_.places->add(foot.point, foot.normal, foot.distance, sums_);
    drawn_.add(foot.point, foot.normal, foot.distance);
  }
  if (question_.places == nullptr) return;
  append_deviation_rows(std::span(found_.points).subspan(3 * before), std::span(found_.deviation_mm).subspan(before),
                        found_.rows);
}

PieceDeviations PieceComparison::taken() {
  if (question_.places != nullptr) {
    found_.colours = sums_.entries();
    found_.drawn = drawn_.chosen();
  }
  return std::move(found_);
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
  const auto is_of_piece = [n](const DrawnReading& reading) { return reading.number < n; };
  const bool fits = (faces.empty() || faces.size() == n) && (points.empty() || points.size() == 3 * n) &&
                    std::all_of(drawn.begin(), drawn.end(), is_of_piece);
  if (!fits) {
    throw WorkError("deviations of a piece of the scan do not fit together");
  }
}

}  // namespace abbe
