// SPDX-License-Identifier: Apache-2.0
#include "tools/args.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <tuple>

#include "base/text.h"
#include "tools/session.h"
#include "tools/terminal.h"

namespace fourdvt::tools {
namespace {

// Splits a form into its name and value; an empty value marks a flag.
std::string nameOf(const Option& option) { return option.form.substr(0, option.form.find(' ')); }
std::string valueOf(const Option& option) {
  return option.form.substr(std::min(nameOf(option).size() + 1, option.form.size()));
}

const Option* find(const Options& options, const std::string& name) {
  const auto named = [&](const Option& option) { return nameOf(option) == name; };
  const auto found = std::find_if(options.begin(), options.end(), named);
  return found == options.end() ? nullptr : &*found;
}

// Options of every command.
constexpr std::string_view kQuiet = "--quiet", kVerbose = "--verbose";
constexpr const char* kLogForms = "--quiet, --verbose";
constexpr const char* kLogMeaning = "print only warnings, errors and results | options, times and files as well";

constexpr size_t kHelpColumns = 120, kMeaningColumn = 26;

// Appends the text, wrapped at spaces into lines of at most kHelpColumns bytes; lines after the first are indented.
// Keeps newlines of the text.
void appendWrapped(std::string& out, std::string_view text, size_t indent) {
  size_t column = indent;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find_first_of(" \n", at), text.size());
    if (column > indent && column + end - at > kHelpColumns) {
      out.back() = '\n';  // replaces the space
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

std::string shortNumber(double value) { return printed("%g", value); }

void appendOption(std::string& out, const std::string& form, const std::string& meaning) {
  std::string left = "  " + form;
  left.resize(std::max(left.size() + 2, kMeaningColumn), ' ');
  out += left;
  appendWrapped(out, meaning, kMeaningColumn);
}

std::string helpText(const Syntax& syntax) {
  std::string out = "usage: " + std::string(programName()) + " " + syntax.usage + "\n\n";
  appendWrapped(out, syntax.summary, 0);
  out += '\n';
  for (const Option& option : syntax.options) appendOption(out, option.form, option.meaning);
  appendOption(out, kLogForms, kLogMeaning);
  return out;
}

std::optional<std::pair<int, int>> parseSize(const std::string& text, int high) {
  int width = 0, height = 0, used = 0;
  const bool read = std::sscanf(text.c_str(), "%5dx%5d%n", &width, &height, &used) == 2 && used == int(text.size());
  if (!read || width < 1 || height < 1 || width > high || height > high) return std::nullopt;
  return std::pair{width, height};
}

std::string sizeForm(int high) { return "WIDTHxHEIGHT with sides from 1 to " + std::to_string(high); }

const char* program_name = "fourdvt";

}  // namespace

const char* programName() { return program_name; }
void setProgramName(const char* name) { program_name = name; }

int fail(const Error& error) {
  const std::string message = error.id == ErrorId::GpuFailure ? withShaderLines(error.message) : error.message;
  std::fprintf(stderr, "%s: %s\n", programName(), message.c_str());
  return error.id == ErrorId::Interrupted ? kInterrupted : kFailed;
}

Options join(std::initializer_list<Options> parts) {
  Options out;
  for (const Options& part : parts) out.insert(out.end(), part.begin(), part.end());
  return out;
}

Args::Args(const Syntax& syntax, int argc, char** argv) {
  parse(syntax, argc, argv);
  const bool is_replaced = !syntax.instead.empty() && has(syntax.instead);
  if (is_replaced && !positionals_.empty())
    complain("unexpected argument \"" + positionals_[0] + "\" beside " + syntax.instead);
  if (positionals_.size() < syntax.positionals.size() && !is_replaced && help_.empty())
    complain("missing argument; usage: " + std::string(programName()) + " " + syntax.usage);
  for (size_t i = 0; i < std::min(positionals_.size(), syntax.positionals.size()); ++i)
    *syntax.positionals[i] = positionals_[i];
  for (const Option& option : syntax.options) option.read(*this, nameOf(option));
}

void Args::parse(const Syntax& syntax, int argc, char** argv) {
  for (int i = 0; i < argc; ++i) {
    std::string name = argv[i], value;
    if (name == "--help" || name == "-h") help_ = helpText(syntax);
    if (name == "--help" || name == "-h" || readsLogLevel(name)) continue;
    if (name.size() < 2 || name[0] != '-') {
      if (positionals_.size() == syntax.positionals.size())
        complain("unexpected argument \"" + name + "\"");
      else if (name.empty())
        complain("an argument is empty");
      positionals_.push_back(name);
      continue;
    }
    const size_t equals = name.find('=');
    const bool is_joined = name.compare(0, 2, "--") == 0 && equals != std::string::npos;
    if (is_joined) {
      value = name.substr(equals + 1);
      name.resize(equals);
    }
    const Option* option = find(syntax.options, name);
    if (!option) {
      complain("unknown option " + name);
      continue;
    }
    const std::string needed = valueOf(*option);
    if (needed.empty() && is_joined) complain(name + " takes no value");
    if (!needed.empty() && !is_joined) {
      const char* next = i + 1 < argc ? argv[i + 1] : nullptr;
      // A following option means that the value is missing. Negative numbers and axes (-Y) are values.
      if (!next || (next[0] == '-' && (next[1] == '-' || find(syntax.options, next)))) {
        complain(name + " needs a value: " + needed);
        continue;
      }
      value = argv[++i];
    }
    if (!needed.empty() && value.empty()) complain(name + " needs a value: " + needed);
    values_[name].push_back(value);
    if (values_[name].size() > 1 && !option->repeats) complain(name + " is given twice");
  }
}

bool Args::readsLogLevel(const std::string& argument) {
  if (argument != kQuiet && argument != kVerbose) return false;
  const LogLevel level = argument == kQuiet ? LogLevel::Quiet : LogLevel::Verbose;
  const bool both = logLevel() != LogLevel::Normal && logLevel() != level;
  if (both) complain("--quiet and --verbose exclude each other");
  setLogLevel(both ? LogLevel::Normal : level);
  return true;
}

std::optional<int> Args::helpOrProblem() const {
  if (!help_.empty()) {
    std::fputs(help_.c_str(), stdout);
    return kOk;
  }
  if (problem_.empty()) {
    detail("%s", resolved().c_str());
    return std::nullopt;
  }
  std::fprintf(stderr, "%s: %s (--help shows the options)\n", programName(), problem_.c_str());
  return kUsage;
}

void Args::complain(const std::string& problem) {
  if (problem_.empty()) problem_ = problem;
}

void Args::refuse(const std::string& name, const std::string& form) {
  complain(name + " must be " + form + ", not \"" + text(name) + "\"");
}

std::string Args::text(const std::string& name, const std::string& otherwise) const {
  const auto it = values_.find(name);
  return resolved_[name] = it == values_.end() ? otherwise : it->second.front();
}

std::vector<std::string> Args::texts(const std::string& name) const {
  const auto it = values_.find(name);
  return it == values_.end() ? std::vector<std::string>() : it->second;
}

std::vector<std::string> Args::list(const std::string& name) {
  std::vector<std::string> out;
  if (!has(name)) return out;
  const std::string value = text(name) + ",";
  for (size_t start = 0, comma; (comma = value.find(',', start)) != std::string::npos; start = comma + 1) {
    out.push_back(value.substr(start, comma - start));
    if (out.back().empty()) refuse(name, "names separated by commas");
  }
  return out;
}

std::optional<double> Args::number(const std::string& name, double low, double high, bool is_whole,
                                   std::optional<double> otherwise) {
  const bool has_default = otherwise && *otherwise >= low && *otherwise <= high;
  const std::string value = text(name, has_default ? shortNumber(*otherwise) : "");
  if (!has(name)) return std::nullopt;
  char* end = nullptr;
  const double parsed = std::strtod(value.c_str(), &end);
  const bool ends = end && *end == '\0' && !value.empty() && !std::isspace(static_cast<unsigned char>(value[0]));
  if (!ends || !(parsed >= low && parsed <= high))
    refuse(name, "a number from " + shortNumber(low) + " to " + shortNumber(high));
  else if (is_whole && parsed != std::floor(parsed))
    refuse(name, "a whole number");
  else
    return parsed;
  return std::nullopt;
}

// Command line of the options that were read, defaults included.
std::string Args::resolved() const {
  std::map<std::string, std::vector<std::string>> all = values_;
  for (const auto& [name, value] : resolved_)
    if (!value.empty()) all[name] = {value};
  std::string out;
  for (const std::string& positional : positionals_) out += (out.empty() ? "" : " ") + positional;
  for (const auto& [name, values] : all)
    for (const std::string& value : values)
      out += " " + name + (name == "--token" ? " …" : value.empty() ? "" : " " + value);  // hides the secret
  return out;
}

Reader text(std::string& field) {
  return [&field](Args& args, const std::string& name) { field = args.text(name, field); };
}

Reader required(std::string& field) {
  return [&field](Args& args, const std::string& name) {
    if (!args.has(name)) args.complain(name + " is required");
    field = args.text(name);
  };
}

Reader list(std::vector<std::string>& field) {
  return [&field](Args& args, const std::string& name) { field = args.list(name); };
}

Reader flag(bool& field, bool value) {
  return [&field, value](Args& args, const std::string& name) {
    if (args.has(name)) field = value;
  };
}

Reader size(std::optional<std::pair<int, int>>& field, int high) {
  return parsed(
      field, [high](const std::string& text) { return parseSize(text, high); }, sizeForm(high));
}

Reader size(int& width, int& height, int high) {
  return [&width, &height, high](Args& args, const std::string& name) {
    std::optional<std::pair<int, int>> sides;
    size(sides, high)(args, name);
    if (sides) std::tie(width, height) = *sides;
  };
}

}  // namespace fourdvt::tools
