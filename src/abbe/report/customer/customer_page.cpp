#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "abbe/report/customer/customer_notes.h"
#include "abbe/report/customer/customer_report.h"
#include "abbe/report/customer/customer_style.h"
#include "abbe/report/customer/customer_words.h"
#include "abbe/report/customer/local_numbers.h"
#include "abbe/report/drawings/svg_drawing.h"
#include "abbe/report/version.h"

namespace abbe {
namespace {

using Word = CustomerWord;

/// Parts of one report, in its language.
class CustomerPage {
 public:
  explicit CustomerPage(const CustomerReport& report) : report_(report), language_(report.facts.language) {}

  std::string html() const {
    std::string page = fmt::format(
        "<!doctype html>\n<html lang=\"{}\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"generator\" content=\"{}\">\n{}<title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n",
        language_code(language_), producer(), created(), xml_text(title()), customer_style(foot()));
    page += head() + warnings() + verdict() + figures() + drawings();
    for (const CustomerTable& table : report_.tables) page += detail_table(table);
    page += notes() + signatures();
    page += fmt::format("<p class=\"small\">{}", customer_text(Word::produced_by, language_, producer()));
    if (!report_.files.empty()) {
      page += fmt::format(" · {}{}", word(Word::files), colon());
      for (std::size_t i = 0; i < report_.files.size(); ++i) page += (i == 0 ? "" : ", ") + xml_text(report_.files[i]);
    }
    return page + "</p>\n</body>\n</html>\n";
  }

 private:
  static std::string producer() { return std::string("abbe ") + version_text(); }

  /// The day that a PDF of the page states as that on which it was made.
  std::string created() const {
    const std::optional<CalendarDate>& date = report_.facts.date;
    if (!date) return "";
    return fmt::format("<meta name=\"dcterms.created\" content=\"{}T00:00:00+00:00\">\n", calendar_date_text(*date));
  }

  std::string word(Word word) const { return xml_text(customer_word(word, language_)); }

  const char* colon() const {
    return language_ == ReportLanguage::chinese || language_ == ReportLanguage::japanese ? "：" : ": ";
  }

  std::string title() const {
    std::string text = std::string(customer_word(Word::report, language_)) + colon() + report_.subject;
    return report_.facts.number.empty() ? text : text + ", " + report_.facts.number;
  }

  /// At the foot of every sheet.
  std::string foot() const {
    std::string text = std::string(customer_word(Word::report, language_));
    if (!report_.facts.number.empty()) text += " " + report_.facts.number;
    if (!report_.facts.serial_number.empty()) {
      text += " · " + std::string(customer_word(Word::serial_number, language_)) + " " + report_.facts.serial_number;
    }
    return text;
  }

  std::string stated(const std::string& text) const {
    return text.empty() ? fmt::format("<i>{}</i>", word(Word::not_stated)) : xml_text(text);
  }

  std::string fact(Word name, const std::string& shown) const {
    return fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", word(name), shown);
  }

  std::string temperature() const {
    const ReportFacts& facts = report_.facts;
    std::string text;
    const auto degrees = [&](double value) { return local_number(value, 1, language_); };
    if (facts.temperature) text = customer_text(Word::temperature_mean, language_, degrees(*facts.temperature));
    if (facts.temperature_range) {
      text += (text.empty() ? "" : ", ") +
              customer_text(Word::temperature_range, language_,
                            {degrees((*facts.temperature_range)[0]), degrees((*facts.temperature_range)[1])});
    }
    return text;
  }

  std::string head() const {
    const ReportFacts& facts = report_.facts;
    std::string text =
        fmt::format("<header><h1>{}</h1><p>{}</p></header>\n<dl>\n", word(Word::report), xml_text(report_.subject));
    std::string customer = stated(facts.customer);
    if (!facts.customer_address.empty()) customer += "<br>" + xml_text(facts.customer_address);
    const std::string machine = facts.maker + (facts.maker.empty() || facts.model.empty() ? "" : " ") + facts.model;
    text += fact(Word::customer, customer) + fact(Word::report_number, stated(facts.number));
    text += fact(Word::machine, stated(machine)) + fact(Word::serial_number, stated(facts.serial_number));
    text += fact(Word::place, stated(facts.place)) + fact(Word::operator_name, stated(facts.operator_name));
    text += fact(Word::date, facts.date ? local_date(*facts.date, language_) : stated(""));
    text += fact(Word::temperature, stated(temperature()));
    text += fact(Word::standard, stated(facts.standard.empty() ? report_.standard : facts.standard));
    std::string remarks;
    for (const std::string& remark : facts.remarks) remarks += (remarks.empty() ? "" : "<br>") + xml_text(remark);
    if (!remarks.empty()) text += fact(Word::remarks, remarks);
    return text + "</dl>\n" + instruments();
  }

  std::string instruments() const {
    std::vector<std::vector<std::string>> rows;
    for (const ReportInstrument& instrument : report_.facts.instruments) {
      rows.push_back({xml_text(instrument.name), stated(instrument.serial_number), stated(instrument.certificate),
                      instrument.valid_until ? local_date(*instrument.valid_until, language_) : stated("")});
    }
    if (rows.empty()) return fmt::format("<h2>{}</h2>\n<p>{}</p>\n", word(Word::instruments), stated(""));
    return table(word(Word::instruments),
                 {word(Word::instrument), word(Word::serial_number), word(Word::certificate), word(Word::valid_until)},
                 rows, "texts");
  }

  /// @param cells  of a caption, headers and rows: HTML
  static std::string table(const std::string& caption, const std::vector<std::string>& headers,
                           const std::vector<std::vector<std::string>>& rows, const char* kind) {
    // A short table stays whole, so that no head is alone at the foot of a sheet.
    constexpr std::size_t kShort = 25;
    std::string text = fmt::format("<table class=\"{}{}\">\n<caption>{}</caption>\n<thead><tr>", kind,
                                   rows.size() <= kShort ? " short" : "", caption);
    for (const std::string& header : headers) text += "<th scope=\"col\">" + header + "</th>";
    text += "</tr></thead>\n<tbody>\n";
    for (const std::vector<std::string>& row : rows) {
      text += "<tr>";
      for (const std::string& cell : row) text += "<td>" + cell + "</td>";
      text += "</tr>\n";
    }
    return text + "</tbody>\n</table>\n";
  }

  std::string warnings() const {
    std::vector<std::string> lines;
    if (report_.is_simulated) lines.push_back(word(Word::simulated));
    if (!report_.refusals.empty()) lines.push_back(word(Word::must_not_be_used));
    for (const std::string& refusal : report_.refusals) {
      const std::optional<std::string> known = customer_note(refusal, language_);
      lines.push_back(known ? xml_text(*known) : fmt::format("<span lang=\"en\">{}</span>", xml_text(refusal)));
    }
    const std::string exceeded = exceeded_tolerances(report_);
    if (!exceeded.empty()) lines.push_back(xml_text(customer_text(Word::out_of_tolerance, language_, exceeded)));
    const std::optional<CalendarDate>& date = report_.facts.date;
    for (const ReportInstrument& instrument : report_.facts.instruments) {
      if (!date || !instrument.valid_until || *instrument.valid_until >= *date) continue;
      lines.push_back(xml_text(customer_text(Word::certificate_not_valid, language_, instrument.name)));
    }
    if (lines.empty()) return "";
    std::string text = "<section class=\"warning\">\n";
    for (const std::string& line : lines) text += "<p>" + line + "</p>\n";
    return text + "</section>\n";
  }

  static const char* kind_of(Conformity conformity) {
    switch (conformity) {
      case Conformity::proven:
        return "proven";
      case Conformity::nonconformity_proven:
        return "refuted";
      case Conformity::not_proven:
        return "open";
      case Conformity::not_judged:
        break;
    }
    return "none";
  }

  std::string verdict() const {
    std::string text = fmt::format("<section class=\"verdict\">\n<h2>{}</h2>\n", word(Word::verdict));
    for (std::size_t state = 0; state < report_.states.size(); ++state) {
      for (const auto& [conformity, sentence] : customer_verdict(report_, state)) {
        text += fmt::format("<p class=\"{}\">", kind_of(conformity));
        if (report_.states.size() > 1)
          text += fmt::format("<b>{}{}</b>", xml_text(report_.states[state].name), colon());
        text += xml_text(sentence) + "</p>\n";
      }
    }
    return text + fmt::format("<p class=\"small\">{}</p>\n</section>\n", word(Word::decision_rule));
  }

  std::string value_text(const CustomerFigure& figure, const CustomerValue& value) const {
    if (!value.value) return "–";
    std::string text = local_number(*value.value, figure.decimals, language_);
    if (value.expanded_uncertainty) {
      text += " ± " + local_number(*value.expanded_uncertainty, figure.decimals, language_);
    }
    return text;
  }

  Word short_verdict(std::size_t figure, std::size_t state) const {
    switch (customer_conformity(report_, figure, state)) {
      case Conformity::proven:
        return Word::short_conformity_proven;
      case Conformity::nonconformity_proven:
        return Word::short_nonconformity_proven;
      case Conformity::not_proven:
        return Word::short_not_proven;
      case Conformity::not_judged:
        break;
    }
    return Word::short_no_verdict;
  }

  std::string figures() const {
    if (report_.figures.empty()) return "";
    std::vector<std::string> headers = {word(Word::symbol), word(Word::figure)};
    for (const CustomerState& state : report_.states) headers.push_back(xml_text(state.name));
    headers.push_back("");
    headers.push_back(word(Word::tolerance));
    const bool has_tolerances = std::any_of(report_.figures.begin(), report_.figures.end(),
                                            [](const CustomerFigure& figure) { return figure.tolerance.has_value(); });
    std::vector<std::vector<std::string>> rows;
    for (std::size_t i = 0; i < report_.figures.size(); ++i) {
      const CustomerFigure& figure = report_.figures[i];
      std::vector<std::string> row = {xml_text(figure.symbol), xml_text(figure.name)};
      for (std::size_t state = 0; state < report_.states.size(); ++state) {
        std::string cell = value_text(figure, figure.states[state]);
        if (figure.tolerance && report_.states[state].no_verdict.empty()) {
          cell += fmt::format("<br><span class=\"{}\">{}</span>", kind_of(customer_conformity(report_, i, state)),
                              word(short_verdict(i, state)));
        }
        row.push_back(std::move(cell));
      }
      row.push_back(xml_text(figure.unit));
      row.push_back(figure.tolerance ? local_short_number(*figure.tolerance, language_) : "");
      rows.push_back(std::move(row));
    }
    if (!has_tolerances) {
      headers.pop_back();
      for (std::vector<std::string>& row : rows) row.pop_back();
    }
    std::string text = table(word(Word::figures), headers, rows, "figures");
    text += fmt::format("<p class=\"small\">{}", word(Word::uncertainty_note));
    for (const std::string& explanation : report_.explanations) text += " " + xml_text(explanation);
    return text + "</p>\n";
  }

  std::string drawings() const {
    std::string text;
    for (const CustomerDrawing& drawing : report_.drawings) {
      text += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                          local_drawing(svg_for_paper(drawing.svg), language_), xml_text(drawing.caption));
    }
    return text;
  }

  static std::string detail_table(const CustomerTable& shown) {
    const auto as_html = [](std::vector<std::string> cells) {
      for (std::string& cell : cells) cell = xml_text(cell);
      return cells;
    };
    std::vector<std::vector<std::string>> rows;
    std::transform(shown.rows.begin(), shown.rows.end(), std::back_inserter(rows), as_html);
    return table(xml_text(shown.caption), as_html(shown.headers), rows, "numbers");
  }

  std::string notes() const {
    if (report_.notes.empty() && report_.conditions.empty()) return "";
    const auto list = [](const std::vector<std::string>& lines, const char* attribute) {
      std::string text = fmt::format("<ul{}>\n", attribute);
      for (const std::string& line : lines) text += fmt::format("<li>{}</li>\n", xml_text(line));
      return text + "</ul>\n";
    };
    std::vector<std::string> known = report_.conditions, others;
    for (const std::string& note : report_.notes) {
      const std::optional<std::string> own = customer_note(note, language_);
      (own ? known : others).push_back(own.value_or(note));
    }
    std::string text = fmt::format("<section class=\"notes\">\n<h2>{}</h2>\n", word(Word::notes));
    if (!known.empty()) text += list(known, "");
    if (!others.empty()) {
      text += fmt::format("<p>{}{}</p>\n", word(Word::notes_in_english), colon()) + list(others, " lang=\"en\"");
    }
    return text + "</section>\n";
  }

  std::string signatures() const {
    std::string text = fmt::format("<section class=\"signatures\">\n<h2>{}</h2>\n<div>\n", word(Word::signatures));
    for (const Word who : {Word::tested_by, Word::accepted_by}) {
      text += fmt::format("<div><b>{}</b>\n", word(who));
      for (const Word line : {Word::place_and_date, Word::name, Word::signature}) {
        text += fmt::format("<p>{}</p>\n", word(line));
      }
      text += "</div>\n";
    }
    return text + "</div>\n</section>\n";
  }

  const CustomerReport& report_;
  ReportLanguage language_;
};

}  // namespace

std::string customer_page(const CustomerReport& report) { return CustomerPage(report).html(); }

}  // namespace abbe
