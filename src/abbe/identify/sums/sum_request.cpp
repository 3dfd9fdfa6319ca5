#include "abbe/identify/sums/sum_request.h"

#include "abbe/identify/sums/byte_stream.h"

namespace abbe {
namespace {

const std::string kRequestFormat = "request for sums of readings";
constexpr std::uint64_t kRequestVersion = 1;
static_assert(sizeof(std::size_t) == sizeof(std::uint64_t));

void put_point(ByteWriter& out, const ReadingPoint& point) {
  out.put(point.machine);
  out.put(std::uint64_t{point.setups.size()});
  for (const std::vector<double>& setup : point.setups) out.put(setup);
}

ReadingPoint point_from(ByteReader& in) {
  ReadingPoint point;
  point.machine = in.reals();
  point.setups.resize(in.length(8));
  for (std::vector<double>& setup : point.setups) setup = in.reals();
  return point;
}

void put_selection(ByteWriter& out, const SumRequest& request) {
  out.put(static_cast<std::uint64_t>(request.loss.kind));
  out.put(request.loss.tuning);
  out.put(request.loss.scale);
  out.put(request.machine_parameters);
  out.put(std::uint64_t{request.setups.size()});
  for (const SetupSelection& setup : request.setups) {
    out.put(setup.unknowns);
    out.put(setup.use);
    out.put(std::uint64_t{setup.weighed});
    out.put(setup.weights.variance.factor);
    out.put(setup.weights.variance.pose);
    out.put(std::uint64_t{setup.weights.is_known});
    out.put(setup.weights.machine);
    out.put(setup.weights.setup);
  }
  out.put(request.covariance);
}

void take_selection(ByteReader& in, SumRequest& request) {
  request.loss.kind = static_cast<LossKind>(in.number_up_to(static_cast<std::uint64_t>(LossKind::tukey)));
  request.loss.tuning = in.real();
  request.loss.scale = in.real();
  request.machine_parameters = in.numbers();
  constexpr std::size_t kLeast = 8 * 8;  // a set-up without anything
  request.setups.resize(in.length(kLeast));
  for (SetupSelection& setup : request.setups) {
    setup.unknowns = in.numbers();
    setup.use = in.small_numbers();
    setup.weighed = in.number_up_to(1) != 0;
    setup.weights.variance.factor = in.real();
    setup.weights.variance.pose = in.real();
    setup.weights.is_known = in.number_up_to(1) != 0;
    setup.weights.machine = in.reals();
    setup.weights.setup = in.reals();
  }
  request.covariance = in.reals();
}

}  // namespace

std::vector<std::byte> to_bytes(const SumRequest& request) {
  ByteWriter out;
  out.put(kRequestFormat);
  out.put(kRequestVersion);
  out.put(static_cast<std::uint64_t>(request.kind));
  out.put(std::uint64_t{request.pieces});
  put_selection(out, request);
  put_point(out, request.point);
  put_point(out, request.reference);
  return out.finish();
}

SumRequest request_from_bytes(std::span<const std::byte> bytes) {
  ByteReader in(bytes, kRequestFormat, kRequestVersion);
  SumRequest request;
  request.kind = static_cast<SumKind>(in.number_up_to(static_cast<std::uint64_t>(SumKind::poses)));
  request.pieces = in.number();
  take_selection(in, request);
  request.point = point_from(in);
  request.reference = point_from(in);
  in.end();
  return request;
}

std::uint64_t point_fingerprint(const SumRequest& request) {
  ByteWriter out;
  put_point(out, request.point);
  return out.digest();
}

std::uint64_t selection_fingerprint(const SumRequest& request) {
  ByteWriter out;
  put_selection(out, request);
  return out.digest();
}

const char* kind_words(SumKind kind) {
  switch (kind) {
    case SumKind::cost:
      return "cost";
    case SumKind::gradient:
      return "gradient";
    case SumKind::normal:
      return "normal equations";
    case SumKind::norms:
      return "norms";
    case SumKind::factor:
      return "orthogonal factor";
    case SumKind::poses:
      return "sums over poses";
  }
  return "unknown";
}

}  // namespace abbe
