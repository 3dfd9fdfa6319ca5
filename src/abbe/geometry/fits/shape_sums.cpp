#include "abbe/geometry/fits/shape_sums.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "abbe/geometry/fits/shape_sums.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace abbe::fits {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::ScalableTag<double>;
using Vector = hn::Vec<Tag>;

HWY_INLINE Vector set(double value) { return hn::Set(Tag(), value); }
HWY_INLINE Vector dot(const double* axis, Vector x, Vector y, Vector z) {
  return hn::MulAdd(set(axis[0]), x, hn::MulAdd(set(axis[1]), y, hn::Mul(set(axis[2]), z)));
}
HWY_INLINE Vector length(Vector square) { return hn::Max(hn::Sqrt(square), set(1e-150)); }

struct Local {
  Vector x, y, z;
};

HWY_INLINE Local local(const KernelFrame& frame, const double* points) {
  Vector x, y, z;
  hn::LoadInterleaved3(Tag(), points, x, y, z);
  x = hn::Sub(x, set(frame.centre[0]));
  y = hn::Sub(y, set(frame.centre[1]));
  z = hn::Sub(z, set(frame.centre[2]));
  return {hn::Sub(dot(frame.axes[0], x, y, z), set(frame.origin[0])),
          hn::Sub(dot(frame.axes[1], x, y, z), set(frame.origin[1])),
          hn::Sub(dot(frame.axes[2], x, y, z), set(frame.origin[2]))};
}

/// Slopes by the steps that a kind has, then the residual; see Slots in normal_sums().
template <int kCount>
struct Row {
  Vector v[kCount + 1];
};

struct Flat {
  static constexpr int kCount = 3, kRows = 1;
  static HWY_INLINE void rows(const KernelFrame&, const Local& q, Row<kCount>* row) {
    row->v[0] = set(-1);
    row->v[1] = hn::Neg(q.y);
    row->v[2] = q.x;
    row->v[3] = q.z;
  }
};

struct Radial {
  static constexpr int kCount = 5, kRows = 1;
  static HWY_INLINE void rows(const KernelFrame& frame, const Local& q, Row<kCount>* row) {
    const Vector across = length(hn::MulAdd(q.x, q.x, hn::Mul(q.y, q.y)));
    const Vector inverse = hn::Div(set(1), across);
    const Vector c = hn::Mul(q.x, inverse), s = hn::Mul(q.y, inverse);
    row->v[0] = hn::Neg(c);
    row->v[1] = hn::Neg(s);
    row->v[2] = hn::Mul(q.z, s);
    row->v[3] = hn::Neg(hn::Mul(q.z, c));
    row->v[4] = set(-1);
    row->v[5] = hn::Sub(across, set(frame.radius));
  }
};

struct Spherical {
  static constexpr int kCount = 4, kRows = 1;
  static HWY_INLINE void rows(const KernelFrame& frame, const Local& q, Row<kCount>* row) {
    const Vector norm = length(hn::MulAdd(q.x, q.x, hn::MulAdd(q.y, q.y, hn::Mul(q.z, q.z))));
    const Vector inverse = hn::Neg(hn::Div(set(1), norm));
    row->v[0] = hn::Mul(q.x, inverse);
    row->v[1] = hn::Mul(q.y, inverse);
    row->v[2] = hn::Mul(q.z, inverse);
    row->v[3] = set(-1);
    row->v[4] = hn::Sub(norm, set(frame.radius));
  }
};

struct Conical {
  static constexpr int kCount = 6, kRows = 1;
  static HWY_INLINE void rows(const KernelFrame& frame, const Local& q, Row<kCount>* row) {
    const Vector across = length(hn::MulAdd(q.x, q.x, hn::Mul(q.y, q.y)));
    const Vector inverse = hn::Div(set(frame.cosine), across);
    const Vector c = hn::Mul(q.x, inverse), s = hn::Mul(q.y, inverse), sine = set(frame.sine);
    const Vector out = hn::Sub(across, set(frame.radius));
    row->v[0] = hn::Neg(c);
    row->v[1] = hn::Neg(s);
    row->v[2] = hn::MulAdd(q.y, sine, hn::Mul(q.z, s));
    row->v[3] = hn::Neg(hn::MulAdd(q.x, sine, hn::Mul(q.z, c)));
    row->v[4] = set(-frame.cosine);
    row->v[5] = hn::Neg(hn::MulAdd(out, sine, hn::Mul(q.z, set(frame.cosine))));
    row->v[6] = hn::Sub(hn::Mul(out, set(frame.cosine)), hn::Mul(q.z, sine));
  }
};

struct AcrossLine {
  static constexpr int kCount = 4, kRows = 2;
  static HWY_INLINE void rows(const KernelFrame&, const Local& q, Row<kCount>* row) {
    const Vector zero = set(0), minus = set(-1);
    row[0].v[0] = minus;
    row[0].v[1] = zero;
    row[0].v[2] = zero;
    row[0].v[3] = hn::Neg(q.z);
    row[0].v[4] = q.x;
    row[1].v[0] = zero;
    row[1].v[1] = minus;
    row[1].v[2] = q.z;
    row[1].v[3] = zero;
    row[1].v[4] = q.y;
  }
};

struct Ring {
  static constexpr int kCount = 6, kRows = 2;
  static HWY_INLINE void rows(const KernelFrame& frame, const Local& q, Row<kCount>* row) {
    Row<5> radial;
    Radial::rows(frame, q, &radial);
    const Vector zero = set(0);
    row[0].v[0] = radial.v[0];
    row[0].v[1] = radial.v[1];
    row[0].v[2] = zero;
    row[0].v[3] = radial.v[2];
    row[0].v[4] = radial.v[3];
    row[0].v[5] = radial.v[4];
    row[0].v[6] = radial.v[5];
    row[1].v[0] = zero;
    row[1].v[1] = zero;
    row[1].v[2] = set(-1);
    row[1].v[3] = hn::Neg(q.y);
    row[1].v[4] = q.x;
    row[1].v[5] = zero;
    row[1].v[6] = q.z;
  }
};

template <class Kind>
void add_products(const KernelFrame& frame, const double* points, const double* weights, std::size_t n, double* sums) {
  constexpr int kColumns = Kind::kCount + 1;
  constexpr int kPairs = kColumns * (kColumns + 1) / 2;
  const std::size_t lanes = hn::Lanes(Tag());
  Vector total[kPairs];
  for (int k = 0; k < kPairs; ++k) total[k] = set(0);
  const auto add = [&](const double* at, const double* weight) HWY_ATTR {
    Row<Kind::kCount> row[Kind::kRows];
    Kind::rows(frame, local(frame, at), row);
    for (int r = 0; r < Kind::kRows; ++r) {
      int pair = 0;
      for (int i = 0; i < kColumns; ++i) {
        const Vector left = weight == nullptr ? row[r].v[i] : hn::Mul(row[r].v[i], hn::LoadU(Tag(), weight));
        for (int j = i; j < kColumns; ++j, ++pair) total[pair] = hn::MulAdd(left, row[r].v[j], total[pair]);
      }
    }
  };
  std::size_t i = 0;
  if (weights == nullptr) {
    for (; i + lanes <= n; i += lanes) add(points + 3 * i, nullptr);
  } else {
    for (; i + lanes <= n; i += lanes) add(points + 3 * i, weights + i);
  }
  if (i < n) {
    // The rest, filled up with its first point at weight zero.
    double rest[3 * HWY_MAX_BYTES / sizeof(double)], weight[HWY_MAX_BYTES / sizeof(double)];
    for (std::size_t k = 0; k < lanes; ++k) {
      const std::size_t from = i + k < n ? i + k : i;
      for (std::size_t c = 0; c < 3; ++c) rest[3 * k + c] = points[3 * from + c];
      weight[k] = i + k >= n ? 0 : weights == nullptr ? 1 : weights[from];
    }
    add(rest, weight);
  }
  for (int k = 0; k < kPairs; ++k) sums[k] = hn::GetLane(hn::SumOfLanes(Tag(), total[k]));
}

template <class Kind>
void write_distances(const KernelFrame& frame, const double* points, std::size_t n, double* out) {
  const std::size_t lanes = hn::Lanes(Tag());
  const auto one = [&](const double* at) HWY_ATTR {
    Row<Kind::kCount> row[Kind::kRows];
    Kind::rows(frame, local(frame, at), row);
    const Vector first = row[0].v[Kind::kCount];
    if constexpr (Kind::kRows == 1) {
      return first;
    } else {
      const Vector second = row[1].v[Kind::kCount];
      return hn::Sqrt(hn::MulAdd(first, first, hn::Mul(second, second)));
    }
  };
  std::size_t i = 0;
  for (; i + lanes <= n; i += lanes) hn::StoreU(one(points + 3 * i), Tag(), out + i);
  if (i < n) {
    double rest[3 * HWY_MAX_BYTES / sizeof(double)], result[HWY_MAX_BYTES / sizeof(double)];
    for (std::size_t k = 0; k < lanes; ++k) {
      const std::size_t from = i + k < n ? i + k : i;
      for (std::size_t c = 0; c < 3; ++c) rest[3 * k + c] = points[3 * from + c];
    }
    hn::StoreU(one(rest), Tag(), result);
    for (std::size_t k = 0; i + k < n; ++k) out[i + k] = result[k];
  }
}

void products(const KernelFrame& frame, const double* points, const double* weights, std::size_t n, double* sums) {
  switch (frame.kind) {
    case ShapeKind::line2:
    case ShapeKind::plane:
      return add_products<Flat>(frame, points, weights, n, sums);
    case ShapeKind::line3:
      return add_products<AcrossLine>(frame, points, weights, n, sums);
    case ShapeKind::circle2:
    case ShapeKind::cylinder:
      return add_products<Radial>(frame, points, weights, n, sums);
    case ShapeKind::circle3:
      return add_products<Ring>(frame, points, weights, n, sums);
    case ShapeKind::sphere:
      return add_products<Spherical>(frame, points, weights, n, sums);
    case ShapeKind::cone:
      return add_products<Conical>(frame, points, weights, n, sums);
  }
}

void block_distances(const KernelFrame& frame, const double* points, std::size_t n, double* out) {
  switch (frame.kind) {
    case ShapeKind::line2:
    case ShapeKind::plane:
      return write_distances<Flat>(frame, points, n, out);
    case ShapeKind::line3:
      return write_distances<AcrossLine>(frame, points, n, out);
    case ShapeKind::circle2:
    case ShapeKind::cylinder:
      return write_distances<Radial>(frame, points, n, out);
    case ShapeKind::circle3:
      return write_distances<Ring>(frame, points, n, out);
    case ShapeKind::sphere:
      return write_distances<Spherical>(frame, points, n, out);
    case ShapeKind::cone:
      return write_distances<Conical>(frame, points, n, out);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace abbe::fits
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include "abbe/geometry/parallel_blocks.h"

namespace abbe::fits {
namespace {

HWY_EXPORT(products);
HWY_EXPORT(block_distances);

KernelFrame kernel_frame(const ShapeFrame& frame) {
  KernelFrame k{};
  k.kind = frame.kind;
  const Eigen::Vector3d origin = frame.axes.transpose() * frame.origin;
  for (int i = 0; i < 3; ++i) {
    k.centre[i] = frame.centre[i];
    k.origin[i] = origin[i];
    for (int j = 0; j < 3; ++j) k.axes[i][j] = frame.axes(j, i);
  }
  k.radius = frame.radius;
  k.sine = std::sin(frame.half_angle);
  k.cosine = std::cos(frame.half_angle);
  return k;
}

std::size_t block_count(std::size_t n) { return (n + kBlockPoints - 1) / kBlockPoints; }

/// Few points are not worth waking threads for.
int worth(int threads, std::size_t blocks) { return blocks < 8 ? 1 : threads; }

/// Which steps the slopes of a kind are, in the order of the kernels; the shapes of the plane share those of space.
std::vector<int> slots(ShapeKind kind) {
  const ShapeKind kernel = kind == ShapeKind::line2     ? ShapeKind::plane
                           : kind == ShapeKind::circle2 ? ShapeKind::cylinder
                                                        : kind;
  return free_parameters(kernel, {});
}

/// Sum with a running correction (Neumaier).
struct Sum {
  double value = 0, rest = 0;
  void add(double x) {
    const double next = value + x;
    rest += std::abs(value) >= std::abs(x) ? (value - next) + x : (x - next) + value;
    value = next;
  }
  double total() const { return value + rest; }
};

}  // namespace

NormalSums normal_sums(const ShapeFrame& frame, const FitPoints& points, std::span<const double> weights, int threads) {
  const KernelFrame kernel = kernel_frame(frame);
  const auto n = static_cast<std::size_t>(points.cols());
  const std::size_t blocks = block_count(n);
  std::vector<std::array<double, kProducts>> sums(blocks);
  for_each_block(blocks, worth(threads, blocks), [&](std::size_t block) {
    const std::size_t first = block * kBlockPoints, count = std::min(kBlockPoints, n - first);
    HWY_DYNAMIC_DISPATCH(products)
    (kernel, points.col(static_cast<Eigen::Index>(first)).data(), weights.empty() ? nullptr : weights.data() + first,
     count, sums[block].data());
  });
  const std::vector<int> slot = slots(frame.kind);
  const std::size_t columns = slot.size() + 1;
  NormalSums result;
  result.matrix.setZero();
  result.gradient.setZero();
  std::size_t pair = 0;
  for (std::size_t i = 0; i < columns; ++i) {
    for (std::size_t j = i; j < columns; ++j, ++pair) {
      Sum sum;
      for (const auto& block : sums) sum.add(block[pair]);
      if (j + 1 < columns) {
        result.matrix(slot[i], slot[j]) = result.matrix(slot[j], slot[i]) = sum.total();
      } else if (i + 1 < columns) {
        result.gradient[slot[i]] = sum.total();
      } else {
        result.squares = sum.total();
      }
    }
  }
  return result;
}

void distances(const ShapeFrame& frame, const FitPoints& points, std::span<double> out, int threads) {
  const KernelFrame kernel = kernel_frame(frame);
  const auto n = static_cast<std::size_t>(points.cols());
  const std::size_t blocks = block_count(n);
  for_each_block(blocks, worth(threads, blocks), [&](std::size_t block) {
    const std::size_t first = block * kBlockPoints, count = std::min(kBlockPoints, n - first);
    HWY_DYNAMIC_DISPATCH(block_distances)
    (kernel, points.col(static_cast<Eigen::Index>(first)).data(), count, out.data() + first);
  });
}

ExtremeDistances extreme_distances(const ShapeFrame& frame, const FitPoints& points, int threads) {
  const KernelFrame kernel = kernel_frame(frame);
  const auto n = static_cast<std::size_t>(points.cols());
  const std::size_t blocks = block_count(n);
  std::vector<ExtremeDistances> found(blocks);
  for_each_block(blocks, worth(threads, blocks), [&](std::size_t block) {
    const std::size_t first = block * kBlockPoints, count = std::min(kBlockPoints, n - first);
    std::array<double, kBlockPoints> d;
    HWY_DYNAMIC_DISPATCH(block_distances)
    (kernel, points.col(static_cast<Eigen::Index>(first)).data(), count, d.data());
    ExtremeDistances& e = found[block];
    e = {d[0], d[0], first, first};
    for (std::size_t i = 1; i < count; ++i) {
      if (d[i] < e.smallest) e.smallest = d[i], e.smallest_at = first + i;
      if (d[i] > e.largest) e.largest = d[i], e.largest_at = first + i;
    }
  });
  ExtremeDistances all = found.empty() ? ExtremeDistances{} : found[0];
  for (const ExtremeDistances& e : found) {
    if (e.smallest < all.smallest) all.smallest = e.smallest, all.smallest_at = e.smallest_at;
    if (e.largest > all.largest) all.largest = e.largest, all.largest_at = e.largest_at;
  }
  return all;
}

Centroid centroid(const FitPoints& points, const Eigen::Vector3d& centre, int threads) {
  struct Moments {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    bool finite = true;
  };
  const auto n = static_cast<std::size_t>(points.cols());
  const std::size_t blocks = block_count(n);
  std::vector<Moments> moments(blocks);
  for_each_block(blocks, worth(threads, blocks), [&](std::size_t block) {
    const std::size_t first = block * kBlockPoints, last = std::min(first + kBlockPoints, n);
    double s[9] = {};
    for (std::size_t i = first; i < last; ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      const double x = points(0, column) - centre.x(), y = points(1, column) - centre.y(),
                   z = points(2, column) - centre.z();
      s[0] += x;
      s[1] += y;
      s[2] += z;
      s[3] += x * x;
      s[4] += x * y;
      s[5] += x * z;
      s[6] += y * y;
      s[7] += y * z;
      s[8] += z * z;
    }
    Moments& m = moments[block];
    m.sum = {s[0], s[1], s[2]};
    m.products << s[3], s[4], s[5], s[4], s[6], s[7], s[5], s[7], s[8];
    m.finite = m.products.allFinite() && m.sum.allFinite();
  });
  Centroid result;
  Moments total;
  for (const Moments& m : moments) {
    total.sum += m.sum;
    total.products += m.products;
    result.finite = result.finite && m.finite;
  }
  if (n == 0 || !result.finite) return result;
  result.mean = total.sum / static_cast<double>(n);
  result.scatter = total.products / static_cast<double>(n) - result.mean * result.mean.transpose();
  return result;
}

}  // namespace abbe::fits

#endif  // HWY_ONCE
