#include "abbe/formats/files/printed_page.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

#include "abbe/formats/files/child_process.h"
#include "abbe/formats/files/interruption.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBrowserVariable = "ABBE_BROWSER";
constexpr const char* kBrowserNames[] = {"chromium", "chromium-browser", "google-chrome", "google-chrome-stable",
                                         "chromium-headless-shell"};
constexpr std::size_t kLongestMessage = 300;

bool is_program(const fs::path& path) {
  std::error_code ignored;
  return ::access(path.c_str(), X_OK) == 0 && fs::is_regular_file(path, ignored);
}

/// Empty if no folder of the PATH has it.
fs::path program_on_path(const char* name) {
  const char* const path = std::getenv("PATH");
  const std::string folders = path != nullptr ? path : "";
  for (std::size_t begin = 0; begin <= folders.size();) {
    const std::size_t end = std::min(folders.find(':', begin), folders.size());
    const fs::path found = fs::path(folders.substr(begin, end - begin)) / name;
    if (end > begin && is_program(found)) return found;
    begin = end + 1;
  }
  return {};
}

/// Whether fontconfig says that no font has the letters of a language; where it cannot be asked, one is assumed.
bool lacks_font(const std::string& language) {
  if (language != "zh" && language != "ja") return false;
  const fs::path asked = program_on_path("fc-list");
  if (asked.empty()) return false;
  constexpr double kMostSeconds = 60;  // a cache of fonts may have to be made
  const ChildProcess process({asked.string(), ":lang=" + std::string(language == "zh" ? "zh-cn" : "ja"), "family"},
                             kMostSeconds);
  return !process.timed_out() && process.exit_code() == 0 && process.output().empty();
}

/// A new folder that is removed with all in it, also by an interruption.
class TemporaryPlace {
 public:
  TemporaryPlace() {
    std::string name = (fs::temp_directory_path() / "abbe-print-XXXXXX").string();
    const UninterruptedSteps together;
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder can be made for printing");
    path_ = name;
    noted_.emplace(path_);
  }
  ~TemporaryPlace() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryPlace(const TemporaryPlace&) = delete;
  TemporaryPlace& operator=(const TemporaryPlace&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
  std::optional<UnfinishedPath> noted_;
};

std::vector<std::string> browser_command(const fs::path& browser, const fs::path& folder) {
  std::vector<std::string> words = {
      browser.string(), "--headless", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
      "--no-default-browser-check", "--disable-extensions", "--disable-sync", "--disable-breakpad",
      "--disable-background-networking", "--disable-component-update", "--disable-default-apps",
      // Nothing is fetched: the page names no other file, and no name has an address.
      "--host-resolver-rules=MAP * ~NOTFOUND", "--user-data-dir=" + (folder / "profile").string(),
      "--no-pdf-header-footer", "--print-to-pdf=" + (folder / "page.pdf").string()};
  // Chromium refuses to run as root with its sandbox.
  if (::geteuid() == 0) words.emplace_back("--no-sandbox");
  words.push_back("file://" + (folder / "page.html").string());
  return words;
}

/// The last line that a browser said, for messages.
std::string last_line(std::string_view messages) {
  while (!messages.empty() && std::isspace(static_cast<unsigned char>(messages.back())) != 0) messages.remove_suffix(1);
  const std::size_t begin = messages.rfind('\n');
  return printable(begin == std::string_view::npos ? messages : messages.substr(begin + 1), kLongestMessage,
                   LineFeeds::escaped);
}

std::string contents_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace

fs::path find_browser() {
  if (const char* named = std::getenv(kBrowserVariable); named != nullptr && *named != '\0') {
    if (is_program(named)) return named;
    throw InputError({.field = kBrowserVariable}, fmt::format("{} is not a program", named),
                     "the path of Chromium, or no such variable");
  }
  for (const char* name : kBrowserNames) {
    const fs::path found = program_on_path(name);
    if (!found.empty()) return found;
  }
  return {};
}

PrintedPage print_page(const std::string& html, const PrintSettings& settings) {
  PrintedPage printed;
  const fs::path browser = find_browser();
  if (browser.empty()) {
    printed.problem = fmt::format(
        "no browser that prints is installed: install chromium (Debian: apt-get install chromium fonts-noto-cjk), or "
        "let {} name one",
        kBrowserVariable);
    return printed;
  }
  if (lacks_font(settings.language)) {
    printed.problem = fmt::format(
        "no font with the letters of the language \"{}\" is installed: install one (Debian: apt-get install "
        "fonts-noto-cjk)",
        settings.language);
    return printed;
  }
  const TemporaryPlace place;
  std::ofstream(place.path() / "page.html", std::ios::binary) << html;
  const ChildProcess process(browser_command(browser, place.path()), settings.most_seconds, {},
                             ChildProcess::Group::own);
  if (process.timed_out()) {
    printed.problem = fmt::format("{} did not finish within {:g} s", browser.string(), settings.most_seconds);
    return printed;
  }
  std::string pdf = contents_of(place.path() / "page.pdf");
  const bool is_whole = pdf.starts_with("%PDF-") && pdf.rfind("%%EOF") != std::string::npos;
  printed.pages = is_whole ? pdf_page_count(pdf) : 0;
  if (process.signal() != 0 || process.exit_code() != 0 || printed.pages == 0) {
    const std::string said = last_line(process.messages());
    printed.problem = fmt::format("{} ended with {} and printed no PDF{}", browser.string(),
                                  process.signal() != 0 ? fmt::format("signal {}", process.signal())
                                                        : fmt::format("exit code {}", process.exit_code()),
                                  said.empty() ? "" : ": " + said);
    printed.pages = 0;
    return printed;
  }
  set_pdf_date(settings.date, pdf);
  printed.pdf = std::move(pdf);
  return printed;
}

std::size_t pdf_page_count(const std::string& pdf) {
  constexpr std::string_view kTree = "/Type /Pages", kCount = "/Count ";
  std::size_t most = 0;
  for (std::size_t at = pdf.find(kTree); at != std::string::npos; at = pdf.find(kTree, at + 1)) {
    const std::size_t end = pdf.find("endobj", at);
    const std::size_t count = pdf.find(kCount, at);
    if (count == std::string::npos || count > end) continue;
    most = std::max<std::size_t>(most, std::strtoul(pdf.c_str() + count + kCount.size(), nullptr, 10));
  }
  return most;
}

void set_pdf_date(const std::string& date, std::string& pdf) {
  for (const std::string_view key : {"/CreationDate", "/ModDate"}) {
    for (std::size_t at = pdf.find(key); at != std::string::npos; at = pdf.find(key, at + key.size())) {
      const std::size_t begin = pdf.find_first_not_of(' ', at + key.size());
      if (begin == std::string::npos || pdf.compare(begin, 3, "(D:") != 0) continue;
      const std::size_t end = pdf.find(')', begin);
      if (end == std::string::npos) continue;
      if (date.empty()) {
        pdf.replace(at, end + 1 - at, end + 1 - at, ' ');
        continue;
      }
      std::string text = "(D:" + date + "000000+00'00'";
      text.resize(end - begin, ' ');
      pdf.replace(begin, end - begin, text);
    }
  }
}

}  // namespace abbe
