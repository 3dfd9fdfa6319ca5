#include <abbe/report/words/evaluation_text.h>
#include <abbe/study/fitted_points.h>

#include <cstdio>
#include <utility>

int main(int /*argc*/, char** arguments) {
  abbe::ShapeFitRequest request;
  request.points = abbe::read_points_to_fit(arguments[1]);
  request.choice.kind = abbe::ShapeKind::cylinder;
  request.choice.method = abbe::FitMethod::minimum_zone;
  abbe::FittedShape fitted = abbe::fit_points(std::move(request));
  abbe::apply_tolerances({"form_um=20"}, fitted.report);
  std::fputs(abbe::evaluation_text(fitted.report).c_str(), stdout);
  return fitted.is_ok() && !fitted.report.exceeds_tolerance() ? 0 : 1;
}
