#include "abbe/geometry/fits/fit_choice.h"

namespace abbe {

ShapeFit fit_shape(const FitChoice& choice, const FitPoints& points) {
  switch (choice.method) {
    case FitMethod::least_squares:
      return least_squares_fit(choice.kind, points, choice.options);
    case FitMethod::minimum_zone:
      return extreme_fit(choice.kind, ExtremeKind::minimum_zone, points, choice.options);
    case FitMethod::circumscribed:
      return extreme_fit(choice.kind, ExtremeKind::circumscribed, points, choice.options);
    case FitMethod::inscribed:
      return extreme_fit(choice.kind, ExtremeKind::inscribed, points, choice.options);
    case FitMethod::robust:
      break;
  }
  return robust_fit(choice.kind, points, choice.robust, choice.options);
}

}  // namespace abbe
