#include "abbe/identify/sums/factored_sums.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "abbe/geometry/cross_products.h"
#include "abbe/instruments/observations.h"

namespace abbe {
namespace {

static_assert(FactoredSums::kStride >= Observations::kBlockSize);

std::size_t triangle_place(std::size_t n, std::size_t i, std::size_t j) {
  if (i > j) std::swap(i, j);
  return i * n - i * (i + 1) / 2 + j;
}

/// Number of carriers of one group that are multiplied together, so that their products fill tiles and stay in the
/// first-level cache.
std::size_t carriers_at_once(std::size_t others) { return others <= 3 ? 8 : others <= 8 ? 4 : others <= 16 ? 2 : 1; }

}  // namespace

FactoredSums::FactoredSums(FactoredColumns form, std::size_t rows) : form_(std::move(form)), rows_(rows) {
  groups_ = carrier_groups(form_, rows);
  quicker_ = operations_of_groups(form_, groups_, rows) < operations_of_columns(form_.columns.size(), rows);
  if (!quicker_) return;
  const std::size_t residuals = groups_.size();
  groups_.push_back({{form_.carriers()}, {form_.bases()}});
  for (Layout* layout : {&normal_, &gradient_}) layout->first_part.resize(groups_.size() * groups_.size());
  for (std::size_t a = 0; a < residuals; ++a) {
    for (std::size_t b = a; b < residuals; ++b) add_parts(a, b, normal_);
    add_parts(a, residuals, gradient_);
  }

  std::vector<Place> carrier_place(form_.carriers() + 1);
  for (std::size_t g = 0; g < residuals; ++g)
    for (std::size_t i = 0; i < groups_[g].carriers.size(); ++i) carrier_place[groups_[g].carriers[i]] = {g, i, 0};
  const auto place = [&](std::size_t carrier, std::size_t basis) {
    Place found = carrier_place[carrier];
    const std::vector<std::size_t>& bases = groups_[found.group].bases;
    found.basis = static_cast<std::size_t>(
        std::lower_bound(bases.begin(), bases.end(), std::min(basis, form_.bases())) - bases.begin());
    return found;
  };
  std::vector<Place> places;
  for (const FactoredColumns::Column& column : form_.columns) places.push_back(place(column.carrier, column.basis));
  const Place of_residuals = place(form_.carriers(), FactoredColumns::kOne);
  for (std::size_t i = 0; i < places.size(); ++i) {
    gradient_.gradient.push_back(source(gradient_, places[i], {residuals, 0, 0}));
    normal_.gradient.push_back(source(normal_, places[i], of_residuals));
    for (std::size_t j = i; j < places.size(); ++j) normal_.normal.push_back(source(normal_, places[i], places[j]));
  }
}

void FactoredSums::add_parts(std::size_t a, std::size_t b, Layout& layout) {
  const std::size_t carriers = groups_[a].carriers.size(), others = groups_[b].carriers.size();
  const std::size_t bases = groups_[a].bases.size();
  layout.first_part[a * groups_.size() + b] = layout.parts.size();
  const std::size_t step = carriers_at_once(others);
  for (std::size_t begin = 0; begin < carriers; begin += step) {
    Part part{a, b, begin, std::min(carriers, begin + step), 0, 0, layout.size};
    part.p = a == b ? bases * (bases + 1) / 2 : bases * groups_[b].bases.size();
    for (std::size_t i = part.begin; i < part.end; ++i) part.w += a == b ? carriers - i : others;
    const std::size_t w = padded(part.w, kColumnMultiple), p = padded(part.p, 2);
    layout.size += w * p;
    scratch_w_ = std::max(scratch_w_, w);
    scratch_p_ = std::max(scratch_p_, p);
    layout.parts.push_back(part);
  }
}

std::uint32_t FactoredSums::source(const Layout& layout, Place x, Place y) const {
  if (x.group > y.group) std::swap(x, y);
  const bool same = x.group == y.group;
  if (same && x.carrier > y.carrier) std::swap(x.carrier, y.carrier);
  const std::size_t carriers = groups_[x.group].carriers.size(), others = groups_[y.group].carriers.size();
  const std::size_t bases = groups_[y.group].bases.size();
  const Part& part =
      layout.parts[layout.first_part[x.group * groups_.size() + y.group] + x.carrier / carriers_at_once(others)];
  assert(part.begin <= x.carrier && x.carrier < part.end);
  const std::size_t w =
      same ? triangle_place(carriers, x.carrier, y.carrier) - triangle_place(carriers, part.begin, part.begin)
           : (x.carrier - part.begin) * others + y.carrier;
  const std::size_t p = same ? triangle_place(bases, x.basis, y.basis) : x.basis * bases + y.basis;
  return static_cast<std::uint32_t>(part.offset + w + p * padded(part.w, kColumnMultiple));
}

void FactoredSums::add(bool normal, const double* carriers, std::size_t stride, const double* bases, std::size_t count,
                       double* scratch, double* sums) const {
  const std::size_t length = padded(count, kLengthMultiple);
  double* const w_columns = scratch;
  double* const p_columns = scratch + scratch_w_ * kStride;
  std::vector<const double*> left, right;
  const auto point_at = [](const std::vector<std::size_t>& numbers, const double* columns, std::size_t length_of_column,
                           std::vector<const double*>& out) {
    out.clear();
    for (const std::size_t number : numbers) out.push_back(columns + number * length_of_column);
  };
  for (const Part& part : normal ? normal_.parts : gradient_.parts) {
    const CarrierGroup &a = groups_[part.a], &b = groups_[part.b];
    const bool same = part.a == part.b;
    if (part.begin == 0) {
      point_at(a.bases, bases, kStride, left);
      point_at(b.bases, bases, kStride, right);
      fold_products(left.data(), 0, left.size(), right.data(), right.size(), same, 1, length, p_columns, kStride);
      point_at(a.carriers, carriers, stride, left);
      point_at(b.carriers, carriers, stride, right);
    }
    fold_products(left.data(), part.begin, part.end, right.data(), right.size(), same, rows_, count, w_columns,
                  kStride);
    // Whatever was written after the last reading must not count.
    if (length > count)
      for (std::size_t w = 0; w < part.w; ++w)
        std::fill(w_columns + w * kStride + count, w_columns + w * kStride + length, 0.0);
    const std::size_t w = padded(part.w, kColumnMultiple);
    add_cross_products(w_columns, w, kStride, p_columns, padded(part.p, 2), kStride, length, sums + part.offset, w);
  }
}

void FactoredSums::append(bool normal, const std::vector<double>& sums, std::vector<double>& values) const {
  const Layout& layout = normal ? normal_ : gradient_;
  values.reserve(values.size() + layout.gradient.size() + layout.normal.size());
  for (const std::uint32_t from : layout.gradient) values.push_back(sums[from]);
  for (const std::uint32_t from : layout.normal) values.push_back(sums[from]);
}

}  // namespace abbe
