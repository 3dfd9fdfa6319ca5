#include "abbe/report/pages/evaluation_files.h"

#include "abbe/formats/text/json_text.h"
#include "abbe/report/pages/evaluation_data.h"
#include "abbe/report/report.h"

namespace abbe {

std::vector<std::pair<std::string, std::string>> evaluation_files(const EvaluationReport& report) {
  std::vector<std::pair<std::string, std::string>> files;
  files.emplace_back("evaluation.json", json_text(evaluation_json(report)));
  for (const EvaluationPlot& plot : report.plots) files.emplace_back(plot.name + ".svg", plot.picture.wide);
  files.emplace_back("report.html",
                     report.page.is_object() ? report_page(evaluation_data(report)) : evaluation_page(report));
  return files;
}

}  // namespace abbe
