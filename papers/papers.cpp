#include "papers.h"

namespace abbe {

int reproduce_paper(const ReproduceOptions& options) {
  if (options.paper == "yin") return reproduce_yin(options);
  if (options.paper == "liu") return reproduce_liu(options);
  if (options.paper == "ma") return reproduce_ma(options);
  return options.paper == "wang" ? reproduce_wang(options) : reproduce_aguado(options);
}

}  // namespace abbe
