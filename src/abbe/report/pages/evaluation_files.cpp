#include "abbe/report/pages/evaluation_files.h"

#include "abbe/formats/text/json_text.h"

namespace abbe {

std::vector<std::pair<std::string, std::string>> evaluation_files(const EvaluationReport& report) {
  std::vector<std::pair<std::string, std::string>> files;
  files.emplace_back("evaluation.json", json_text(evaluation_json(report)));
  for (const EvaluationPlot& plot : report.plots) files.emplace_back(plot.name + ".svg", plot.picture.wide);
  files.emplace_back("report.html", evaluation_page(report));
  return files;
}

}  // namespace abbe
