// SPDX-License-Identifier: Apache-2.0
#include "tools/args.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tools/log.h"
#include "tools/session.h"

namespace fourdvt::tools {
namespace {

const Option* find(const CommandHelp& help, const std::string& name) {
  for (const Option& option : help.options)
    if (name == option.name) return &option;
  return nullptr;
}

// Options of every command.
constexpr std::string_view kQuiet = "--quiet", kVerbose = "--verbose";
constexpr Option kLogOptions{"--quiet, --verbose", nullptr,
                             "print only warnings, errors and results | options, times and files as well"};

constexpr size_t kHelpColumns = 120, kMeaningColumn = 26;

// Appends the text, broken at spaces into lines of at most kHelpColumns bytes; lines after the first are indented.
// Newlines of the text stay.
void appendWrapped(std::string& out, std::string_view text, size_t indent) {
  size_t column = indent;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find_first_of(" \n", at), text.size());
    if (column > indent && column + end - at > kHelpColumns) {
      out.back() = '\n';  // in place of the space
      out.append(indent, ' ');
      column = indent;
    }
    out += text.substr(at, end - at);
    column += end - at + 1;
    if (end < text.size()) out += text[end];
    if (end < text.size() && text[end] == '\n') {
      out.append(indent, ' ');
      column = indent;
    }
    at = end + 1;
  }
  out += '\n';
}

std::string shortNumber(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

const char* program_name = "fourdvt";

}  // namespace

const char* programName() { return program_name; }
void setProgramName(const char* name) { program_name = name; }

Args::Args(const CommandHelp& help, int argc, char** argv) {
  for (int i = 0; i < argc; ++i) {
    std::string name = argv[i], value;
    if (name == "--help" || name == "-h") {
      help_asked_ = true;
      continue;
    }
    if (name == kQuiet || name == kVerbose) {
      const LogLevel level = name == kQuiet ? LogLevel::Quiet : LogLevel::Verbose;
      const bool both = logLevel() != LogLevel::Normal && logLevel() != level;
      if (both) complain("--quiet and --verbose exclude each other");
      setLogLevel(both ? LogLevel::Normal : level);
      continue;
    }
    if (name.size() < 2 || name[0] != '-') {
      std::string& place = help.second && !positional_.empty() ? second_ : positional_;
      if (!place.empty())
        complain("unexpected argument \"" + name + "\"");
      else if (name.empty())
        complain("an argument is empty");
      place = name;
      continue;
    }
    const size_t equals = name.find('=');
    const bool joined = name.compare(0, 2, "--") == 0 && equals != std::string::npos;
    if (joined) {
      value = name.substr(equals + 1);
      name.resize(equals);
    }
    const Option* option = find(help, name);
    if (!option) {
      complain("unknown option " + name);
      continue;
    }
    if (!option->value && joined) complain(name + " takes no value");
    if (option->value && !joined) {
      const char* next = i + 1 < argc ? argv[i + 1] : nullptr;
      // If an option follows, the value was forgotten. Negative numbers and axes (-Y) are values.
      if (!next || (next[0] == '-' && (next[1] == '-' || find(help, next)))) {
        complain(name + " needs a value: " + option->value);
        continue;
      }
      value = argv[++i];
    }
    if (option->value && value.empty()) complain(name + " needs a value: " + option->value);
    values_[name].push_back(value);
    if (values_[name].size() > 1 && !option->repeats) complain(name + " is given twice");
  }
  const bool replaced = help.instead && has(help.instead);
  if (replaced && !positional_.empty()) complain("unexpected argument \"" + positional_ + "\" beside " + help.instead);
  const bool is_short = positional_.empty() || (help.second && second_.empty());
  if (is_short && !replaced && !help_asked_)
    complain("missing argument; usage: " + std::string(programName()) + " " + help.usage);
}

void Args::complain(const std::string& problem) {
  if (problem_.empty()) problem_ = problem;
}

std::string Args::text(const char* name, const std::string& otherwise) const {
  const auto it = values_.find(name);
  return resolved_[name] = it == values_.end() ? otherwise : it->second.front();
}

std::vector<std::string> Args::texts(const char* name) const {
  const auto it = values_.find(name);
  return it == values_.end() ? std::vector<std::string>() : it->second;
}

std::string Args::resolved() const {
  std::map<std::string, std::vector<std::string>> all = values_;
  for (const auto& [name, value] : resolved_)
    if (!value.empty()) all[name] = {value};
  std::string out = positional_ + (second_.empty() ? "" : " " + second_);
  for (const auto& [name, values] : all)
    for (const std::string& value : values)
      out += " " + name + (name == "--token" ? " …" : value.empty() ? "" : " " + value);  // a secret
  return out;
}

std::string Args::required(const char* name) {
  if (!has(name)) complain(std::string(name) + " is required");
  return text(name);
}

int Args::integer(const char* name, int otherwise, int low, int high) {
  const double value = number(name, otherwise, low, high);
  if (value != std::floor(value)) complain(std::string(name) + " must be a whole number, not \"" + text(name) + "\"");
  return static_cast<int>(value);
}

double Args::number(const char* name, double otherwise, double low, double high) {
  const std::string value = text(name, shortNumber(otherwise));
  if (!has(name)) return otherwise;
  char* end = nullptr;
  const double parsed = std::strtod(value.c_str(), &end);
  const bool whole = end && *end == '\0' && !value.empty() && !std::isspace(static_cast<unsigned char>(value[0]));
  if (whole && parsed >= low && parsed <= high) return parsed;
  complain(std::string(name) + " must be a number from " + shortNumber(low) + " to " + shortNumber(high) + ", not \"" +
           value + "\"");
  return otherwise;
}

std::vector<std::string> Args::list(const char* name) {
  std::vector<std::string> out;
  if (!has(name)) return out;
  const std::string value = text(name) + ",";
  for (size_t start = 0, comma; (comma = value.find(',', start)) != std::string::npos; start = comma + 1) {
    out.push_back(value.substr(start, comma - start));
    if (out.back().empty())
      complain(std::string(name) + " must be names separated by commas, not \"" + text(name) + "\"");
  }
  return out;
}

std::optional<std::pair<int, int>> Args::size(const char* name, int high) {
  if (!has(name)) return std::nullopt;
  int width = 0, height = 0, used = 0;
  const std::string value = text(name);
  const bool read =
      std::sscanf(value.c_str(), "%5dx%5d%n", &width, &height, &used) == 2 && used == static_cast<int>(value.size());
  if (read && width >= 1 && height >= 1 && width <= high && height <= high) return std::pair{width, height};
  complain(std::string(name) + " must be WIDTHxHEIGHT with sides from 1 to " + std::to_string(high) + ", not \"" +
           value + "\"");
  return std::nullopt;
}

std::string helpText(const CommandHelp& help) {
  std::string out = "usage: " + std::string(programName()) + " " + help.usage + "\n\n";
  appendWrapped(out, help.summary, 0);
  out += '\n';
  std::vector<Option> options = help.options;
  options.push_back(kLogOptions);
  for (const Option& option : options) {
    std::string left = std::string("  ") + option.name + (option.value ? std::string(" ") + option.value : "");
    left.resize(std::max(left.size() + 2, kMeaningColumn), ' ');
    out += left;
    appendWrapped(out, option.meaning, kMeaningColumn);
  }
  return out;
}

std::optional<int> helpOrProblem(const CommandHelp& help, const Args& args) {
  if (args.wantsHelp()) {
    std::fputs(helpText(help).c_str(), stdout);
    return kOk;
  }
  if (args.problem().empty()) {
    detail("%s", args.resolved().c_str());
    return std::nullopt;
  }
  std::fprintf(stderr, "%s: %s (--help shows the options)\n", programName(), args.problem().c_str());
  return kUsage;
}

int fail(const Error& error) {
  const std::string message = error.id == ErrorId::GpuFailure ? withShaderLines(error.message) : error.message;
  std::fprintf(stderr, "%s: %s\n", programName(), message.c_str());
  return error.id == ErrorId::Interrupted ? kInterrupted : kFailed;
}

}  // namespace fourdvt::tools
