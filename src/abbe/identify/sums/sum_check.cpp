#include "abbe/identify/sums/sum_check.h"

#include <fmt/format.h>

#include "abbe/geometry/cross_products.h"
#include "abbe/identify/sums/pose_sums.h"

namespace abbe {

bool is_size_of_values(SumKind kind, std::size_t size, std::size_t readings, std::size_t c, std::size_t p) {
  switch (kind) {
    case SumKind::cost:
      return size == 1;
    case SumKind::gradient:
      return size == 1 || size == 1 + c;
    case SumKind::normal:
      return size == 1 || size == 1 + c + c * (c + 1) / 2;
    case SumKind::norms:
      return size == readings;
    case SumKind::factor:
      return p == 0 ? size == 0 : size % p == 0 && size / p <= p;
    case SumKind::poses:
      return size == kPoseSumCount + c * c;
  }
  return false;
}

void check_sum(const SumOfReadings& sum, const SumRequest& request, const Problem& problem,
               const std::vector<ReadingPiece>& pieces, const std::vector<std::uint64_t>& fingerprints) {
  const auto refuse = [](const std::string& what) { throw SumError("the sum of the readings " + what); };
  if (sum.kind != request.kind)
    refuse(fmt::format("holds {}, not {}, for which it was asked", kind_words(sum.kind), kind_words(request.kind)));
  if (sum.pieces != pieces.size())
    refuse(fmt::format("is of another problem: {} pieces instead of {}", sum.pieces, pieces.size()));
  if (sum.range.first != 0 || sum.range.last != pieces.size() || sum.readings.size() != pieces.size() ||
      sum.values.size() != pieces.size())
    refuse(fmt::format("is incomplete: it begins with piece {} and ends before piece {} of {}", sum.range.first,
                       sum.range.last, pieces.size()));
  if (sum.processor != vector_instructions())
    refuse(
        fmt::format("was made with other vector instructions ({}) than this process uses ({}): its last bits would "
                    "depend on where it was made",
                    sum.processor, vector_instructions()));
  if (sum.selection != selection_fingerprint(request))
    refuse("is of another selection of parameters or readings, or of another loss");
  if (sum.point != point_fingerprint(request)) refuse("was made at other parameters");
  const std::size_t p = estimated_count(problem);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const SelectedObservations& selected = problem.observations[pieces[i].observations];
    if (sum.readings[i] != fingerprints[i])
      refuse(fmt::format("is of another problem: {} {} to {} of {} are others, or their model is",
                         sum.kind == SumKind::poses ? "poses" : "readings", pieces[i].first, pieces[i].last - 1,
                         selected.observations->name()));
    const std::size_t c = problem.machine_parameters.size() + selected.unknowns.size();
    if (!is_size_of_values(sum.kind, sum.values[i].size(), pieces[i].last - pieces[i].first, c, p))
      refuse(fmt::format("holds {} numbers for piece {}, which no {} of {} columns has", sum.values[i].size(), i,
                         kind_words(sum.kind), c));
  }
}

}  // namespace abbe
