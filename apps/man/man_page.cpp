#include "man/man_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "completion/completion.h"

namespace abbe {
namespace {

/// What roff would take for its own is escaped; a hyphen is the one that is typed.
std::string roff(const std::string& text) {
  std::string result;
  bool at_start = true;
  for (const char c : text) {
    if (at_start && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c;
    }
    at_start = c == '\n';
  }
  return result;
}

std::string upper_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string page_name(std::string words) {
  std::replace(words.begin(), words.end(), ' ', '-');
  return words;
}

/// "\fB\-o\fR, \fB\-\-output\fR \fITEXT\fR"
std::string option_title(const OptionDescription& option) {
  std::string title;
  for (const std::string& name : option.names) title += (title.empty() ? "\\fB" : ", \\fB") + roff(name) + "\\fR";
  if (option.names.empty()) title = "\\fI" + roff(option.argument) + "\\fR";
  if (!option.takes_value() || option.names.empty()) return title;
  // "TEXT:{a,b}" is what is checked, and the words stand below.
  const std::string type = option.words.empty() ? option.type : option.type.substr(0, option.type.find(':'));
  return title + " \\fI" + roff(type) + "\\fR" + (option.repeatable ? " ..." : "");
}

std::string option_text(const OptionDescription& option) {
  std::string text = option.description;
  // Many descriptions name the words themselves.
  const bool named = std::all_of(option.words.begin(), option.words.end(),
                                 [&](const std::string& word) { return text.find(word) != std::string::npos; });
  if (!option.words.empty() && !named) text += fmt::format(" ({})", fmt::join(option.words, ", "));
  if (!option.default_value.empty()) text += fmt::format(" (default {})", option.default_value);
  if (option.required && !option.names.empty()) text += " (required)";
  return text;
}

std::string options_section(const std::string& heading, const std::vector<OptionDescription>& options) {
  if (options.empty()) return "";
  std::string text = ".SH " + heading + "\n";
  for (const OptionDescription& option : options) {
    text += ".TP\n" + option_title(option) + "\n" + roff(option_text(option)) + "\n";
  }
  return text;
}

std::string synopsis(const TypedCommand& one) {
  std::string text = fmt::format(".SH SYNOPSIS\n\\fB{}\\fR [\\fIoptions\\fR]", roff(one.words));
  if (!one.command->subcommands.empty()) text += " \\fIcommand\\fR";
  for (const OptionDescription& argument : one.command->arguments) {
    const std::string name = "\\fI" + roff(argument.argument) + "\\fR" + (argument.repeatable ? " ..." : "");
    text += argument.required ? " " + name : " [" + name + "]";
  }
  return text + "\n";
}

std::string commands_section(const TypedCommand& one) {
  if (one.command->subcommands.empty()) return "";
  std::string text = ".SH COMMANDS\n", section;
  for (const CommandDescription& command : one.command->subcommands) {
    if (command.section != section && command.section != "Subcommands") {
      section = command.section;
      text += ".SS " + roff(section) + "\n";
    }
    text += fmt::format(".TP\n\\fB{}\\fR(1)\n{}\n", roff(page_name(one.words + " " + command.name)),
                        roff(command.description));
  }
  return text;
}

std::vector<std::string> lines_of_text(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

/// "Example:", on a line of its own, is a heading of the text at the end of a help.
bool is_footer_heading(const std::string& line) {
  return line.size() > 1 && line.size() < 30 && line.front() != ' ' && line.back() == ':';
}

/// The text at the end of the help: its headings become sections, its indented lines stay as they are.
std::string footer_sections(const std::string& footer) {
  std::string text;
  bool in_section = false, in_examples = false, as_it_is = false, blank = false;
  const auto keep_lines = [&](bool keep) {
    if (keep != as_it_is) text += keep ? ".nf\n" : ".fi\n";
    as_it_is = keep;
  };
  for (const std::string& line : lines_of_text(footer)) {
    if (line.empty()) {
      blank = true;
      continue;
    }
    if (is_footer_heading(line)) {
      keep_lines(false);
      text += ".SH " + upper_case(roff(line.substr(0, line.size() - 1))) + "\n";
      in_section = true;
      in_examples = line.starts_with("Example");
      blank = false;
      continue;
    }
    if (!in_section || (in_examples && blank && line.front() != ' ')) {
      keep_lines(false);
      text += ".SH NOTES\n";
      in_section = true;
      in_examples = blank = false;
    }
    keep_lines(line.front() == ' ');
    if (blank) text += as_it_is ? "\n" : ".PP\n";
    blank = false;
    text += roff(as_it_is ? line.substr(std::min<std::size_t>(2, line.find_first_not_of(' '))) : line) + "\n";
  }
  keep_lines(false);
  return text;
}

std::string parent_page(const std::string& words) { return page_name(words.substr(0, words.rfind(' '))); }

}  // namespace

std::vector<ManPage> man_pages(const CommandDescription& program, const std::string& version, const std::string& date) {
  std::vector<ManPage> pages;
  for (const TypedCommand& one : all_commands(program)) {
    const CommandDescription& command = *one.command;
    const std::string name = page_name(one.words);
    std::string text = fmt::format(".TH {} 1 {} \"Abbe {}\" \"Abbe\"\n", upper_case(roff(name)), date, version);
    text += fmt::format(".SH NAME\n{} \\- {}\n", roff(name), roff(command.description));
    text += synopsis(one) + options_section("ARGUMENTS", command.arguments) + commands_section(one) +
            options_section("OPTIONS", command.options) + footer_sections(command.footer);
    if (&command != &program) text += fmt::format(".SH SEE ALSO\n\\fB{}\\fR(1)\n", roff(parent_page(one.words)));
    pages.push_back({name, text});
  }
  return pages;
}

}  // namespace abbe
