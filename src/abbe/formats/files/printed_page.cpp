#include "abbe/formats/files/printed_page.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <map>
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
constexpr const char* kWeasyPrint = "weasyprint";
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

/// A program with its options and what its environment has to have.
struct PrintCommand {
  std::vector<std::string> words, variables;
};

PrintCommand browser_command(const fs::path& browser, const fs::path& folder) {
  std::vector<std::string> words = {
      browser.string(), "--headless", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
      "--no-default-browser-check", "--disable-extensions", "--disable-sync", "--disable-breakpad",
      "--disable-background-networking", "--disable-component-update", "--disable-default-apps",
      // Nothing is fetched: the page names no other file, and no name has an address.
      "--host-resolver-rules=MAP * ~NOTFOUND", "--user-data-dir=" + (folder / "profile").string(),
      "--crash-dumps-dir=" + (folder / "crashes").string(), "--no-pdf-header-footer",
      "--print-to-pdf=" + (folder / "page.pdf").string()};
  // Chromium refuses to run as root with its sandbox.
  if (::geteuid() == 0) words.emplace_back("--no-sandbox");
  words.push_back("file://" + (folder / "page.html").string());
  // It makes a folder for a socket beside its profile, and leaves it when it is killed. A path that is too long for a
  // socket ends it.
  constexpr std::string_view kSocket = "/org.chromium.Chromium.XXXXXX/SingletonSocket";
  if (folder.string().size() + kSocket.size() >= sizeof(sockaddr_un::sun_path)) return {words, {}};
  return {words, {"TMPDIR=" + folder.string()}};
}

PrintCommand weasyprint_command(const fs::path& program, const fs::path& folder) {
  return {{program.string(), "--encoding", "utf-8", (folder / "page.html").string(), (folder / "page.pdf").string()},
          // Fonts state when they were made smaller: by the clock, unless the environment says when. Its own temporary
          // files are removed with the folder.
          {"SOURCE_DATE_EPOCH=0", "TMPDIR=" + folder.string()}};
}

void write_page(const fs::path& path, const std::string& html) {
  std::ofstream file(path, std::ios::binary);
  file << html;
  file.close();
  // A part of a page would be printed as if it were the whole.
  if (!file) throw std::runtime_error(fmt::format("{} cannot be written", path.string()));
}

/// The last line that a program said, for messages.
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

std::size_t largest_page_tree(std::string_view objects) {
  constexpr std::string_view kTree = "/Type /Pages", kCount = "/Count ";
  std::size_t most = 0;
  for (std::size_t at = objects.find(kTree); at != std::string_view::npos; at = objects.find(kTree, at + 1)) {
    const std::size_t end = objects.find("endobj", at);
    const std::size_t count = objects.find(kCount, at);
    if (count == std::string_view::npos || count > end) continue;
    std::size_t pages = 0;
    const std::string_view digits = objects.substr(count + kCount.size());
    std::from_chars(digits.data(), digits.data() + digits.size(), pages);
    most = std::max(most, pages);
  }
  return most;
}

/// The objects that newer versions of WeasyPrint pack together; empty if they cannot be unpacked.
/// @param at  within the dictionary of their stream
std::string unpacked_objects(const std::string& pdf, std::size_t at) {
  constexpr std::string_view kBegin = "stream\n";
  const std::size_t word = pdf.find(kBegin, at), begin = word + kBegin.size();
  const std::size_t end = word == std::string::npos ? word : pdf.find("endstream", begin);
  if (end == std::string::npos) return "";
  constexpr std::size_t kMost = std::size_t{1} << 26U;
  for (std::size_t size = 16 * (end - begin) + 1024; size <= kMost; size *= 4) {
    std::string objects(size, '\0');
    uLongf written = size;
    const int code = ::uncompress(reinterpret_cast<Bytef*>(objects.data()), &written,
                                  reinterpret_cast<const Bytef*>(pdf.data() + begin), end - begin);
    if (code == Z_BUF_ERROR) continue;
    objects.resize(code == Z_OK ? written : 0);
    return objects;
  }
  return "";
}

constexpr std::string_view kNode = "(node";
constexpr std::size_t kNodeDigits = 8;

/// Where the digits of a node's number begin, from `at` on; npos: nowhere.
std::size_t find_node(const std::string& pdf, std::size_t at) {
  for (at = pdf.find(kNode, at); at != std::string::npos; at = pdf.find(kNode, at + 1)) {
    const std::size_t begin = at + kNode.size(), end = begin + kNodeDigits;
    if (end >= pdf.size() || pdf[end] != ')') continue;
    const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
    if (std::all_of(pdf.data() + begin, pdf.data() + end, is_digit)) return begin;
  }
  return std::string::npos;
}

}  // namespace

PagePrinter find_page_printer() {
  if (const char* named = std::getenv(kBrowserVariable); named != nullptr && *named != '\0') {
    if (!is_program(named)) {
      throw InputError({.field = kBrowserVariable}, fmt::format("{} is not a program", named),
                       "the path of Chromium or WeasyPrint, or no such variable");
    }
    const bool is_weasyprint = fs::path(named).filename().string().starts_with(kWeasyPrint);
    return {named, is_weasyprint ? PagePrinter::Kind::weasyprint : PagePrinter::Kind::browser};
  }
  for (const char* name : kBrowserNames) {
    const fs::path found = program_on_path(name);
    if (!found.empty()) return {found, PagePrinter::Kind::browser};
  }
  return {program_on_path(kWeasyPrint), PagePrinter::Kind::weasyprint};
}

PrintedPage print_page(const std::string& html, const PrintSettings& settings) {
  PrintedPage printed;
  const PagePrinter printer = find_page_printer();
  if (printer.program.empty()) {
    printed.problem = fmt::format(
        "no program that prints pages is installed: install chromium or weasyprint (Debian: apt-get install chromium "
        "fonts-noto-cjk, or apt-get install weasyprint fonts-noto-cjk), or let {} name one",
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
  write_page(place.path() / "page.html", html);
  const PrintCommand command = printer.kind == PagePrinter::Kind::weasyprint
                                   ? weasyprint_command(printer.program, place.path())
                                   : browser_command(printer.program, place.path());
  const ChildProcess process(command.words, settings.most_seconds, {}, ChildProcess::Group::own, command.variables);
  if (process.timed_out()) {
    printed.problem = fmt::format("{} did not finish within {:g} s", printer.program.string(), settings.most_seconds);
    return printed;
  }
  std::string pdf = contents_of(place.path() / "page.pdf");
  const bool is_whole = pdf.starts_with("%PDF-") && pdf.rfind("%%EOF") != std::string::npos;
  printed.pages = is_whole ? pdf_page_count(pdf) : 0;
  if (process.signal() != 0 || process.exit_code() != 0 || printed.pages == 0) {
    const std::string said = last_line(process.messages());
    printed.problem = fmt::format("{} ended with {} and printed no PDF{}", printer.program.string(),
                                  process.signal() != 0 ? fmt::format("signal {}", process.signal())
                                                        : fmt::format("exit code {}", process.exit_code()),
                                  said.empty() ? "" : ": " + said);
    printed.pages = 0;
    return printed;
  }
  set_pdf_date(settings.date, pdf);
  number_pdf_nodes(pdf);
  printed.pdf = std::move(pdf);
  return printed;
}

std::size_t pdf_page_count(const std::string& pdf) {
  std::size_t most = largest_page_tree(pdf);
  constexpr std::string_view kPacked = "/Type /ObjStm";
  for (std::size_t at = pdf.find(kPacked); at != std::string::npos; at = pdf.find(kPacked, at + 1)) {
    most = std::max(most, largest_page_tree(unpacked_objects(pdf, at)));
  }
  return most;
}

void set_pdf_date(const std::string& date, std::string& pdf) {
  // Whole moments of the format, from the most exact to the day alone: as much as there is room for.
  const std::string moments[] = {"D:" + date + "000000+00'00'", "D:" + date + "000000", "D:" + date};
  for (const std::string_view key : {"/CreationDate", "/ModDate"}) {
    for (std::size_t at = pdf.find(key); at != std::string::npos; at = pdf.find(key, at + key.size())) {
      const std::size_t open = pdf.find_first_not_of(' ', at + key.size());
      if (open == std::string::npos || pdf[open] != '(') continue;
      const std::size_t begin = open + 1, end = pdf.find(')', begin);
      const bool is_moment = pdf.compare(begin, 2, "D:") == 0 || std::isdigit(static_cast<unsigned char>(pdf[begin]));
      if (end == std::string::npos || !is_moment) continue;
      if (date.empty()) {
        pdf.replace(at, end + 1 - at, end + 1 - at, ' ');
        continue;
      }
      for (std::string moment : moments) {
        if (moment.size() > end - begin) continue;
        moment.resize(end - begin, ' ');
        pdf.replace(begin, end - begin, moment);
        break;
      }
    }
  }
}

void number_pdf_nodes(std::string& pdf) {
  std::map<std::string, std::size_t> numbers;
  for (std::size_t at = find_node(pdf, 0); at != std::string::npos; at = find_node(pdf, at)) {
    numbers.emplace(pdf.substr(at, kNodeDigits), 0);
  }
  std::size_t next = 0;
  for (auto& [node, number] : numbers) number = ++next;
  for (std::size_t at = find_node(pdf, 0); at != std::string::npos; at = find_node(pdf, at)) {
    pdf.replace(at, kNodeDigits, fmt::format("{:08}", numbers.at(pdf.substr(at, kNodeDigits))));
  }
}

}  // namespace abbe
